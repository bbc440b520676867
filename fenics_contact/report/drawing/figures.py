"""Matplotlib figures of panels that look alike, for pages and, with their data, for papers.

Within ``for_paper`` the pictures of a report are drawn as vectors in the width asked for, each into
the folder ``figures`` beside where the report has it. Text keeps its size in points, so that it is
as large in print as here. Beside a figure stands a CSV file with what its curves are drawn from.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.atomic_files import make_folder, replace_file, replaced_file
from fenics_contact.common.wording import printable
from fenics_contact.report.drawing.style import LINES, STYLE
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

FOLDER = "figures"
INCH = 25.4  # mm


@dataclass(frozen=True)
class Paper:
    """How figures are wanted.

    Attributes:
        format: ``pdf`` or ``svg``.
        width: Of each (mm); None as the report has them.
    """

    format: str
    width: float | None = None

    def size(self, given: tuple[float, float]) -> tuple[float, float]:
        """Width and height in inches of a figure that the report would have as given.

        Narrower ones stay as high, as the letters of their axes do.
        """
        if self.width is None:
            return given
        width = self.width / INCH
        return width, given[1] * max(width / given[0], 1.0)

    def file(self, path: Path) -> Path:
        """Where a figure goes, whose picture in the report has a path; the folder is made."""
        make_folder(path.parent / FOLDER)
        return path.parent / FOLDER / f"{path.stem}.{self.format}"


_wanted: ContextVar[Paper | None] = ContextVar("paper", default=None)


def wanted() -> Paper | None:
    """How figures are wanted at present; None for those of a report."""
    return _wanted.get()


@contextmanager
def for_paper(paper: Paper) -> Iterator[None]:
    """Within it, pictures are drawn for a paper."""
    token = _wanted.set(paper)
    try:
        yield
    finally:
        _wanted.reset(token)


def write_data(figure: Figure, path: Path) -> None:
    """Write the points of all curves of a figure: a row a point, with its panel and its curve.

    Args:
        figure: Matplotlib's.
        path: Of the CSV file; none is written for a figure without curves.
    """
    rows = [row for number, panel in enumerate(figure.axes, 1) for row in _rows(panel, number)]
    if not rows:
        return
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(["panel", "x_label", "y_label", "curve", "x", "y"])
    writer.writerows(rows)
    replace_file(path, text.getvalue().encode())


def _rows(panel: Axes, number: int) -> Iterator[list[object]]:
    """Yield the rows of a panel's curves whose names do not begin with an underscore."""
    for line in panel.get_lines():
        if line.get_transform() != panel.transData:  # as a line at 0 across the whole panel
            continue
        label = str(line.get_label())
        name = "" if label.startswith("_") else label
        places = np.column_stack([np.asarray(values, float) for values in line.get_data()])
        for x, y in places[np.isfinite(places).all(axis=1)].tolist():
            yield [number, panel.get_xlabel(), panel.get_ylabel(), name, x, y]


_LETTER = 0.068  # width of a letter of a title in inches, about
_PAD = 0.04  # around a figure whose margins are cut off, in inches
# Points from which on a curve has no marks.
_MANY = 60
_ROW = 0.3  # height of a row of a legend with the room around it, in inches


@contextmanager
def style() -> Iterator[None]:
    """Within it, all that matplotlib draws is in the style of this program."""
    import matplotlib

    with matplotlib.rc_context(STYLE):
        yield


