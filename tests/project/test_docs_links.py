"""Links of the pages as they stand in the repository: each leads to a file, and to a heading."""

import functools
import importlib.util
import re
from itertools import pairwise

import pytest
from markdown_it import MarkdownIt

from tests.scenes import ROOT

PAGES = [page for page in ROOT.glob("*.md")] + sorted((ROOT / "docs").rglob("*.md"))
PAGES = [page for page in PAGES if not {"_build", "gallery"} & set(page.parts)]


def links_of(page):
    """Targets of the links and pictures of a page."""
    for token in MarkdownIt().enable("table").parse(page.read_text(encoding="utf-8")):
        for child in token.children or ():
            target = child.attrs.get("href") or child.attrs.get("src")
            if target and "://" not in target:
                yield target


@functools.cache
def anchors_of(page):
    """Anchors of a page's headings, as GitHub and MyST make them."""
    tokens = MarkdownIt().parse(page.read_text(encoding="utf-8"))
    titles = [after.content for before, after in pairwise(tokens) if before.type == "heading_open"]
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_somewhere(page):
    for target in links_of(page):
        name, _, anchor = target.partition("#")
        path = (page.parent / name).resolve() if name else page
        if path.name == "teaching.ipynb":  # made when the pages are built
            continue
        assert path.exists(), f"{target}: no such file"
        if anchor:
            assert anchor in anchors_of(path), f"{target}: no such heading"


def test_pages_are_found():
    assert len(PAGES) > 25
    assert sum(len(list(links_of(page))) for page in PAGES) > 150
    assert "checks" in anchors_of(ROOT / "docs" / "method.md")


def test_api_page_has_every_public_name():
    import fenics_contact

    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    shown = set(re.findall(r":: fenics_contact\.(\w+)$", page, re.MULTILINE))
    assert shown == set(fenics_contact.__all__)


def test_the_readme_is_read_to_its_end():
    """What more there is to say stands in the documentation."""
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 150


def test_modules_are_documented_once():
    """Sphinx refuses to build pages that describe one twice, which merging two of them makes."""
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    names = re.findall(r"^\.\. automodule:: (\S+)", text, re.MULTILINE)
    assert len(names) > 20
    assert sorted(names) == sorted(set(names))
    assert not [name for name in names if importlib.util.find_spec(name) is None]
