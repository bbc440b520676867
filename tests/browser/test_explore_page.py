"""The page of ``explore`` in a browser: the answer follows a slider, and bars come at its end."""

import io
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import pytest
from PIL import Image
from scipy.stats import linregress

from fenics_contact import load_scene
from tests.scenes import ROOT

pytestmark = pytest.mark.serial

DEPTH = "contact.0.obstacle.indentation"
WAIT = 120
# What a person does who drags a slider, or lets it go.
MOVE = """
const [key, value, event] = arguments;
const slider = document.querySelector(`input[type=range][data-key="${key}"]`);
slider.value = value;
slider.dispatchEvent(new Event(event, { bubbles: true }));
"""
# Many moves, one every few milliseconds, as a mouse makes them; the numbers shown meanwhile.
DRAG = """
const [key, low, high, count, done] = arguments;
const slider = document.querySelector(`input[type=range][data-key="${key}"]`);
const seen = new Set();
let n = 0;
(function step() {
  seen.add(document.body.dataset.shown);
  if (n === count) { done([...seen].map(Number)); return; }
  n += 1;
  slider.value = low + ((high - low) * n) / count;
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  setTimeout(step, 8);
})();
"""


@contextmanager
def explored(scene, *options):
    """The link of a scene's page."""
    command = [sys.executable, "-m", "fenics_contact", "explore", str(ROOT / "demos" / scene)]
    with subprocess.Popen(
        [*command, "--no-browser", *options], stdout=subprocess.PIPE, text=True, cwd=ROOT
    ) as process:
        yield process.stdout.readline().strip()
        process.terminate()
        assert process.wait(60) == 0


def wait_for(browser, condition):
    from selenium.webdriver.support.ui import WebDriverWait

    script = f"return Boolean({condition})"
    WebDriverWait(browser.driver, WAIT, 0.05).until(lambda driver: driver.execute_script(script))


def opened(browser, address, width=1400):
    size = {"width": width, "height": 1150, "deviceScaleFactor": 1, "mobile": width < 600}
    browser.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.driver.get(address)
    wait_for(browser, "document.body.dataset.ready")
    whole(browser)


def whole(browser):
    """Wait for an answer with checks and bars, and until it is drawn."""
    wait_for(browser, "document.getElementById('outcome').textContent.startsWith('✓ OK')")
    wait_for(browser, "document.body.dataset.shown === document.body.dataset.answered")


def value(browser, name):
    """Value and bar of a quantity."""
    cells = browser.driver.execute_script(
        "const row = document.querySelector(`#quantities tr[data-name='${arguments[0]}']`);"
        "return [...row.querySelectorAll('td')].map((cell) => cell.textContent)",
        name,
    )
    return float(cells[0].split(",")[0]), cells[1]


def moved(browser, key, number, event):
    before = browser.driver.execute_script("return document.body.dataset.answered")
    browser.driver.execute_script(MOVE, key, number, event)
    wait_for(browser, f"document.body.dataset.answered !== '{before}'")


def picture(browser, name):
    content = browser.driver.find_element("id", name).screenshot_as_png
    return np.array(Image.open(io.BytesIO(content)).convert("RGB"), dtype=int)


