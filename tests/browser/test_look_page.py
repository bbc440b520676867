"""The page of ``look`` in a browser: a click on a surface says what it is."""

import io

import numpy as np
import pytest
from PIL import Image

from fenics_contact import main
from tests import cad

pytestmark = pytest.mark.serial

FLAT = 'SetFactory("OpenCASCADE");\nRectangle(1) = {0,0,0,2,1};\nRectangle(2) = {1,1,0,3,1};\n'


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    pytest.importorskip("plotly")
    folder = tmp_path_factory.mktemp("look")
    labels = ("<img src=x onerror=alert(1)>", "plate", "bolt")
    files = {"3D": cad.write_shapes(folder / "joint.step", cad.joint, labels)}
    files["plane"] = str(folder / "plane.geo")
    (folder / "plane.geo").write_text(FLAT)
    for name, file in files.items():
        assert main(["look", file, "--out", str(folder / name), "--quiet"]) == 0
    return {name: folder / name / "look.html" for name in files}


def shown(browser, page, width=1280):
    browser.open(page, width)
    browser.driver.execute_async_script(
        """const done = arguments[0];
        (function look() {
            document.getElementById("view").dataset.ready ? setTimeout(done, 300)
                                                          : setTimeout(look, 50);
        })();"""
    )


def said(browser):
    return browser.driver.find_element("id", "said").text


def pixels(browser):
    content = browser.driver.find_element("id", "view").screenshot_as_png
    return np.array(Image.open(io.BytesIO(content)).convert("RGB"), dtype=int)


def chosen(picture):
    """How many pixels have the colour of what is chosen, in whatever light."""
    red, green, blue = picture.transpose(2, 0, 1)
    return int(((red > 2 * green) & (red > 4 * blue) & (red > 100)).sum())


def test_a_click_on_a_surface_says_what_it_is(pages, browser):
    from selenium.webdriver import ActionChains

    shown(browser, pages["3D"])
    assert chosen(pixels(browser)) == 0
    view = browser.driver.find_element("id", "view")
    moves = ActionChains(browser.driver).move_to_element_with_offset(view, 30, 60).pause(0.3)
    moves.move_by_offset(3, 3).pause(0.5).click_and_hold().pause(0.3).release().perform()
    browser.driver.execute_async_script("setTimeout(arguments[0], 500)")
    assert "surface " in said(browser) and "of body " in said(browser)
    assert chosen(pixels(browser)) > 500


def test_tables_choose_surfaces_and_pairs_and_hide_bodies(pages, browser):
    shown(browser, pages["3D"])
    button = browser.driver.find_element("css selector", '[data-surface="17"]')
    browser.driver.execute_script("arguments[0].click()", button)
    assert "surface 18 · cylinder" in said(browser)
    assert "axis (0, 0, 1), radius 2" in said(browser)
    assert button.get_attribute("aria-pressed") == "true"
    pair = browser.driver.find_elements("css selector", "[data-pair]")[3]  # the head on its plate
    browser.driver.execute_script("arguments[0].click()", pair)
    assert len(said(browser).splitlines()) == 2
    before = chosen(pixels(browser))
    body = browser.driver.find_element("css selector", '[data-body="1"]')
    browser.driver.execute_script("arguments[0].click()", body)
    assert chosen(pixels(browser)) < before / 2
    assert "<img" not in browser.driver.find_element("id", "bodies").get_attribute("innerHTML")


def test_plane_models_and_phones(pages, browser):
    for name in ("plane", "3D"):
        shown(browser, pages[name], 390)
        assert browser.driver.execute_script(
            "return document.documentElement.scrollWidth <= window.innerWidth + 1"
        )
    shown(browser, pages["plane"])
    pair = browser.driver.find_element("css selector", "[data-pair]")
    browser.driver.execute_script("arguments[0].click()", pair)
    assert "curve 3 · straight line" in said(browser)
    assert chosen(pixels(browser)) > 100
