"""Where the panels of a picture are, so that a page can draw into them what moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.atomic_files import replaced_file
from fenics_contact.report.drawing.figures import plain_ticks, style, tight_box

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

_POINTS = 72  # of an inch


@dataclass(frozen=True)
class Panel:
    """A panel of a picture.

    Attributes:
        box: Its left side and its top, its width and its height, as shares of the picture's.
        x: Numbers at its left and its right side.
        y: At its bottom and its top.
    """

    box: tuple[float, float, float, float]
    x: tuple[float, float]
    y: tuple[float, float]

    def as_dict(self) -> dict[str, Any]:
        """For a page."""
        return {name: [float(n) for n in getattr(self, name)] for name in ("box", "x", "y")}


@dataclass(frozen=True)
class Frame:
    """A picture on which a page draws.

    Attributes:
        width: In points, as sizes of letters and lines are.
        panels: Those that are drawn into.
    """

    width: float
    panels: list[Panel]


def frame_of(figure: Figure, panels: Sequence[Axes], box: Bbox | None = None) -> Frame:
    """Where panels of a figure are that has been saved.

    Args:
        figure: Matplotlib's; laid out.
        panels: Of it.
        box: What was saved of it, in inches; None for all.
    """
    width, height = figure.get_size_inches()
    left, bottom = (0.0, 0.0) if box is None else (box.x0, box.y0)
    across, up = (width, height) if box is None else (box.width, box.height)
    found = []
    for panel in panels:
        place = panel.get_position()
        top = 1 - (place.y1 * height - bottom) / up
        corner = (place.x0 * width - left) / across, top
        size = place.width * width / across, place.height * height / up
        found.append(Panel((*corner, *size), panel.get_xlim(), panel.get_ylim()))
    return Frame(_POINTS * across, found)


def save_frame(figure: Figure, panels: Sequence[Axes], path: Path, tight: bool = False) -> Frame:
    """Write a figure as a PNG that a page draws on.

    Args:
        figure: Matplotlib's.
        panels: Of it, those that are drawn into.
        path: Of the PNG file.
        tight: Whether its margins are cut off.
    """
    with style(), replaced_file(path) as temporary:
        plain_ticks(figure)
        box = tight_box(figure) if tight else None
        figure.savefig(temporary, **({} if box is None else {"bbox_inches": box}))
    return frame_of(figure, panels, box)


def numbers(values: Array, digits: int = 4) -> list[float | None]:
    """For a page, in so many digits; what is no number is null.

    Args:
        values: (points,).
        digits: Of each.
    """
    written = (f"%.{digits}g" % value for value in np.asarray(values, dtype=float).tolist())
    return [float(text) if text[-1].isdigit() else None for text in written]
