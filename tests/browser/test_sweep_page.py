"""The page of a sweep in a browser: sliders, clicks and choosers lead to what they name."""

import numpy as np
import pytest

from fenics_contact.report.page.sweep import write_sweep_page
from tests.report.sweep.sweeps import COEFFICIENT, INDENTATION, disc, hertz, line, write_sweep

pytestmark = pytest.mark.serial

DEPTHS = [0.25, 0.5, 1.0, 2.0]
COEFFICIENTS = [0.2, 0.4]
FAILURE = "Not converged: <b>30</b> steps."


def failing(depth, coefficient=0.5, at=None):
    return FAILURE if depth == 0.5 else hertz(depth, coefficient, at)


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    pytest.importorskip("plotly")
    folder = tmp_path_factory.mktemp("sweeps")
    both = {COEFFICIENT: COEFFICIENTS, INDENTATION: DEPTHS}
    hostile = "<a href='https://example.invalid'>x</a>"
    sweeps = {
        "one": ({INDENTATION: DEPTHS}, failing),
        "two": (both, lambda coefficient, depth: failing(depth, coefficient)),
        "three": (
            {"contact.0.law": ["static", hostile], **both},
            lambda law, coefficient, depth: failing(depth, coefficient),
        ),
        "plane": ({INDENTATION: DEPTHS}, lambda depth: hertz(depth, at=disc())),
        "space": ({INDENTATION: DEPTHS}, domed),
        "none": ({INDENTATION: DEPTHS}, lambda depth: FAILURE),
    }
    return {
        name: write_sweep_page(write_sweep(folder / name, vary, answer))
        for name, (vary, answer) in sweeps.items()
    }


def domed(depth):
    found = hertz(depth, at=disc())
    found.arrays["z"] = -0.05 * (found.arrays["x"] ** 2 + found.arrays["y"] ** 2)
    return found


def wait(browser):
    """Until what was asked for is drawn."""
    browser.driver.execute_async_script(
        """const done = arguments[0];
        (function look() {
            document.getElementById("curves").dataset.ready ? setTimeout(done, 150)
                                                            : setTimeout(look, 50);
        })();"""
    )


def shown(browser, page, width=1280, dark=False):
    browser.open(page, width, dark)
    wait(browser)


def put(browser, name, value):
    """Give a slider, a chooser or a box its value, as a hand would."""
    browser.driver.execute_script(
        """const input = document.getElementById(arguments[0]);
        input[input.type === "checkbox" ? "checked" : "value"] = arguments[1];
        ["input", "change"].forEach(
            (kind) => input.dispatchEvent(new Event(kind, { bubbles: true })));""",
        name,
        value,
    )
    wait(browser)


def choose(browser, name, words):
    """Choose an entry by its text."""
    values = browser.driver.execute_script(
        "return [...document.getElementById(arguments[0]).options].map((o) => [o.text, o.value])",
        name,
    )
    put(browser, name, dict(values)[words])


def said(browser):
    return browser.driver.find_element("id", "said").text


def traces(browser, name):
    """What a plot draws: type, name, x, y, colours and rows of each trace."""
    return browser.driver.execute_script(
        """const plain = (values) => values && Array.from(values);
        return document.getElementById(arguments[0]).data.map((t) => ({
            type: t.type, name: t.name, x: plain(t.x), y: plain(t.y), z: plain(t.z),
            color: t.marker && plain(t.marker.color), row: plain(t.customdata), fill: t.fill,
            bars: t.error_y && plain(t.error_y.array),
        }))""",
        name,
    )


def curve(browser):
    return next(t for t in traces(browser, "curves") if t["row"] and not t["fill"])


def test_curves_have_the_numbers_of_the_table_and_stop_at_failures(pages, browser):
    shown(browser, pages["one"])
    drawn = curve(browser)
    forces = [failing(depth) for depth in DEPTHS]
    values = [None if one == FAILURE else one.columns["normal_force"] for one in forces]
    assert drawn["x"] == DEPTHS and drawn["y"] == values
    crosses = next(t for t in traces(browser, "curves") if t["name"] == "failed, no answer")
    assert crosses["x"] == [0.5] and crosses["row"] == [1]
    band = next(t for t in traces(browser, "curves") if t["fill"])
    assert band["x"] == [
        1.0,
        2.0,
        2.0,
        1.0,
        None,
    ]  # no band of a point alone, and none over the gap
    force = values[2]
    assert [band["y"][0], band["y"][3]] == pytest.approx([1.01 * force, 0.99 * force])
    assert drawn["bars"][0] == pytest.approx(0.01 * values[0])