def new_figure(title: str, size: tuple[float, float], **panels: Any) -> tuple[Figure, list[Axes]]:
    """A figure and its panels; matplotlib's state, as of a notebook, stays as it is.

    Args:
        title: Of the first panel, any text.
        size: Width and height in inches, in a report; in a paper it is as wide as is wanted there.
        **panels: For matplotlib's ``subplots``; also ``height_ratios`` and ``dpi``.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    paper = wanted()
    size = size if paper is None else paper.size(size)
    with style():
        figure = Figure(figsize=size, layout="constrained", dpi=panels.pop("dpi", None))
        FigureCanvasAgg(figure)
        ratios: dict[str, Any] = {
            key: panels.pop(key) for key in ("height_ratios", "width_ratios") if key in panels
        }
        axes = figure.subplots(squeeze=False, gridspec_kw=ratios, **panels)
        set_title(axes[0, 0], title)
    return figure, list(axes.flat)


def set_title(panel: Axes, title: str, pad: float | None = None) -> None:
    """Set a panel's title, any text, on several lines if it is long: dollars are dollars.

    Args:
        panel: Matplotlib's axes.
        title: Of it.
        pad: Distance from it, in points; by default the style's.
    """
    columns = panel.get_gridspec().ncols
    width = int(panel.figure.get_figwidth() / columns / _LETTER)
    panel.set_title("\n".join(wrap(plain(title), width)), pad=pad)


def legend_beside(panel: Axes, **look: Any) -> None:
    """A legend on the right of a panel, where it covers nothing.

    Args:
        panel: Matplotlib's axes.
        **look: For matplotlib's ``legend``.
    """
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), **look)


def legend_in_headroom(panel: Axes, columns: int = 2) -> None:
    """A legend of one row inside of a panel, above all that is drawn so far."""
    low, high = panel.get_ylim()
    inches = panel.get_position().height * panel.figure.get_figheight()
    panel.set_ylim(low, high + min(_ROW / inches, 0.5) * (high - low))
    panel.legend(loc="upper left", ncols=columns)


def plain(text: str) -> str:
    """Any text for matplotlib, as in a legend: a dollar is one, and begins no formula."""
    return printable(text).replace("$", r"\$")


def save(figure: Figure, path: Path, tight: bool = False) -> None:
    """Write a figure as a PNG, and beside it as a PDF that is the same in every run.

    For a paper it is one file of vectors, with a table of its curves beside it.

    Args:
        figure: Matplotlib's.
        path: Of the PNG file.
        tight: Whether its margins are cut off, where panels of equal scales leave some.
    """
    box: dict[str, Any] = {}
    paper = wanted()
    with style():
        plain_ticks(figure)
        if paper is not None:
            _save_for(paper, figure, path)
            return
        if tight:  # once, and not for each of the two files
            box = {"bbox_inches": tight_box(figure)}
        with replaced_file(path) as temporary:
            figure.savefig(temporary, **box)
        figure.set_layout_engine("none")  # as it is now: to lay out again takes as long as to draw
        with replaced_file(path.with_suffix(".pdf")) as temporary:
            figure.savefig(temporary, metadata={"CreationDate": None}, **box)


def _save_for(paper: Paper, figure: Figure, path: Path) -> None:
    """Save a figure of the requested width, as high as its content."""
    file, inches = paper.file(path), figure.get_figwidth()
    drawn = tight_box(figure)
    box = type(drawn).from_extents(0, drawn.y0, inches, drawn.y1)
    date = {"pdf": "CreationDate", "svg": "Date"}[paper.format]
    with replaced_file(file) as temporary:
        figure.savefig(temporary, format=paper.format, metadata={date: None}, bbox_inches=box)
    write_data(figure, file.with_suffix(".csv"))


def tight_box(figure: Figure) -> Bbox:
    """Lay a figure out for good, and return its box without margins, in inches."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure.get_tightbbox().padded(_PAD)


def plain_ticks(figure: Figure) -> None:
    """Numbers on axes that are no formulas look the same, and take a third of the time."""
    from matplotlib.ticker import ScalarFormatter

    class Plain(ScalarFormatter):  # type: ignore[misc]
        """Formulas are kept for the power of ten beside an axis."""

        def __call__(self, x: float, pos: int | None = None) -> str:
            """A number on the axis."""
            text: str = super().__call__(x, pos)
            return text.removeprefix(r"$\mathdefault{").removesuffix("}$")

    for panel in figure.axes:
        for axis in (panel.xaxis, panel.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(Plain())


def save_png(figure: Figure, path: Path) -> None:
    """Write a figure as a PNG alone, as the pages of the documentation want it."""
    with style(), replaced_file(path) as temporary:
        figure.savefig(temporary)


def surface_of(contact: ContactRecord) -> str:
    """A contact of ``result.json`` by its name; by that of a surface, with the one opposite."""
    sides = (contact.slave, contact.master)
    if contact.name not in sides:
        return f"'{contact.name}'"
    return f"'{contact.name}' against '{sides[sides.index(contact.name) - 1]}'"


def in_words(parts: list[str]) -> str:
    """Join parts in words, such as: pressure, friction and gap."""
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def title_of(panels: list[str], contact: ContactRecord) -> str:
    """Return a title, such as: Contact pressure and gap on 'top'."""
    words = in_words(panels)
    return f"{words[0].upper()}{words[1:]} on {surface_of(contact)}"


def line(panel: Axes, x: Array, y: Array, label: str, number: int) -> None:
    """Draw one of several curves, told apart by colour and dashes.

    Args:
        panel: Matplotlib's axes.
        x: To the right, (points,).
        y: Upwards, likewise.
        label: Of the legend.
        number: Of the curve, from 0.
    """
    colour, dashes = LINES[number % len(LINES)]
    mark = "." if len(x) <= _MANY else ""
    panel.plot(x, y, linestyle=dashes, color=colour, marker=mark, label=label)
