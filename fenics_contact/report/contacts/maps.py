"""Maps of a contact surface in 3D: what sticks and slips, pressure and friction traction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags, Integers, Words
from fenics_contact.report.contacts.own_arrays import label, shown_arrays, sizes
from fenics_contact.report.drawing.charts import Chart, chart_of
from fenics_contact.report.drawing.facets import contact_pieces
from fenics_contact.report.drawing.figures import in_words, new_figure, plain, save, surface_of
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLOUR_MAP, DOUBLE, EDGE, marks, neighbourhood
from fenics_contact.report.drawing.units import labelled
from fenics_contact.results.contact_table import ContactTable
from fenics_contact.results.point_arrays import PointArray
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure
    from pyvista import UnstructuredGrid

_CARRIED = ("contact_pressure", "traction_x", "traction_y", "traction_z")
_MOST_ARROWS = 350
_SLIPS = 10.0  # width of a panel over the longest arrow of slip
_SHORT = 0.03  # of the longest: vectors that are left out
_HEIGHTS = (1.8, 4.5)  # of a panel, in inches

_Draw: TypeAlias = "Callable[[Figure, Axes, Surface, ContactRecord], None]"


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


def draw_maps(
    body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord, path: Path
) -> Picture:
    """Draw what happens on a contact surface.

    Args:
        body: A pyvista grid with its fields.
        rows: Its points.
        contact: The contact's entry in ``result.json``.
        path: PNG file to write.
    """
    surface = Surface.of(body, rows, contact)
    found, frictional = not contact.pressure_is_given, contact.carries_shear
    if found and not any(rows.numbers[name].any() for name in _CARRIED):
        found = frictional = False  # nothing touches
    shows_pressure = found or (contact.pressure_is_given and not frictional)
    own = shown_arrays(surface.rows, contact)
    draw: dict[str, _Draw] = {
        "status": _status,
        **({"contact pressure p": _pressure} if shows_pressure else {}),
        **({"friction traction σ_T": _friction} if frictional else {}),
        **{name: partial(_own, array=array) for name, array in own.items()},
    }
    across, up = surface.size
    width = DOUBLE / len(draw)
    height = float(np.clip((width - 0.5) * up / across + 1.2, *_HEIGHTS))
    title = f"Contact zone {surface_of(contact)}"
    figure, panels = new_figure("", (DOUBLE, height), ncols=len(draw), sharey=True)
    for draw_panel, panel in zip(draw.values(), panels, strict=True):
        draw_panel(figure, panel, surface, contact)
        panel.margins(0.1)
        surface.label(panel, panel is panels[0])
    figure.set_layout_engine("compressed")  # for panels of equal scales
    figure.suptitle(plain(title), x=0.01, ha="left", fontsize=8.5)
    save(figure, path, tight=True)
    said = f"{in_words(list(draw))} on {surface_of(contact)}."
    if frictional:
        where = "with its colours" if own else "on the right"
        said += f" Arrows on the left: slip; {where}: the friction traction."
    caption = f"{said[0].upper()}{said[1:]} {surface.chart.words}"
    return Picture(path, title, caption.strip())


def _status(figure: Figure, panel: Axes, surface: Surface, contact: ContactRecord) -> None:
    """Points by their status, and their slip."""
    draw_status(panel, surface, surface.rows.status, contact)
    panel.legend(loc="lower left", bbox_to_anchor=(-0.05, 1.0), ncols=3, handletextpad=0.1)
    slip = surface.along(surface.rows.vectors("slip_x", "slip_y", "slip_z"))
    slides = surface.arrows[surface.rows.status[surface.arrows] == "SLIP"]
    most = np.linalg.norm(slip[slides], axis=1).max(initial=0.0)
    if contact.carries_shear and most > 0:  # the longest reaches just beyond the panel's margin
        look = {"color": "black", "width": 0.006, "scale": _SLIPS * most, "scale_units": "width"}
        panel.quiver(*surface.points[slides].T, *slip[slides].T, **look)


def draw_status(panel: Axes, surface: Surface, status: Words, contact: ContactRecord) -> None:
    """Points in the colours of their status, on the surface in grey.

    Args:
        panel: Matplotlib's axes.
        surface: The map.
        status: Of each of its points.
        contact: The contact's entry in ``result.json``.
    """
    from matplotlib.collections import PolyCollection

    panel.add_collection(
        PolyCollection(surface.corners, facecolors="0.95", edgecolors="0.8", linewidths=0.3)
    )
    size = float(np.clip(70 / np.sqrt(len(status)), 1.2, 6))
    for mark in marks(contact):
        mine = np.isin(status, mark.status)
        if mine.any():
            is_open = mark.status == ("OPEN",)
            look = mark.look | {
                "markersize": size * (0.7 if is_open else 1.0),
                "markerfacecolor": mark.colour,
                "markeredgecolor": EDGE if is_open else mark.colour,
                "markeredgewidth": 0.3,
            }
            panel.plot(*surface.points[mine].T, **look)


def _pressure(figure: Figure, panel: Axes, surface: Surface, contact: ContactRecord) -> None:
    pressure = surface.rows.numbers["contact_pressure"]
    colours = draw_values(panel, surface, pressure, min(pressure.min(), 0), pressure.max())
    label = labelled("contact pressure, $p$", "stress")
    figure.colorbar(colours, ax=panel, label=label, location="top", aspect=25)


def _friction(figure: Figure, panel: Axes, surface: Surface, contact: ContactRecord) -> None:
    traction = surface.rows.vectors("traction_x", "traction_y", "traction_z")
    size = np.linalg.norm(traction, axis=1)
    colours = draw_values(panel, surface, size, 0, size.max())
    label = labelled(r"friction traction, $|\sigma_T|$", "stress")
    figure.colorbar(colours, ax=panel, label=label, location="top", aspect=25)
    draw_arrows(panel, surface, traction, size.max())


def _own(
    figure: Figure, panel: Axes, surface: Surface, contact: ContactRecord, array: PointArray
) -> None:
    """What a law keeps of its own; of vectors the size, and arrows."""
    size = sizes(surface.rows, array)
    colours = draw_values(panel, surface, size, min(size.min(), 0), size.max())
    figure.colorbar(colours, ax=panel, label=label(array), location="top", aspect=25)
    if array.is_vector:
        draw_arrows(panel, surface, surface.rows.vectors(*array.columns), size.max())


def draw_arrows(panel: Axes, surface: Surface, vectors: Array, most: float) -> None:
    """Vectors at some of the points, white with a dark rim on any colour.

    Args:
        panel: Matplotlib's axes.
        surface: The map.
        vectors: At its points, (points, 3).
        most: Length of the longest, also in other pictures.
    """
    from matplotlib.patheffects import withStroke

    if not most:  # else their scale would be none
        return
    some = surface.arrows
    some = some[np.linalg.norm(vectors[some], axis=1) > _SHORT * most]
    panel.quiver(
        *surface.points[some].T,
        *surface.along(vectors)[some].T,
        color="white",
        width=0.005,
        scale=14 * most,
        path_effects=[withStroke(linewidth=0.8, foreground="0.15")],
    )


def draw_values(
    panel: Axes, surface: Surface, values: Array, low: float, high: float
) -> ScalarMappable:
    """Values as colours on the triangles between the points.

    Args:
        panel: Matplotlib's axes.
        surface: The map.
        values: At its points, (points,).
        low: Value of the first colour.
        high: Value of the last.

    Returns:
        What a colour bar is made for.
    """
    look = {"cmap": COLOUR_MAP, "vmin": low, "vmax": high if high > low else low + 1.0}
    if len(surface.triangles) == 0:
        return panel.scatter(*surface.points.T, c=values, **look)
    from matplotlib.tri import Triangulation

    corners = surface.corners.reshape(-1, 2)
    triangles = Triangulation(*corners.T, np.arange(len(corners)).reshape(-1, 3))
    colours = values[surface.triangles].ravel()
    return panel.tripcolor(triangles, colours, shading="gouraud", rasterized=True, **look)