def test_another_quantity_is_chosen(pages, browser):
    shown(browser, pages["one"])
    choose(browser, "quantity", "max contact pressure")
    peaks = [hertz(depth).columns["max_contact_pressure"] for depth in DEPTHS]
    assert curve(browser)["y"] == [peaks[0], None, *peaks[2:]]
    assert not [t for t in traces(browser, "curves") if t["fill"]]  # there are no bars
    assert "max contact pressure = 349.791 ± ?" in said(browser)


def test_the_slider_goes_through_the_states(pages, browser):
    shown(browser, pages["one"])
    for number, depth in [(3, 2.0), (0, 0.25), (2, 1.0)]:
        put(browser, "key-0", number)
        pressure = {}
        for trace in traces(browser, "state"):
            if trace["name"] in ("stick", "slip", "open"):
                pressure.setdefault(trace["name"], dict(zip(trace["x"], trace["y"], strict=True)))
        exact = hertz(depth).arrays
        shown_points = {**pressure["stick"], **pressure["slip"], **pressure["open"]}
        assert list(sorted(shown_points)) == pytest.approx(line()[:, 0], abs=1e-6)
        found = [shown_points[x] for x in sorted(shown_points)]
        peak = exact["contact_pressure"].max()
        assert found == pytest.approx(exact["contact_pressure"], abs=1e-4 * peak)
        assert len(pressure["stick"]) == (exact["status"] == 1).sum()
        assert len(pressure["slip"]) == (exact["status"] == 2).sum()
    output = browser.driver.find_element("css selector", 'output[for="key-0"]').text
    assert output == "1" and "Point 3 of 4" in said(browser)


def test_a_point_that_failed_says_why_and_shows_no_contact(pages, browser):
    shown(browser, pages["one"])
    put(browser, "key-0", 1)
    assert "not converged" in said(browser) and FAILURE in said(browser)
    assert browser.driver.find_element("id", "no-state").text == FAILURE
    assert not browser.driver.find_element("id", "state").is_displayed()
    chosen = browser.driver.find_element("css selector", "tr.chosen")
    assert "not converged" in chosen.text
    put(browser, "key-0", 2)
    assert browser.driver.find_element("id", "state").is_displayed()


def at_pixel(browser, name, x, y):
    """Click where a plot has a point of its axes."""
    from selenium.webdriver import ActionChains

    place = browser.driver.find_element("id", name)
    browser.driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", place)
    left, top, width, height = browser.driver.execute_script(
        """const plot = document.getElementById(arguments[0]), { xaxis, yaxis } = plot._fullLayout;
        const box = plot.getBoundingClientRect();
        return [xaxis._offset + xaxis.d2p(arguments[1]), yaxis._offset + yaxis.d2p(arguments[2]),
                box.width, box.height]""",
        name,
        x,
        y,
    )
    moves = ActionChains(browser.driver)
    moves.move_to_element_with_offset(place, left - width / 2 + 4, top - height / 2).pause(0.2)
    moves.move_by_offset(-4, 0).pause(0.3).click().perform()
    wait(browser)


def test_a_click_on_a_point_of_a_curve_moves_the_slider(pages, browser):
    shown(browser, pages["one"])
    at_pixel(browser, "curves", 1.0, hertz(1.0).columns["normal_force"])
    assert browser.driver.find_element("id", "key-0").get_property("value") == "2"
    assert "Point 3 of 4" in said(browser)


