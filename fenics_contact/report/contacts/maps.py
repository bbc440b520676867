"""Maps of a contact surface in 3D: what sticks and slips, pressure and friction traction."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fenics_contact.common.arrays import Array, Words
from fenics_contact.report.contacts.map_values import (
    FRICTION,
    MapValues,
    Surface,
    map_values,
    slip_arrows,
    some_arrows,
)
from fenics_contact.report.drawing.figures import in_words, new_figure, plain, save, surface_of
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import (
    COLOUR_MAP,
    DOUBLE,
    EDGE,
    Mark,
    ends_of_colours,
    marks,
)
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure
    from pyvista import UnstructuredGrid

# Width of a panel over the longest arrow: of slip, and of other vectors.
SLIPS, LENGTHS = 10.0, 14.0
STATUS_LEGEND: dict[str, Any] = {
    **{"loc": "lower left", "bbox_to_anchor": (-0.05, 1.0), "ncols": 3, "handletextpad": 0.1}
}
_HEIGHTS = (1.8, 4.5)  # of a panel, in inches


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
    every = map_values(surface, surface.rows, contact)
    figure, panels = map_figure(surface, every)
    _draw_slip(panels[0], surface, contact)
    for panel, found in zip(panels[1:], every, strict=True):
        draw_map(figure, panel, surface, found)
    finish_maps(figure, panels, surface, contact)
    save(figure, path, tight=True)
    names = [found.name for found in every]
    said = f"{in_words(['status', *names])} on {surface_of(contact)}."
    if FRICTION in names:
        where = "on the right" if names[-1] == FRICTION else "with its colours"
        said += f" Arrows on the left: slip; {where}: the friction traction."
    caption = f"{said[0].upper()}{said[1:]} {surface.chart.words}"
    return Picture(path, _title(contact), caption.strip())


def map_figure(surface: Surface, every: Sequence[MapValues]) -> tuple[Figure, list[Axes]]:
    """A panel for the status, and one for each of what else is shown."""
    across, up = surface.size
    width = DOUBLE / (1 + len(every))
    height = float(np.clip((width - 0.5) * up / across + 1.2, *_HEIGHTS))
    return new_figure("", (DOUBLE, height), ncols=1 + len(every), sharey=True)


def finish_maps(
    figure: Figure, panels: Sequence[Axes], surface: Surface, contact: ContactRecord
) -> None:
    """Scales, names of the axes and a title.

    Args:
        figure: Matplotlib's.
        panels: All of its maps.
        surface: What they are of.
        contact: The contact's entry in ``result.json``.
    """
    for panel in panels:
        panel.margins(0.1)
        surface.label(panel, panel is panels[0])
    figure.set_layout_engine("compressed")  # for panels of equal scales
    figure.suptitle(plain(_title(contact)), x=0.01, ha="left", fontsize=8.5)


def _title(contact: ContactRecord) -> str:
    return f"Contact zone {surface_of(contact)}"


def _draw_slip(panel: Axes, surface: Surface, contact: ContactRecord) -> None:
    """Points by their status, and their slip."""
    draw_status(panel, surface, surface.rows.status, contact)
    panel.legend(**STATUS_LEGEND)
    slides, slip = slip_arrows(surface, surface.rows, contact)
    most = np.linalg.norm(slip, axis=1).max(initial=0.0)
    if most > 0:  # the longest reaches just beyond the panel's margin
        look = {"color": "black", "width": 0.006, "scale": SLIPS * most, "scale_units": "width"}
        panel.quiver(*surface.points[slides].T, *slip.T, **look)


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
    for mark in marks(contact):
        mine = np.isin(status, mark.status)
        if mine.any():
            panel.plot(*surface.points[mine].T, **status_look(mark, len(status)))


def status_look(mark: Mark, points: int) -> dict[str, Any]:
    """How points of a kind look on a map, for matplotlib's ``plot``.

    Args:
        mark: The kind.
        points: How many there are of all kinds.
    """
    is_open = mark.status == ("OPEN",)
    return mark.look | {
        "markersize": float(np.clip(70 / np.sqrt(points), 1.2, 6)) * (0.7 if is_open else 1.0),
        "markerfacecolor": mark.colour,
        "markeredgecolor": EDGE if is_open else mark.colour,
        "markeredgewidth": 0.3,
    }


def draw_map(
    figure: Figure,
    panel: Axes,
    surface: Surface,
    found: MapValues,
    limits: tuple[float, float] | None = None,
) -> list[Artist]:
    """Values as colours with their bar above, and arrows.

    Args:
        figure: Matplotlib's.
        panel: Of it.
        surface: The map.
        found: What is shown.
        limits: Values of the first and the last colour; by default 0 or the least, and the most.

    Returns:
        What was drawn in the panel.
    """
    low, high = limits or found.limits
    colours = draw_values(panel, surface, found.values, low, high)
    figure.colorbar(colours, ax=panel, label=found.label, location="top", aspect=25)
    drawn: list[Artist] = [colours]
    if found.arrows is not None:
        drawn += draw_arrows(panel, surface, found.arrows, high)
    return drawn


def draw_arrows(panel: Axes, surface: Surface, vectors: Array, most: float) -> list[Artist]:
    """Vectors at some of the points, white with a dark rim on any colour.

    Args:
        panel: Matplotlib's axes.
        surface: The map.
        vectors: At its points, (points, 3).
        most: Length of the longest, also in other pictures.

    Returns:
        The arrows; none where all are 0.
    """
    from matplotlib.patheffects import withStroke

    if not most:  # else their scale would be none
        return []
    some, arrows = some_arrows(surface, vectors, most)
    look = {"color": "white", "width": 0.005, "scale": LENGTHS * most}
    rim = [withStroke(linewidth=0.8, foreground="0.15")]
    return [panel.quiver(*surface.points[some].T, *arrows.T, path_effects=rim, **look)]


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
    first, last = ends_of_colours(low, high)
    look = {"cmap": COLOUR_MAP, "vmin": first, "vmax": last}
    if len(surface.triangles) == 0:
        return panel.scatter(*surface.points.T, c=values, **look)
    from matplotlib.tri import Triangulation

    corners = surface.corners.reshape(-1, 2)
    triangles = Triangulation(*corners.T, np.arange(len(corners)).reshape(-1, 3))
    colours = values[surface.triangles].ravel()
    return panel.tripcolor(triangles, colours, shading="gouraud", rasterized=True, **look)
