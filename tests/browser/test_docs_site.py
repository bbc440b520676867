"""The built documentation in Chromium, from files and without a network: ``make docs browser``."""

import json
import os
from html.parser import HTMLParser
from urllib.parse import unquote

import pytest

from tests.scenes import ROOT

pytestmark = pytest.mark.serial

SITE = ROOT / "docs" / "_build" / "html"
REQUIRED = os.environ.get("FENICS_CONTACT_BROWSER") == "required"
PHONE, DESKTOP = 390, 1440
# Sources are many and alike: one of them stands for all.
SOURCE = "files/fenics_contact/contact/laws/energies.py.html"


def pages():
    """Paths of the site's pages, but for sources and reports."""
    found = [path.relative_to(SITE).as_posix() for path in SITE.rglob("*.html")]
    return sorted(name for name in found if not name.startswith(("files/", "reports/", "_")))


@pytest.fixture(scope="module", autouse=True)
def site():
    """The folder of the built pages."""
    if not SITE.is_dir():
        if REQUIRED:
            pytest.fail("docs/_build/html is missing: `make docs` builds it")
        pytest.skip("needs the pages that `make docs` builds")


def settled(browser):
    """Wait for the formulas of a page; what it asked for that is not beside it."""
    browser.driver.execute_async_script(
        "const done = arguments[0];"
        "if (window.MathJax && MathJax.startup) MathJax.startup.promise.then(() => done());"
        "else done();"
    )
    names = browser.driver.execute_script(
        "return performance.getEntriesByType('resource').map(entry => entry.name)"
    )
    return [name for name in names if not name.startswith(("file:", "data:", "blob:"))]


def test_every_page_at_two_widths(browser):
    names = [*pages(), SOURCE]
    assert len(names) > 35
    for name in names:
        for width in (DESKTOP, PHONE):
            browser.open(SITE / name, width)
            assert settled(browser) == [], name
            assert browser.errors() == [], name
        assert browser.driver.execute_script(
            "return document.documentElement.scrollWidth <= window.innerWidth + 1"
        ), f"{name}: wider than a phone"
        broken = browser.driver.execute_script(
            "return [...document.images].filter(i => i.complete && !i.naturalWidth).map(i => i.src)"
        )
        assert broken == [], name
        wrong = "return document.querySelectorAll('mjx-merror').length"
        assert browser.driver.execute_script(wrong) == 0, f"{name}: a formula is wrong"
    assert browser.messages == []


@pytest.mark.parametrize("name", ["method.html", "teaching.html", "gallery/sphere.html"])
def test_formulas_are_drawn(name, browser):
    browser.open(SITE / name)
    settled(browser)
    asked, drawn, height = browser.driver.execute_script(
        "const drawn = document.querySelectorAll('mjx-container svg');"
        "return [document.querySelectorAll('.math').length, drawn.length,"
        " drawn[0].getBoundingClientRect().height]"
    )
    assert drawn >= asked > 3
    assert height > 8


def test_search_works_without_a_network(browser):
    from selenium.webdriver.support.ui import WebDriverWait

    browser.driver.get(f"{(SITE / 'search.html').as_uri()}?q=hysteresis")
    found = "return [...document.querySelectorAll('#search-results li a')].map(a => a.href)"
    WebDriverWait(browser.driver, 20).until(lambda one: one.execute_script(found))
    links = browser.driver.execute_script(found)
    assert any("gallery/cycle.html" in link for link in links)
    assert settled(browser) == []


def test_report_of_a_demo_opens_from_the_gallery(browser):
    browser.open(SITE / "gallery" / "slab.html")
    browser.driver.execute_script("document.querySelector('a[href$=\"report.html\"]').click()")
    assert "prescribed contact pressure" in browser.driver.title


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
    assert "files/fenics_contact/contact/laws/energies.py.html#smoothed_norm" in targets
    assert sum(target.startswith("files/") for target in targets) > 80


def test_notebook_can_be_downloaded_with_its_results(links):
    (target,) = [one for one in links["teaching.html"].targets if one.endswith(".ipynb")]
    notebook = json.loads((SITE / target).read_text(encoding="utf-8"))
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) > 15
    assert sum(bool(cell["outputs"]) for cell in cells) > 12
    assert not [out for cell in cells for out in cell["outputs"] if out["output_type"] == "error"]


def test_gallery_has_every_demo_and_its_numbers():
    for scene in (ROOT / "demos").glob("*.toml"):
        page = (SITE / "gallery" / f"{scene.stem}.html").read_text(encoding="utf-8")
        for words in ("Expected and obtained", "unknowns", "kinematics"):
            assert words in page, f"{scene.stem}: {words}"
        if "left out of this build" not in page:  # as CI leaves most out
            assert "<img" in page and "reports/" in page, scene.stem
