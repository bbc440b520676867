"""A contact line of a flat model, its points in order, and the values that are drawn along it.

Still pictures, the slider of the report and pages of several runs all draw these values.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.report.drawing.cells import contact_pieces
from fenics_contact.report.drawing.charts import Cylinder, chart_of
from fenics_contact.report.drawing.style import Mark, labelled, marks, neighbourhood
from fenics_contact.results.contact_points import CURRENT_PLACE, ContactTable, PointArray
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import UnstructuredGrid


def shown_arrays(rows: ContactTable, contact: ContactRecord) -> dict[str, PointArray]:
    """Return the arrays that are not zero everywhere, by their names in pictures.

    Args:
        rows: Points of a contact.
        contact: Its entry in ``result.json``.
    """
    arrays = [array for array in contact.own_arrays if array != CURRENT_PLACE]
    return {array.words: array for array in arrays if np.nan_to_num(sizes(rows, array)).any()}


def sizes(rows: ContactTable, array: PointArray) -> Array:
    """Return an array's values at the points, or the lengths of its vectors, (points,)."""
    values = rows.vectors(*array.columns)
    return np.linalg.norm(values, axis=1) if array.is_vector else values[:, 0]


def label(array: PointArray) -> str:
    """Return the label of an array's axis or colour bar."""
    return labelled(f"{array.words}, size" if array.is_vector else array.words, array.unit)


# Normals that lean so far to both sides of a line are of one that turns back: it is unrolled.
_TURNS_BACK = 0.1


@dataclass(frozen=True)
class SurfaceLine:
    """A contact line, its points in order.

    Attributes:
        rows: Its points.
        axis: Number of the axis along which it extends most.
        circle: Of a line that turns back, as around a pin: its circle, unrolled; else None.
        position: Coordinate on that axis, or arc length R θ (length).
        pieces: Number of the connected part of the line that each point is of, (points,).
        order: Numbers of its points among the rows that it was made of, (points,).
        view: What of it is shown: the lowest and the highest position.
        marks: How its points look.
    """

    rows: ContactTable
    axis: int
    circle: Cylinder | None
    position: Array
    pieces: Integers
    order: Integers
    view: tuple[float, float]
    marks: tuple[Mark, ...]

    @classmethod
    def of(cls, body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord) -> SurfaceLine:
        """The whole line where its pressure is given, else the contact zone's neighbourhood.

        Args:
            body: A pyvista grid with its fields.
            rows: Points of the contact.
            contact: Its entry in ``result.json``.
        """
        axis, circle, position = positions(rows)
        order = np.argsort(position, kind="stable")
        pieces = _pieces(body, rows, contact)[order]
        rows, position = rows.rows(order), position[order]
        low, high = float(position[0]), float(position[-1])
        if not contact.pressure_is_given:
            around = neighbourhood(position[:, None], rows.closed)
            low, high = max(low, float(around[0][0])), min(high, float(around[1][0]))
        return cls(rows, axis, circle, position, pieces, order, (low, high), marks(contact))

    def then(self, rows: ContactTable) -> SurfaceLine:
        """Return the line in another load step.

        Args:
            rows: Its points then, as those that it was made of.
        """
        return replace(self, rows=rows.rows(self.order))

    def label(self, panel: Axes, axes: str) -> None:
        """Name the axis of a panel.

        Args:
            panel: Matplotlib's axes.
            axes: Letters of the model's axes.
        """
        if self.circle is not None:
            self.circle.label(panel, upwards=False)
        else:
            along = f"position along the surface, ${axes[self.axis]}$"
            panel.set_xlabel(labelled(along, "length"))

    @property
    def tangents(self) -> Array:
        """Unit vectors along the axis of the plot, whichever side the body lies on, (points, 2)."""
        return tangents(self.rows, self.axis, self.circle)

    @property
    def traction(self) -> Array:
        """Friction traction along the tangents."""
        return self._along("traction_x", "traction_y")

    @property
    def slip(self) -> Array:
        """Slip since the start along the tangents (length)."""
        return self._along("slip_x", "slip_y")

    def _along(self, *names: str) -> Array:
        found: Array = np.sum(self.rows.vectors(*names) * self.tangents, axis=1)
        return found

    def curve(self, values: Array, shown: Flags | None = None) -> tuple[Array, Array]:
        """Positions and values for a curve that is interrupted where the surface is.

        Args:
            values: At its points, (points,).
            shown: Which of these; by default all.
        """
        kept = np.flatnonzero(np.ones(len(values), dtype=bool) if shown is None else shown)
        breaks = np.flatnonzero(np.diff(self.pieces[kept])) + 1
        return (
            np.insert(self.position[kept], breaks, np.nan),
            np.insert(np.asarray(values, dtype=float)[kept], breaks, np.nan),
        )

    def runs(self) -> Iterator[tuple[float, float, str]]:
        """Where points of one status follow each other: begin, end, about halfway, and status."""
        status, position, pieces = self.rows.status, self.position, self.pieces
        parted = pieces[1:] != pieces[:-1]
        changes = np.flatnonzero((status[1:] != status[:-1]) | parted)
        middle = (position[1:] + position[:-1]) / 2
        ends = np.where(parted, position[:-1], middle)[changes]
        starts = np.where(parted, position[1:], middle)[changes]
        first = np.concatenate([[0], changes + 1]).astype(int)
        bounds = np.append(position[:1], starts), np.append(ends, position[-1:])
        for start, end, number in zip(*bounds, first, strict=True):
            yield float(start), float(end), str(status[number])


