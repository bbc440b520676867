"""Values to draw on a contact surface in 3D: the map, and values at its points.

Still pictures, films, the slider of the report and pages of several runs all draw these.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.report.contacts.line import label, shown_arrays, sizes
from fenics_contact.report.drawing.cells import contact_pieces
from fenics_contact.report.drawing.charts import Chart, chart_of
from fenics_contact.report.drawing.style import labelled, neighbourhood
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import UnstructuredGrid

PRESSURE, FRICTION = "contact pressure p", "friction traction σ_T"
_CARRIED = ("contact_pressure", "traction_x", "traction_y", "traction_z")
_MOST_ARROWS = 350
_SHORT = 0.03  # of the longest: vectors that are left out


@dataclass(frozen=True)
class Surface:
    """A contact surface, seen across it or unrolled.

    Attributes:
        rows: Its points, those that are shown.
        chart: From which the coordinates are.
        points: Coordinates on the map, shape (points, 2).
        triangles: Numbers of the points of each triangle of the surface, (triangles, 3).
        corners: Coordinates of these, (triangles, 3, 2).
        shown: Which of all points these are.
    """

    rows: ContactTable
    chart: Chart
    points: Array
    triangles: Integers
    corners: Array
    shown: Flags

    @classmethod
    def of(cls, body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord) -> Surface:
        """The whole surface where its pressure is given, else the zone's neighbourhood.

        Args:
            body: A pyvista grid with its fields.
            rows: Points of the contact.
            contact: Its entry in ``result.json``.
        """
        chart, places = chart_of(rows), rows.vectors("x", "y", "z")
        points, shown = chart.flat(places), np.ones(len(places), dtype=bool)
        if not contact.pressure_is_given:
            low, high = neighbourhood(points, rows.closed)
            shown = ((points >= low) & (points <= high)).all(axis=1)
        surface = contact_pieces(body, rows, contact)
        # the same points among all of them, and among those that are shown
        _, same = cKDTree(places).query(surface.rows.vectors("x", "y", "z"))
        number = np.where(shown, np.cumsum(shown) - 1, -1)
        triangles = number[same[surface.pieces]] if len(same) else surface.pieces
        triangles = triangles[(triangles >= 0).all(axis=1)]
        corners = chart.pieces(places[shown], triangles)
        return cls(rows.rows(shown), chart, points[shown], triangles, corners, shown)

    def label(self, panel: Axes, first: bool = True) -> None:
        """Equal scales, and the names of the axes; upwards only at the first panel."""
        panel.set_aspect("equal")
        self.chart.label(panel, first)

    def along(self, vectors: Array) -> Array:
        """Components of vectors at its points, (points, 3), on the map, (points, 2)."""
        return self.chart.vectors(self.rows.vectors("x", "y", "z"), vectors)

    @property
    def size(self) -> Array:
        """To the right and upwards (length), (2,)."""
        every = np.concatenate([self.points, self.corners.reshape(-1, 2)])
        return np.asarray(np.ptp(every, axis=0))

    @property
    def arrows(self) -> Integers:
        """Points at which vectors are drawn: all, or of many some, evenly spread."""
        count = len(self.points)
        if count <= _MOST_ARROWS:
            return np.arange(count)
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        step = np.sqrt(np.prod(high - low) / _MOST_ARROWS)
        grid = np.stack(
            np.meshgrid(*(np.arange(a, b, step) for a, b in zip(low, high, strict=True)))
        )
        _, found = cKDTree(self.points).query(grid.reshape(2, -1).T)
        return np.unique(found)


@dataclass(frozen=True)
class MapValues:
    """Values shown on a map in colours, and perhaps as arrows.

    Attributes:
        name: What it is, with its symbol.
        label: Of the bar of colours.
        values: At the points of the map, (points,).
        arrows: Vectors of these sizes, (points, 3).
    """

    name: str
    label: str
    values: Array
    arrows: Array | None = None

    @property
    def limits(self) -> tuple[float, float]:
        """Values of the first and the last colour."""
        return float(min(self.values.min(), 0)), float(self.values.max())


def map_values(
    surface: Surface, rows: ContactTable, contact: ContactRecord, kept: Collection[str] = ()
) -> list[MapValues]:
    """Return the values that get a map, besides the status.

    Args:
        surface: The map.
        rows: Its points, as they are in a load step.
        contact: The contact's entry in ``result.json``.
        kept: Names of those that are worth it in another load step.
    """
    found, frictional = not contact.pressure_is_given, contact.carries_shear
    if found and not kept and not any(rows.numbers[name].any() for name in _CARRIED):
        found = frictional = False  # nothing touches
    every = []
    if found or (contact.pressure_is_given and not frictional):
        pressure = rows.numbers["contact_pressure"]
        every.append(MapValues(PRESSURE, labelled("contact pressure, $p$", "stress"), pressure))
    if frictional:
        traction = rows.vectors("traction_x", "traction_y", "traction_z")
        words = labelled(r"friction traction, $|\sigma_T|$", "stress")
        size = np.asarray(np.linalg.norm(traction, axis=1))
        every.append(MapValues(FRICTION, words, size, traction))
    own = {array.words: array for array in contact.own_arrays if array.words in kept}
    for name, array in (own | shown_arrays(rows, contact)).items():
        arrows = rows.vectors(*array.columns) if array.is_vector else None
        every.append(MapValues(name, label(array), sizes(rows, array), arrows))
    return every


def slip_arrows(
    surface: Surface, rows: ContactTable, contact: ContactRecord
) -> tuple[Integers, Array]:
    """Numbers of the points whose slip is drawn, and the arrows on the map, (points, 2) (length).

    Args:
        surface: The map.
        rows: Its points, as they are in a load step.
        contact: The contact's entry in ``result.json``.
    """
    slides = surface.arrows[rows.status[surface.arrows] == "SLIP"]
    slip = surface.along(rows.vectors("slip_x", "slip_y", "slip_z"))
    slides = slides if contact.carries_shear else slides[:0]
    return slides, slip[slides]


def some_arrows(surface: Surface, vectors: Array, most: float) -> tuple[Integers, Array]:
    """Numbers of the points at which vectors are drawn, and the arrows on the map, (points, 2).

    Args:
        surface: The map.
        vectors: At its points, (points, 3).
        most: Length of the longest, also in other pictures.
    """
    some = surface.arrows
    some = some[np.linalg.norm(vectors[some], axis=1) > _SHORT * most]
    return some, surface.along(vectors)[some]
