"""Matplotlib figures of panels that look alike, each as a PNG and, for papers, as a PDF."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from fenics_contact.common.atomic_files import replaced_file
from fenics_contact.common.wording import printable
from fenics_contact.report.drawing.paper import Paper, wanted, write_data
from fenics_contact.report.drawing.style import STYLE
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

_LETTER = 0.068  # width of a letter of a title in inches, about
_PAD = 0.04  # around a figure whose margins are cut off, in inches
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
    """Lay a figure out for good, and return its box without margins, in inches.

    Args:
        figure: Matplotlib's.
    """
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure.get_tightbbox().padded(_PAD)


def plain_ticks(figure: Figure) -> None:
    """Numbers on axes that are no formulas look the same, and take a third of the time.

    Args:
        figure: Matplotlib's.
    """
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
