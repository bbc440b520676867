"""The page of a run in a browser: no error, nothing fetched, a view that turns and changes."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI
from PIL import Image

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    Obstacle,
    Run,
    Scene,
    Steps,
    Support,
)
from fenics_contact.report.bodies.view import choose_view
from fenics_contact.report.bodies.view_3d import make_view
from fenics_contact.report.contacts.curves import draw_curves
from fenics_contact.report.contacts.maps import draw_maps
from fenics_contact.report.drawing.fields import read_series, whole_body
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.load_steps import draw_history
from fenics_contact.report.page.page import Content, page
from fenics_contact.report.page.view_page import ContactSteps, followers, slider_html, view_html
from fenics_contact.report.report import write_report
from fenics_contact.report.run_to_draw import axes_of
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.verification.boxes import Box, boxes
from tests.browser.conftest import WINDOW
from tests.report.page.pages import page_of
from tests.report.test_gallery import draw_coarsely, pressed
from tests.scenes import PULLED_BLOCK, box_body, slab
from tests.simulation.output.test_run_folder import cycled

pytestmark = pytest.mark.serial

PHONE = 390


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Pages of runs by the kinematics of their models."""
    pytest.importorskip("plotly")
    pytest.importorskip("pyvista")
    indented = pressed(Obstacle(indentation=0.05), "axisymmetric", friction_coefficient=0.3)
    runs = {
        "3D": (PULLED_BLOCK, box_body((4, 4, 2), comm=MPI.COMM_SELF)),
        "plane": (slab(300), None),
        "axisymmetric": (indented, box_body((4, 4), comm=MPI.COMM_SELF)),
    }
    found = {}
    for name, (scene, body) in runs.items():
        folder = tmp_path_factory.mktemp(name)
        files.solve_and_write(Run(scene, MPI.COMM_SELF, body), folder)
        found[name] = folder / "report.html"
        if name == "3D":
            write_report(folder)
        else:  # the view alone: pictures take their time
            found[name].write_text(view_page(folder), encoding="utf-8")
    return found


@pytest.fixture(scope="module")
def assembly(tmp_path_factory):
    """The page of two blocks, of which the upper one is pushed aside in three load steps."""
    pytest.importorskip("plotly")
    pytest.importorskip("pyvista")
    parts = [
        Box("upper", (0.2, 0, 0), (0.8, 1, 0.5), (3, 2, 2)),
        Box("lower", (0, 0, -0.5), (1, 1, 0), (4, 3, 1)),
    ]
    held = {"x": 0, "y": 0}
    scene = Scene(
        kinematics="3D",
        discretisation=Discretisation(degree=1),
        material=Material(1000, 0.3),
        support=(
            Support("lower.z0", {**held, "z": 0}),
            Support("upper.z1", {"x": 0.1, "y": 0, "z": -0.05}),
        ),
        contact=(Contact("upper.z0", against="lower.z1", friction_coefficient=0.3),),
        steps=Steps(number=3),
    )
    body = boxes(parts, "hexahedron", comm=MPI.COMM_SELF)
    folder = tmp_path_factory.mktemp("assembly")
    files.solve_and_write(Run(scene, MPI.COMM_SELF, body), folder)
    earlier = read_series(folder, [0, 1])
    (folder / "report.html").write_text(view_page(folder, earlier), encoding="utf-8")
    return folder / "report.html"


def view_page(folder, earlier=()):
    """A page with the view of a run, and no pictures."""
    result, table = read_result(folder), ContactTable.read(folder / "contact.csv")
    shown = make_view(whole_body(folder), result, table, earlier)
    slider = slider_html(shown.times)
    return page(Content("folder", result, True, [], [], view_html(shown), slider))


def drawn(browser):
    """How often the view has been drawn, waiting for the first time."""
    return browser.driver.execute_async_script(
        """const done = arguments[0];
        (function look() {
            const times = document.getElementById("view").dataset.drawn;
            times ? requestAnimationFrame(() => setTimeout(() => done(Number(times)), 300))
                  : setTimeout(look, 50);
        })();"""
    )


def seen(browser):
    """Pixels of the view's canvas, (rows, columns, 3)."""
    canvas = browser.driver.find_element("css selector", "#view .gl-container, #view canvas")
    browser.driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", canvas)
    content = browser.driver.find_element("id", "view").screenshot_as_png
    return np.array(Image.open(io.BytesIO(content)).convert("RGB"), dtype=int)


