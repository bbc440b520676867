"""Jinja's templates of a run's page: all text is escaped but what says that it is HTML.

Characters that would turn the direction of writing, or show nothing, are written out.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

from jinja2 import ChoiceLoader, Environment, FunctionLoader, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from fenics_contact.analyses import registry
from fenics_contact.common.wording import printable
from fenics_contact.report.drawing.style import small_png

_KINDS = {".png": "image/png", ".gif": "image/gif"}


def html(text: str) -> Markup:
    """Text in HTML; what is HTML stays as it is."""
    return text if isinstance(text, Markup) else escape(printable(text))


def data_uri(path: Path) -> str:
    """A picture's file as an address that holds all of it, of a large one with fewer colours."""
    picture = small_png(path) if path.suffix == ".png" else path.read_bytes()
    content = base64.b64encode(picture).decode("ascii")
    return f"data:{_KINDS[path.suffix]};base64,{content}"


def _of_analyses(name: str) -> str | None:
    """The text of a template in the folder of an analysis; None where no analysis has it."""
    for analysis in registry.every():
        file = resources.files(analysis.package).joinpath(name)
        if file.is_file():
            return file.read_text(encoding="utf-8")
    return None


_environment = Environment(
    loader=ChoiceLoader([PackageLoader(__package__), FunctionLoader(_of_analyses)]),
    autoescape=True,
    undefined=StrictUndefined,
    finalize=lambda value: value if isinstance(value, Markup) else printable(str(value)),
)
_environment.filters["data_uri"] = data_uri


def render(name: str, **values: object) -> str:
    """A template with its values in place.

    Args:
        name: Of its file.
        values: By the names that it has for them.
    """
    return _environment.get_template(name).render(values)


def _piece(name: str, *values: object) -> Markup:
    return Markup(getattr(_environment.get_template("pieces.html").module, name)(*values))


def table(rows: Sequence[Sequence[str]], caption: str, head: bool = True) -> Markup:
    """A table, each row of which is named by its first cell.

    Args:
        rows: Its cells; the first row names the columns where there is a head.
        caption: What it is of, read aloud where it cannot be seen.
        head: Whether there is one.
    """
    return _piece("table", rows, caption, head)


def bar(share: float, words: str, failed: bool = False) -> Markup:
    """A share as a bar with its words beside it.

    Args:
        share: Of the whole bar, at which it ends.
        words: What the bar says.
        failed: Whether it is of something that failed.
    """
    return _piece("bar", share, words, failed)


def verdict(passed: bool) -> Markup:
    """Whether a check passed."""
    return _piece("verdict", passed)


def file_text(name: str) -> Markup:
    """Text of a style sheet or a script of this folder, as a page holds it."""
    return Markup(resources.files(__package__).joinpath(name).read_text(encoding="utf-8"))


def style_sheet() -> Markup:
    """The style of all pages."""
    return file_text("report.css")
