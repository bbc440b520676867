"""Figures for papers and lectures: vectors in the width asked for, and the data of their curves.

Within ``for_paper`` the pictures of a report are drawn in that width, each into the folder
``figures`` beside where the report has it. Text keeps its size in points, so that it is as large in
print as here. Beside a figure stands a CSV file with what its curves are drawn from.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.atomic_files import make_folder, replace_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

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
