"""Sphinx: links to the repository's files lead to pages that show them, with definitions marked.

A link such as ``[`smoothed_norm`](../fenics_contact/contact/laws/energies.py)`` works in the
repository as it stands. In the built pages it leads to the definition that its text names, if it
names one.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parent.parent
LEXERS = {".py": "python", ".toml": "toml", ".geo": "c", ".cff": "yaml"}
# Files that are linked to, found while pages are read and autodoc is asked for sources.
_FOLDER = "files"


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to the build."""
    app.setup_extension("sphinx.ext.linkcode")
    app.config.linkcode_resolve = source_page
    app.connect("doctree-read", _replace_downloads)
    app.connect("doctree-resolved", _set_addresses)
    app.connect("html-collect-pages", _pages)
    return {"parallel_read_safe": False, "parallel_write_safe": True}


def source_page(domain: str, info: dict[str, str]) -> str | None:
    """For autodoc's links to sources, relative to a page beside the first one."""
    path = ROOT.joinpath(*info["module"].split("."))
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    name = info["fullname"]
    if path.name == "__init__.py":
        moved = _origin(info["module"], name)
        path = path if moved is None else moved
    if not path.is_file() or name not in definitions(path.read_text(encoding="utf-8")):
        return None
    return f"{_page_of(path)}.html#{name}"


def _origin(module: str, name: str) -> Path | None:
    """Where a name that a package passes on is defined."""
    import importlib

    value = getattr(importlib.import_module(module), name.partition(".")[0], None)
    origin = getattr(value, "__module__", None)
    return None if origin is None else ROOT.joinpath(*origin.split(".")).with_suffix(".py")


def definitions(text: str) -> dict[str, int]:
    """Functions, classes and Class.method of a Python file → line, from 1."""
    found: dict[str, int] = {}

    def visit(node: ast.AST, prefix: str) -> None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.FunctionDef | ast.ClassDef):
                first = min([child.lineno, *(one.lineno for one in child.decorator_list)])
                found.setdefault(prefix + child.name, first)
                if isinstance(child, ast.ClassDef):
                    visit(child, f"{prefix}{child.name}.")

    visit(ast.parse(text), "")
    return found


def _replace_downloads(app: Sphinx, doctree: nodes.document) -> None:
    """Links that would download a file of the repository become links to its page."""
    here = Path(app.env.doc2path(app.env.docname)).parent
    for node in list(doctree.findall(addnodes.download_reference)):
        target = node["reftarget"]
        path = Path(app.srcdir, target.lstrip("/")) if target.startswith("/") else here / target
        path = path.resolve()
        if not path.is_relative_to(ROOT) or path.is_relative_to(Path(app.srcdir)):
            continue
        name = node.astext()
        link = nodes.reference("", "", *node.children, internal=True)
        link["repository_file"] = path.relative_to(ROOT).as_posix()
        if path.suffix == ".py" and name in definitions(path.read_text(encoding="utf-8")):
            link["repository_name"] = name
        node.replace_self(link)


def _set_addresses(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    for node in doctree.findall(nodes.reference):
        if "repository_file" in node:
            page = _page_of(ROOT / node["repository_file"])
            address = app.builder.get_relative_uri(docname, page)
            name = node.get("repository_name")
            node["refuri"] = f"{address}#{name}" if name else address


def _page_of(path: Path) -> str:
    return f"{_FOLDER}/{path.relative_to(ROOT).as_posix()}"


def _pages(app: Sphinx) -> Iterator[tuple[str, dict[str, Any], str]]:
    """A page a file: all of the package, and what any page links to."""
    linked = {
        ROOT / node["repository_file"]
        for name in app.env.found_docs
        for node in app.env.get_doctree(name).findall(nodes.reference)
        if "repository_file" in node
    }
    package = set((ROOT / "fenics_contact").rglob("*.py"))
    for path in sorted(linked | package):
        name = path.relative_to(ROOT).as_posix()
        body = f"<h1>{escape(name)}</h1>\n{_highlighted(app, path)}"
        yield _page_of(path), {"title": name, "body": body}, "page.html"


def _highlighted(app: Sphinx, path: Path) -> str:
    """The text of a file, an anchor before every definition."""
    text = path.read_text(encoding="utf-8")
    language = LEXERS.get(path.suffix, "text")
    shown: str = app.builder.highlighter.highlight_block(text, language)  # type: ignore[attr-defined]
    if language != "python":
        return shown
    before, opening, rest = shown.partition("<pre>")
    lines = rest.split("\n")
    blank = len(text) - len(text.lstrip("\n"))  # Pygments drops these
    for name, number in definitions(text).items():
        place = number - 1 - blank
        lines[place] = f'<span id="{name}"></span>{lines[place]}'
    return before + opening + "\n".join(lines)