def test_a_map_over_two_keys_and_a_click_on_its_cell(pages, browser):
    shown(browser, pages["two"])
    choose(browser, "quantity", "friction force x")
    cells = traces(browser, "map")[0]
    exact = [
        [None if d == 0.5 else hertz(d, m).columns["friction_force_x"] for d in DEPTHS]
        for m in COEFFICIENTS
    ]
    assert cells["type"] == "heatmap" and cells["z"] == exact
    assert cells["row"] == [[0, 1, 2, 3], [4, 5, 6, 7]]
    curves = [t for t in traces(browser, "curves") if t["name"] in ("0.2", "0.4") and t["row"]]
    assert [t["y"] for t in curves] == exact
    at_pixel(browser, "map", 2, 0)
    values = [browser.driver.find_element("id", f"key-{n}").get_property("value") for n in (0, 1)]
    assert values == ["0", "2"]
    choose(browser, "across", COEFFICIENT)
    cells = traces(browser, "map")[0]
    assert cells["z"] == [list(column) for column in zip(*exact, strict=True)]
    assert browser.driver.find_element("id", "family").get_property("value") == "1"
    choose(browser, "family", "none: one curve")
    assert not browser.driver.find_element("id", "map").is_displayed()
    assert curve(browser)["y"] == [exact[0][2], exact[1][2]]


def test_sliders_fix_the_keys_that_are_not_drawn(pages, browser):
    shown(browser, pages["three"])
    put(browser, "key-0", 0)
    assert curve(browser)["row"] == [0, 1, 2, 3]
    put(browser, "key-0", 1)
    assert curve(browser)["row"] == [8, 9, 10, 11]
    about = browser.driver.find_element("id", "about").text
    assert "At contact.0.law = <a href='https://example.invalid'>x</a>." in about
    choose(browser, "across", "contact.0.law")
    ticks = browser.driver.execute_script(
        "return [...document.querySelectorAll('#curves .xtick text')].map((t) => t.textContent)"
    )
    assert ticks == ["static", "<a href='https://examp…"]
    assert curve(browser)["x"] == [0, 1]


@pytest.mark.parametrize(("name", "kind"), [("plane", "scatter"), ("space", "scatter3d")])
def test_maps_of_the_points_over_a_surface(name, kind, pages, browser):
    shown(browser, pages[name])
    put(browser, "key-0", 2)
    exact = hertz(1.0, at=disc()).arrays
    (found,) = traces(browser, "state")
    assert found["type"] == kind
    peak = exact["contact_pressure"].max()
    assert found["color"] == pytest.approx(exact["contact_pressure"], abs=1e-4 * peak)
    buttons = browser.driver.find_elements("css selector", "#fields button")
    assert [b.text for b in buttons] == ["contact pressure", "friction traction", "slip", "gap"]
    browser.driver.execute_script("arguments[0].click()", buttons[1])
    wait(browser)
    (found,) = traces(browser, "state")
    largest = abs(exact["traction_x"]).max()
    assert found["color"] == pytest.approx(abs(exact["traction_x"]), abs=1e-4 * largest)
    numbers = {t["name"]: len(t["x"]) for t in traces(browser, "status")}
    wanted = np.bincount(exact["status"])
    assert numbers == {"stick": wanted[1], "slip": wanted[2], "open": wanted[0]}


@pytest.mark.parametrize(
    ("name", "width"),
    [("one", 390), ("three", 390), ("three", 1280), ("plane", 390), ("none", 390)],
)
def test_nothing_is_fetched_or_wider_than_the_window(name, width, pages, browser):
    shown(browser, pages[name], width, dark=width < 600)
    assert browser.driver.execute_script("return document.documentElement.scrollWidth") <= width
    fetched = browser.driver.execute_script(
        "return performance.getEntriesByType('resource').map((entry) => entry.name)"
    )
    assert [one for one in fetched if not one.startswith(("data:", "blob:"))] == []
    assert browser.errors() == []


def test_rows_of_the_table_lead_to_their_points(pages, browser):
    shown(browser, pages["two"])
    button = browser.driver.find_element("css selector", '#rows tr[data-row="3"] button')
    browser.driver.execute_script("arguments[0].click()", button)
    wait(browser)
    assert "Point 4 of 8" in said(browser)
    before = len(browser.driver.find_elements("css selector", "#rows thead th"))
    put(browser, "all", True)
    assert len(browser.driver.find_elements("css selector", "#rows thead th")) == before + 1
