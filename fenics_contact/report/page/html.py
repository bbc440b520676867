"""Pieces of HTML pages; all text is escaped but what says that it is HTML.

Characters that would turn the direction of writing, or show nothing, are written out.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path

from fenics_contact.common.plain_text import printable

_KINDS = {".png": "image/png", ".gif": "image/gif"}


class Html(str):
    """Text that is HTML already."""


def html(text: str) -> Html:
    """Text in HTML; what is HTML stays as it is."""
    return text if isinstance(text, Html) else Html(escape(printable(text)))


def element(tag: str, content: str, **attributes: str) -> Html:
    """An element around a text; ``kind`` is its class, and underscores are hyphens."""
    names = {"kind": "class"}
    said = "".join(
        f' {names.get(name, name.replace("_", "-"))}="{html(value)}"'
        for name, value in attributes.items()
    )
    return Html(f"<{tag}{said}>{html(content)}</{tag}>")


def joined(parts: Iterable[str], between: str = "\n") -> Html:
    """Parts one after the other."""
    return Html(between.join(html(part) for part in parts))


def paragraph(text: str, **attributes: str) -> Html:
    """A paragraph; nothing of an empty text."""
    return element("p", text, **attributes) if text else Html()


def bullets(items: Iterable[str]) -> Html:
    """A list of points; nothing of none."""
    entries = joined(element("li", item) for item in items)
    return element("ul", entries) if entries else Html()


def table(rows: Sequence[Sequence[str]], caption: str = "", head: bool = True) -> Html:
    """A table, each row of which is named by its first cell.

    Args:
        rows: Its cells; the first row names the columns where there is a head.
        caption: What it is of, read aloud where it cannot be seen.
        head: Whether there is one.
    """
    first = [joined(element("th", cell, scope="col") for cell in rows[0])] if head else []
    body = [
        joined([element("th", row[0], scope="row"), *(element("td", cell) for cell in row[1:])], "")
        for row in rows[bool(head) :]
    ]
    parts = [
        *([element("caption", caption)] if caption else []),
        *(element("thead", element("tr", cells)) for cells in first),
        element("tbody", joined(element("tr", cells) for cells in body)),
    ]
    # wider ones are scrolled, also by keys
    return element("div", element("table", joined(parts)), kind="wide", tabindex="0")


def bar(share: float, words: str, failed: bool = False) -> Html:
    """A share as a bar with its words beside it.

    Args:
        share: Of the whole bar, at which it ends.
        words: What the bar says.
        failed: Whether it is of something that failed.
    """
    width = f"width:{100 * min(max(share, 0.0), 1.0):.3g}%"
    filled = element("i", "", style=width)
    kind = "bar failed" if failed else "bar"
    return Html(f"{element('span', filled, kind=kind, aria_hidden='true')} {html(words)}")


def data_uri(path: Path) -> str:
    """A picture's file as an address that holds all of it."""
    content = base64.b64encode(path.read_bytes()).decode("ascii")
    return f"data:{_KINDS[path.suffix]};base64,{content}"