def drawn_again(browser, times):
    """Wait until the view has been drawn more often."""
    browser.driver.execute_async_script(
        """const [times, done] = arguments;
        (function look() {
            Number(document.getElementById("view").dataset.drawn) > times
                ? setTimeout(done, 300) : setTimeout(look, 50);
        })();""",
        times,
    )


def press(browser, group, number):
    """Press a button of the view, and wait until it is drawn again."""
    times = drawn(browser)
    buttons = browser.driver.find_elements("css selector", f'button[data-group="{group}"]')
    browser.driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", buttons[number])
    buttons[number].click()
    drawn_again(browser, times)
    return buttons[number]


def pulled(browser, step):
    """Move the slider to a load step, as its handle does, and wait for the last drawing."""
    times = drawn(browser)
    browser.driver.execute_script(
        """const slider = document.getElementById("view-step");
        slider.value = arguments[0];
        slider.dispatchEvent(new Event("input"));""",
        step,
    )
    drawn_again(browser, times)


def share(a, b):
    """Of pixels that differ visibly."""
    return float((np.abs(a - b).max(axis=2) > 30).mean())


@pytest.mark.parametrize("kind", ["3D", "plane", "axisymmetric"])
def test_the_view_is_drawn_turns_and_changes_its_colours(kind, pages, browser):
    browser.open(pages[kind])
    assert drawn(browser) == 1
    first = seen(browser)
    colours = np.unique((first // 32).reshape(-1, 3), axis=0)
    assert len(colours) > 10  # not blank: a map of colours
    assert share(first, np.broadcast_to(first[2, 2], first.shape)) > 0.03

    view = browser.driver.find_element("id", "view")
    from selenium.webdriver import ActionChains

    ActionChains(browser.driver).move_to_element(view).click_and_hold().move_by_offset(
        90, 40
    ).release().perform()
    drawn(browser)
    turned = seen(browser)
    assert share(first, turned) > 0.02

    for number in (1, -1):  # displacement, status
        button = press(browser, "field", number)
        assert button.get_attribute("aria-pressed") == "true"
        other = seen(browser)
        assert share(turned, other) > 0.01
        turned = other
    press(browser, "factor", 0)
    assert share(turned, seen(browser)) > 0.0005
    assert browser.errors() == []


def test_the_view_says_the_values_pointed_at(pages, browser):
    browser.open(pages["plane"])
    drawn(browser)
    said = browser.driver.execute_script("return document.getElementById('view').data[0].text")
    result = json.loads((pages["plane"].parent / "result.json").read_text())
    assert any(text.endswith("slip") for text in said)
    pressure = result["quantities"]["max_contact_pressure"]
    assert any(f"contact pressure p = {pressure:g}" in text for text in said)


def test_bodies_are_faded_and_hidden(assembly, browser):
    browser.open(assembly)
    assert drawn(browser) == 1
    names = browser.driver.execute_script(
        "return document.getElementById('view').data.filter((t) => t.type === 'mesh3d')"
        ".map((t) => [t.name, t.opacity])"
    )
    assert names == [["upper", 1], ["lower", 1]]
    pictures = [seen(browser)]
    for part, state in ((0, 1), (0, 2), (1, 2), (0, 0)):  # faded, hidden, both hidden, shown
        button = press(browser, f"part{part}", state)
        assert button.get_attribute("aria-pressed") == "true"
        pictures.append(seen(browser))
        assert share(*pictures[-2:]) > 0.005
    traces = browser.driver.execute_script(
        "return document.getElementById('view').data.map((t) => [t.type, t.name, t.showscale])"
    )
    assert ["mesh3d", "upper", True] in traces and "lower" not in str(traces)
    assert browser.errors() == []


def test_a_slider_goes_through_the_load_steps(assembly, browser):
    browser.open(assembly)
    drawn(browser)
    last = seen(browser)
    said = "return document.querySelector('output[for=\"view-step\"]').textContent"
    assert browser.driver.execute_script(said) == "t = 1"
    pulled(browser, 0)
    first = seen(browser)
    assert browser.driver.execute_script(said) == "t = 0.3333"
    assert share(first, last) > 0.01
    pulled(browser, 2)
    assert share(seen(browser), last) < 0.001
    assert browser.errors() == []


@pytest.fixture(scope="module")
def rubbed(tmp_path_factory):
    """Pages of a block that is rubbed in three load steps, in the plane and in space."""
    pytest.importorskip("plotly")
    pytest.importorskip("pyvista")
    found = []
    for kinematics, cells in (("plane strain", (8, 2)), ("3D", (4, 2, 1))):
        body = box_body(cells, (2, 1, 1), comm=MPI.COMM_SELF)
        folder = tmp_path_factory.mktemp("rubbed")
        files.solve_and_write(Run(cycled(3, kinematics), MPI.COMM_SELF, body), folder)
        found.append(folder / "report.html")
        with pytest.MonkeyPatch.context() as patch:
            draw_coarsely(patch)
            found[-1].write_text(page_that_follows(folder), encoding="utf-8")
    return found


def page_that_follows(folder):
    """The page of a run with its view and the pictures that follow the slider, and one more."""
    result, table, body = (
        read_result(folder), ContactTable.read(folder / "contact.csv"), whole_body(folder)
    )  # fmt: skip
    (contact,), axes = result.contacts, axes_of(result.model.kinematics)
    steps = ContactSteps(result, table)
    shown = make_view(body, result, table, steps.watched(read_series(folder, [0, 1])))
    rows, path = table.of(contact.name), folder / "contact_0.png"
    with style():
        if axes == "xyz":
            picture = draw_maps(body, rows, contact, path)
        else:
            picture = draw_curves(body, rows, contact, axes, path)
        still = replace(picture, path=path.with_name("deformed.png"))
        still.path.write_bytes(path.read_bytes())
        pictures = [still, picture, *draw_history(folder, result)]
    found = followers(steps.contacts(body), axes, pictures, shown.times, result)
    slider = slider_html(shown.times, found)
    return page(Content("folder", result, True, pictures, [], view_html(shown), slider))


def shown_at(browser, file, panel, x, y):
    """Colour of the canvas over a picture, where a panel has a place."""
    return browser.driver.execute_async_script(
        """const [file, panel, x, y, done] = arguments;
        const image = document.querySelector(`img[data-file="${file}"]`);
        const canvas = image.parentNode.querySelector("canvas");
        const packed = document.getElementById("steps-data").textContent;
        const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
        new Response(stream).json().then((data) => {
            const own = data.pictures.find((one) => one.file === file).panels[panel];
            const [left, top, width, height] = own.box;
            const across = left + (width * (x - own.x[0])) / (own.x[1] - own.x[0]);
            const down = top + (height * (own.y[1] - y)) / (own.y[1] - own.y[0]);
            const place = [across * canvas.width, down * canvas.height].map(Math.round);
            done([...canvas.getContext("2d").getImageData(...place, 1, 1).data]);
        });""",
        file, panel, x, y,
    )  # fmt: skip


def test_the_slider_moves_curves_and_marks(rubbed, browser):
    page, _ = rubbed
    browser.open(page)
    drawn(browser)
    folder = page.parent
    result = read_result(folder)
    still = "return document.querySelector('img[data-file=\"contact_0.png\"]').src.length"
    before = browser.driver.execute_script(still)
    for step, (_, body) in enumerate(read_series(folder, [0, 1])):
        pulled(browser, step)
        top = np.flatnonzero(np.isclose(body.points[:, 1], 1))
        node = top[len(top) // 2]
        x, pressure = body.points[node, 0], body["contact_pressure"][node]
        colour = shown_at(browser, "contact_0.png", 0, float(x), float(pressure))
        sticks = body["status"][node] == 1
        wanted = (8, 48, 107) if sticks else (255, 255, 255)  # what slips is not filled
        assert colour[3] > 200 and np.abs(np.subtract(colour[:3], wanted)).max() < 60
        time = result.steps[step].load_factor
        assert shown_at(browser, "history_forces.png", 0, time, 1.0)[3] > 100
        assert shown_at(browser, "history_forces.png", 0, time + 0.1, 1.0)[3] == 0
    assert browser.driver.execute_script(still) != before  # the frame stands for the still picture
    top = "return document.querySelector('.steps').getBoundingClientRect().top"
    script = "document.getElementById('reproduce').scrollIntoView({block: 'end'})"
    browser.driver.execute_script(script)
    assert browser.driver.execute_script(top) == 0  # it stays in sight
    badge = (
        "return getComputedStyle(document.querySelector('img[data-file=\"deformed.png\"]')"
        ".parentNode, '::before').content"
    )
    assert "last load step" in browser.driver.execute_script(badge)
    pulled(browser, 2)
    assert browser.driver.execute_script(badge) == "none"


def test_the_slider_moves_maps(rubbed, browser):
    *_, page = rubbed
    browser.open(page, PHONE)
    drawn(browser)
    values = []
    for step, (_, body) in zip((0, 2), read_series(page.parent, (0, 2)), strict=True):
        pulled(browser, step)
        pressure = body["contact_pressure"]
        node = int(np.argmax(pressure))
        x, y = body.points[node, :2]
        inside = (float(x + 0.15 * (1 - x)), float(y + 0.15 * (0.5 - y)))
        values.append((float(pressure[node]), shown_at(browser, "contact_0.png", 1, *inside)))
    (first, pale), (last, bright) = sorted(values)
    assert last > 1.2 * first and pale[3] == bright[3] == 255
    assert sum(bright[:2]) > sum(pale[:2]) + 20  # from violet to yellow
    assert browser.driver.execute_script("return document.documentElement.scrollWidth") <= PHONE


def test_the_view_begins_on_the_side_of_the_picture(assembly, browser):
    browser.open(assembly)
    drawn(browser)
    eye = browser.driver.execute_script(
        "return document.getElementById('view').layout.scene.camera.eye"
    )
    folder = assembly.parent
    table, body = ContactTable.read(folder / "contact.csv"), whole_body(folder)
    towards = choose_view(body, read_result(folder), table).towards
    found = np.array([eye[axis] for axis in "xyz"])
    assert found / np.linalg.norm(found) == pytest.approx(towards)


@pytest.mark.parametrize("width", [WINDOW[0], PHONE])
@pytest.mark.parametrize("dark", [False, True])
def test_all_pictures_are_shown_and_nothing_is_wider_than_the_window(width, dark, pages, browser):
    browser.open(pages["3D"], width, dark)
    drawn(browser)
    images = browser.driver.execute_script(
        "return [...document.images].map((i) => [i.complete, i.naturalWidth, i.width, i.alt])"
    )
    assert len(images) > 2
    assert all(
        done and natural > 0 and 0 < shown <= width and alt for done, natural, shown, alt in images
    )
    assert browser.driver.execute_script("return document.documentElement.scrollWidth") <= width
    colour = browser.driver.execute_script("return getComputedStyle(document.body).backgroundColor")
    assert (min(map(int, colour[4:-1].split(","))) < 128) == dark


def test_nothing_is_fetched(pages, browser):
    browser.open(pages["3D"])
    drawn(browser)
    fetched = browser.driver.execute_script(
        "return performance.getEntriesByType('resource').map((entry) => entry.name)"
    )
    assert [name for name in fetched if not name.startswith(("data:", "blob:"))] == []


def test_anchors_lead_somewhere(pages, browser):
    browser.open(pages["3D"])
    lost = browser.driver.execute_script(
        """return [...document.querySelectorAll("nav a")].map((a) => a.getAttribute("href"))
            .filter((href) => !document.querySelector(href))"""
    )
    assert lost == []


def test_a_page_without_fields_has_no_error(browser, tmp_path):
    result = {
        "title": "<b>", "verdict": "No answer", "converged": False, "passed": False,
        "checks": {}, "quantities": {}, "model": {}, "contacts": [], "supports": [],
        "timings": {"total": 1.0}, "versions": {}, "steps": [],
    }  # fmt: skip
    path = tmp_path / "report.html"
    path.write_text(page_of(result), encoding="utf-8")
    browser.open(path)
    assert browser.driver.title == "<b>"
    assert browser.driver.find_element("tag name", "h1").text == "<b>"


@pytest.mark.parametrize(
    "fault",
    [
        "<script>nothing.here()</script>",
        "<script>Promise.reject(new Error('lost'))</script>",
        "<img src='http://example.invalid/x.png' alt=''>",
    ],
)
def test_what_the_fixture_asserts_can_fail(fault, browser, tmp_path):
    path = tmp_path / "faulty.html"
    path.write_text(f"<!DOCTYPE html><title>x</title>{fault}", encoding="utf-8")
    browser.open(path)
    browser.driver.execute_async_script("setTimeout(arguments[0], 500)")
    assert len(browser.errors()) == 1
