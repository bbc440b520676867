"""The built documentation in Chromium, from files and without a network: ``make docs browser``."""

import json
import os
import shutil
from html.parser import HTMLParser
from urllib.parse import unquote

import pytest

from tests.scenes import ROOT

pytestmark = pytest.mark.serial

SITE = ROOT / "docs" / "_build" / "html"
REQUIRED = os.environ.get("FENICS_CONTACT_BROWSER") == "required"
PHONE, DESKTOP = (390, 844), (1440, 1000)
# Sources are many and alike: one of them stands for all.
SOURCE = "files/fenics_contact/friction.py.html"


def pages():
    """Paths of the site's pages, but for sources and reports."""
    found = [path.relative_to(SITE).as_posix() for path in SITE.rglob("*.html")]
    return sorted(name for name in found if not name.startswith(("files/", "reports/", "_")))


@pytest.fixture(scope="module")
def driver():
    """Chromium that finds no network, and keeps what a page asks for and complains about."""
    webdriver = pytest.importorskip("selenium.webdriver") if not REQUIRED else None
    if webdriver is None:
        from selenium import webdriver
    chromium, chromedriver = (shutil.which(name) for name in ("chromium", "chromedriver"))
    missing = not chromium or not chromedriver or not SITE.is_dir()
    if missing and not REQUIRED:
        pytest.skip("needs chromium, chromedriver, and the pages that `make docs` builds")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for word in (
        "headless",
        "no-sandbox",
        "disable-gpu",
        "disable-dev-shm-usage",
        "host-resolver-rules=MAP * ~NOTFOUND",
    ):
        options.add_argument(f"--{word}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    started = webdriver.Chrome(options, webdriver.ChromeService(chromedriver))
    yield started
    started.quit()


def visit(driver, name, size=DESKTOP):
    """Open a page, wait for its formulas, and return what it complained about and asked for."""
    driver.get_log("browser"), driver.get_log("performance")
    driver.set_window_size(*size)
    driver.get(f"{SITE.as_uri()}/{name}")
    driver.set_script_timeout(30)
    driver.execute_async_script(
        "const done = arguments[0];"
        "if (window.MathJax && MathJax.startup) MathJax.startup.promise.then(() => done());"
        "else done();"
    )
    said = [entry for entry in driver.get_log("browser") if entry["level"] != "INFO"]
    asked = []
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            asked.append(message["params"]["request"]["url"])
    return said, [url for url in asked if not url.startswith(("file:", "data:", "blob:"))]


def test_every_page_at_two_widths(driver):
    names = [*pages(), SOURCE]
    assert len(names) > 35
    for name in names:
        for size in (DESKTOP, PHONE):
            said, elsewhere = visit(driver, name, size)
            assert not said, f"{name}: {said}"
            assert not elsewhere, f"{name} asks {elsewhere}"
        assert driver.execute_script(
            "return document.documentElement.scrollWidth <= window.innerWidth + 1"
        ), f"{name}: wider than a phone"
        broken = driver.execute_script(
            "document.querySelectorAll('img').forEach(image => image.loading = 'eager');"
            "return [...document.images].filter(i => i.complete && !i.naturalWidth).map(i => i.src)"
        )
        assert not broken, f"{name}: {broken}"
        errors = driver.execute_script("return document.querySelectorAll('mjx-merror').length")
        assert errors == 0, f"{name}: a formula is wrong"


@pytest.mark.parametrize("name", ["method.html", "teaching.html", "gallery/sphere.html"])
def test_formulas_are_drawn(driver, name):
    visit(driver, name)
    asked, drawn, height = driver.execute_script(
        "const drawn = document.querySelectorAll('mjx-container svg');"
        "return [document.querySelectorAll('.math').length, drawn.length,"
        " drawn[0].getBoundingClientRect().height]"
    )
    assert drawn >= asked > 3
    assert height > 8


def test_search_works_without_a_network(driver):
    from selenium.webdriver.support.ui import WebDriverWait

    said, elsewhere = visit(driver, "search.html?q=hysteresis")
    found = "return [...document.querySelectorAll('#search-results li a')].map(a => a.href)"
    WebDriverWait(driver, 20).until(lambda one: one.execute_script(found))
    assert any("gallery/cycle.html" in link for link in driver.execute_script(found))
    assert not said and not elsewhere


def test_report_of_a_demo_opens_from_the_gallery(driver):
    visit(driver, "gallery/cattaneo.html")
    driver.execute_script("document.querySelector('a[href$=\"report.html\"]').click()")
    assert "pushed sideways" in driver.title
    assert not [entry for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]


class Links(HTMLParser):
    """The links of a page, and the anchors in it."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors.add(values.get("id"))
        if tag == "a" and values.get("href"):
            self.targets.append(values["href"])


@pytest.fixture(scope="module")
def links():
    if not SITE.is_dir() and not REQUIRED:
        pytest.skip("needs the pages that `make docs` builds")
    names = [
        *pages(),
        *(path.relative_to(SITE).as_posix() for path in SITE.rglob("files/**/*.html")),
    ]
    return {name: Links((SITE / name).read_text(encoding="utf-8")) for name in names}


def test_every_link_leads_to_a_page_and_a_place(links):
    checked = 0
    for name, found in links.items():
        for target in found.targets:
            if target.startswith(("http://", "https://", "mailto:")):
                continue
            path, _, anchor = unquote(target).partition("#")
            whole = (SITE / name).parent / path if path else SITE / name
            assert whole.resolve().exists(), f"{name}: {target}"
            other = links.get(whole.resolve().relative_to(SITE.resolve()).as_posix())
            if anchor and other is not None:
                assert anchor in other.anchors, f"{name}: {target}"
                checked += 1
    assert checked > 500


def test_method_page_leads_to_definitions(links):
    targets = links["method.html"].targets
    assert "files/fenics_contact/friction.py.html#smoothed_norm" in targets
    assert sum(target.startswith("files/") for target in targets) > 80


def test_notebook_can_be_downloaded_with_its_results(links):
    (target,) = [one for one in links["teaching.html"].targets if one.endswith(".ipynb")]
    notebook = json.loads((SITE / target).read_text(encoding="utf-8"))
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) > 15
    assert sum(bool(cell["outputs"]) for cell in cells) > 12
    assert not [out for cell in cells for out in cell["outputs"] if out["output_type"] == "error"]


def test_gallery_has_every_demo_and_its_numbers():
    if not SITE.is_dir() and not REQUIRED:
        pytest.skip("needs the pages that `make docs` builds")
    for scene in (ROOT / "demos").glob("*.toml"):
        page = (SITE / "gallery" / f"{scene.stem}.html").read_text(encoding="utf-8")
        for words in ("Expected and obtained", "unknowns", "<img", "reports/", "kinematics"):
            assert words in page, f"{scene.stem}: {words}"