def positions(rows: ContactTable) -> tuple[int, Cylinder | None, Array]:
    """The axis along which a line extends most, its circle if it is unrolled, and its positions."""
    points, chart = rows.vectors("x", "y", "z"), chart_of(rows)
    axis = int(np.argmax(np.ptp(points[:, :2], axis=0)))
    across = rows.numbers[("nx", "ny")[1 - axis]]
    turns = across.min() < -_TURNS_BACK and across.max() > _TURNS_BACK
    circle = chart if turns and isinstance(chart, Cylinder) else None
    return axis, circle, points[:, axis] if circle is None else circle.flat(points)[:, 0]


def tangents(rows: ContactTable, axis: int, circle: Cylinder | None) -> Array:
    """Unit vectors in the sense in which the positions of a line grow, (points, 2).

    Args:
        rows: Points of the contact.
        axis: As of ``positions``.
        circle: Likewise.
    """
    found = np.stack([rows.numbers["ny"], -rows.numbers["nx"]], axis=1)
    along = found[:, axis]
    if circle is not None:
        turned = np.column_stack([found, np.zeros(len(found))])
        along = circle.vectors(rows.vectors("x", "y", "z"), turned)[:, 0]
    return np.asarray(found * np.where(along < 0, -1.0, 1.0)[:, None])


def _pieces(body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord) -> Integers:
    """Number of the connected part of the line that each point is of, (points,)."""
    surface = contact_pieces(body, rows, contact)
    if len(surface.pieces) == 0:
        return np.zeros(len(rows.status), dtype=np.int64)
    tree = cKDTree(surface.rows.vectors("x", "y", "z"))
    return np.asarray(surface.connected[tree.query(rows.vectors("x", "y", "z"))[1]])


PRESSURE, FRICTION, GAP, SLIP = "contact pressure", "friction traction", "gap", "slip"
BOUND = r"friction bound, $\pm\mu p$"


@dataclass(frozen=True)
class LineValues:
    """A panel's values along a contact line.

    Attributes:
        name: What they are.
        label: Of the panel's axis.
        values: At the points of the line, (points,); not a number where there is none.
        bounds: Further curves that the values keep between, likewise.
        is_peaked: Whether single points may have far more than others, which is then cut off.
    """

    name: str
    label: str
    values: Array
    bounds: list[Array] = field(default_factory=list)
    is_peaked: bool = False


def line_values(
    line: SurfaceLine, contact: ContactRecord, kept: Collection[str] = ()
) -> list[LineValues]:
    """The curves worth drawing: what is found, and what is not zero all along.

    Args:
        line: The contact line.
        contact: Its entry in ``result.json``.
        kept: Names of those that are worth it in another load step.
    """
    found, frictional = not contact.pressure_is_given, contact.carries_shear
    gap = line.rows.numbers["gap"]
    is_apart = (np.isfinite(gap) & ~line.rows.closed).any()
    own = {array.words: array for array in contact.own_arrays if array.words in kept}
    own |= shown_arrays(line.rows, contact)
    return [
        *([pressure_along(line)] if found or not frictional else []),
        *([friction_along(line, contact)] if frictional else []),
        *([gap_along(line)] if found and (is_apart or GAP in kept) else []),
        *(LineValues(name, label(array), sizes(line.rows, array)) for name, array in own.items()),
    ]


def pressure_along(line: SurfaceLine) -> LineValues:
    """The contact pressure."""
    pressure = line.rows.numbers["contact_pressure"]
    return LineValues(
        PRESSURE, labelled("contact pressure, $p$", "stress"), pressure, is_peaked=True
    )


def friction_along(line: SurfaceLine, contact: ContactRecord) -> LineValues:
    """The friction traction with its bound ±g, on the side (or sides) where it lies.

    Args:
        line: The contact line.
        contact: Its entry in ``result.json``.
    """
    traction, numbers = line.traction, line.rows.numbers
    bounds, bound = [], numbers.get("friction_bound")
    if bound is None and contact.coulomb_coefficient:
        bound = contact.coulomb_coefficient * numbers["contact_pressure"]
    if bound is not None:
        sides = [side for side in (1, -1) if (side * traction > 0.02 * bound.max()).any()]
        bounds = [side * bound for side in sides]
    words = labelled(r"friction traction, $\sigma_T$", "stress")
    return LineValues(FRICTION, words, traction, bounds, is_peaked=True)


def gap_along(line: SurfaceLine) -> LineValues:
    """Gap along a contact line, NaN where nothing is opposite (length)."""
    gap = line.rows.numbers["gap"]
    return LineValues(GAP, labelled("gap", "length"), np.where(np.isfinite(gap), gap, np.nan))


def slip_along(line: SurfaceLine) -> LineValues:
    """The slip since the start along the surface; none where nothing faces a point."""
    slip = np.where(np.isfinite(line.rows.numbers["gap"]), line.slip, np.nan)
    return LineValues(SLIP, labelled("slip, $s$", "length"), slip)