def test_a_sphere_follows_hertz_while_it_is_driven(browser, tmp_path):
    """F = 4/3 E* √R d^1.5 without friction (Hertz): E* = 1000/(1 - .3²), R = 8."""
    with explored("sphere.toml", "--set", "contact.0.friction_coefficient=0") as address:
        opened(browser, address)
        depths, forces = np.linspace(0.6, 1.4, 5), []
        before = picture(browser, "contact"), picture(browser, "body")
        for depth in depths:
            moved(browser, DEPTH, depth, "input")
            force, bar = value(browser, "normal force")
            assert bar == ""  # while one drags
            forces.append(force)
        hertz = 4 / 3 * 1000 / 0.91 * np.sqrt(8) * depths**1.5
        assert np.array(forces) == pytest.approx(hertz, rel=0.01)
        assert linregress(np.log(depths), np.log(forces)).slope == pytest.approx(1.5, abs=0.015)
        assert "Quick answer" in browser.driver.find_element("id", "state").text
        moved(browser, DEPTH, 1.4, "change")
        whole(browser)
        after = picture(browser, "contact"), picture(browser, "body")
        for old, new in zip(before, after, strict=True):
            assert (np.abs(old - new).max(axis=2) > 40).mean() > 0.002
        force, bar = value(browser, "normal force")
        assert force == pytest.approx(hertz[-1], rel=0.01)
        assert bar.startswith("± ") and 0 < float(bar[2:]) < 0.02 * force
        browser.driver.find_element("id", "copy").click()
        wait_for(browser, "document.getElementById('scene-text').value")
        text = browser.driver.execute_script("return document.getElementById('scene-text').value")
    (tmp_path / "copied.toml").write_text(text)
    copied = load_scene(tmp_path / "copied.toml")
    assert copied.contact[0].obstacle.indentation == 1.4
    assert copied.contact[0].friction_coefficient == 0
    asked = browser.driver.execute_script(
        "return performance.getEntriesByType('resource').map(entry => entry.name)"
    )
    assert all(name.startswith((address, "data:", "blob:")) for name in asked)


def test_answers_keep_up_with_a_drag_and_the_last_one_is_shown(browser):
    with explored("winkler.toml", "--vary", "load.0.pressure=9:11") as address:
        opened(browser, address)
        numbers = browser.driver.execute_async_script(DRAG, "load.0.pressure", 9.0, 10.6, 200)
        assert len(numbers) > 3
        assert numbers == sorted(numbers)
        moved(browser, "load.0.pressure", 10.6, "change")
        whole(browser)
        field = 'input[type="number"][data-key="load.0.pressure"]'
        assert browser.driver.find_element("css selector", field).get_property("value") == "10.6"


def test_numbers_beyond_the_range_are_not_sent_and_ends_are_said(browser):
    with explored("slab.toml") as address:
        opened(browser, address)
        before = browser.driver.execute_script("return document.body.dataset.answered")
        field = browser.driver.find_element(
            "css selector", 'input[type="number"][data-key="load.0.traction.0"]'
        )
        browser.driver.execute_script(
            "const [field] = arguments; field.value = -5000;"
            "for (const name of ['input', 'change'])"
            "  field.dispatchEvent(new Event(name, {bubbles: true}));",
            field,
        )
        browser.driver.execute_async_script("setTimeout(arguments[0], 300)")
        assert browser.driver.execute_script("return document.body.dataset.answered") == before
        browser.driver.find_element("id", "back").click()
        wait_for(browser, f"document.body.dataset.answered !== '{before}'")
        whole(browser)
        assert field.get_property("value") == "-300"
    wait_for(browser, "document.body.dataset.ended")
    assert "The program has ended" in browser.driver.find_element("id", "state").text


def test_several_contacts_in_space_and_a_telephone(browser):
    """The joint's contacts one by one, quick answers alone: its error bars take a while."""
    options = ["--set", "mesh.size=12", "--set", "mesh.sizes.bolt_M8=6", "--set", "steps.times=[1]"]
    options += ["--set", "mesh.curvature=8", "--set", "solver.errors=none"]
    with explored("joint.toml", *options) as address:
        opened(browser, address)
        maps = []
        for name in ("lap", "hole above"):
            buttons = browser.driver.find_elements("css selector", "#contacts button")
            next(one for one in buttons if one.text == name).click()
            browser.driver.execute_async_script("setTimeout(arguments[0], 700)")
            maps.append(picture(browser, "contact"))
        assert (np.abs(maps[0] - maps[1]).max(axis=2) > 40).mean() > 0.05
        assert len(np.unique(picture(browser, "body").reshape(-1, 3), axis=0)) > 200
        opened(browser, address, width=390)
        assert browser.driver.execute_script(
            "return document.documentElement.scrollWidth <= window.innerWidth + 1"
        )
