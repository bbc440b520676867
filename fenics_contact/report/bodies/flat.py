"""The picture of a flat model's deformed body, by matplotlib: it needs no display."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.bodies.obstacles import ObstacleSurface
from fenics_contact.report.bodies.view import View
from fenics_contact.report.drawing.facets import nodes_at
from fenics_contact.report.drawing.fields import Triangles, flat_outline, flat_sides
from fenics_contact.report.drawing.style import COLOUR_MAP, EDGE, Mark, marks
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from pyvista import UnstructuredGrid

_THICK = 0.035  # of what is shown: how much of an obstacle is drawn
_FEW, _FEW_CELLS = 60, 1000


def draw_flat(
    panel: Axes,
    body: UnstructuredGrid,
    view: View,
    contacts: list[tuple[ContactTable, ContactRecord]],
    obstacles: list[ObstacleSurface],
    limits: tuple[float, float],
) -> ScalarMappable:
    """Draw a deformed flat body with its stress, where it was, its contact points and obstacles.

    Args:
        panel: Matplotlib's axes.
        body: A pyvista grid with its fields.
        view: What of it is shown.
        contacts: Points and entries in ``result.json`` of its contacts.
        obstacles: Those that are drawn.
        limits: Stresses at the ends of the colours.

    Returns:
        What a colour bar is made for.
    """
    from matplotlib.collections import LineCollection

    cells = Triangles.of(view.body, "displacement", "von Mises stress")
    points = cells.moved(view.factor)
    colours = panel.tripcolor(
        *points[:, :2].T,
        cells.corners,
        cells.fields["von Mises stress"],
        shading="gouraud",
        cmap=COLOUR_MAP,
        vmin=limits[0],
        vmax=limits[1],
        zorder=0.5,
    )
    moved = np.asarray(view.body.points) + view.factor * np.asarray(view.body["displacement"])
    sides = moved[flat_sides(view.body)[0]][:, :, :2]
    width = 0.5 if view.body.n_cells < _FEW_CELLS else 0.25
    panel.add_collection(
        LineCollection(sides, colors="white", linewidths=width, alpha=0.5, zorder=0.6)
    )
    panel.set_rasterization_zorder(1)  # in the PDF: these two as pixels
    before = [line[:, :2] for line in flat_outline(body)]
    panel.add_collection(
        LineCollection(before, colors="0.35", linewidths=0.7, linestyles=(0, (4, 2)), zorder=1.4)
    )
    for obstacle in obstacles:
        _draw_obstacle(panel, obstacle, view)
    _draw_points(panel, body, view, contacts)
    low, high = _frame(view, points)
    panel.set_aspect("equal")
    panel.set_xlim(low[0], high[0])
    panel.set_ylim(low[1], high[1])
    return colours


def _frame(view: View, points: Array) -> tuple[Array, Array]:
    """Return the shown range: the view, for a whole body with its displacements, and a margin."""
    low, high = view.low[:2], view.high[:2]
    if not view.is_near:
        low = np.minimum(low, points[:, :2].min(axis=0))
        high = np.maximum(high, points[:, :2].max(axis=0))
    margin = 1.4 * _THICK * view.size
    return low - margin, high + margin


def _draw_obstacle(panel: Axes, obstacle: ObstacleSurface, view: View) -> None:
    """Hatched, from its surface on."""
    axis = int(np.argmax(np.ptp(obstacle.points[:, :2], axis=0)))
    order = np.argsort(obstacle.points[:, axis])
    near = obstacle.at(view.factor)[order, :2]
    if view.axisymmetric and axis == 0 and len(near) > 1 and near[0, 0] < 2 * np.diff(near[:2, 0]):
        near = np.concatenate([[[0.0, near[0, 1]]], near])  # no contact point lies on the axis
    across = 1 - axis
    up = float(np.sign(obstacle.normals[:, across].mean()))
    behind = near[[-1, 0]]
    behind[:, across] = up * ((up * near[:, across]).max() + _THICK * view.size)
    band = np.concatenate([near, behind])
    panel.fill(*band.T, facecolor="0.9", edgecolor="0.6", hatch="/////", linewidth=0, zorder=1.5)
    panel.plot(*near.T, color="0.25", linewidth=0.9, zorder=1.6)


def _draw_points(
    panel: Axes,
    body: UnstructuredGrid,
    view: View,
    contacts: list[tuple[ContactTable, ContactRecord]],
) -> None:
    """Contact points where they moved to, by their status."""
    said: set[str] = set()
    for rows, contact in contacts:
        found, nodes = nodes_at(body, rows, contact)
        if len(nodes) == 0:
            continue
        moved = (
            np.asarray(body.points)[nodes] + view.factor * np.asarray(body["displacement"])[nodes]
        )
        few = len(nodes) < _FEW
        for mark in marks(contact):
            mine = np.isin(found.status, mark.status)
            if mine.any():
                label = mark.label if mark.label not in said else None
                said.add(mark.label)
                panel.plot(*moved[mine, :2].T, zorder=3, **point_look(mark, few) | {"label": label})


def point_look(mark: Mark, few: bool = True) -> dict[str, Any]:
    """Points on coloured bodies: filled, with an edge that keeps them apart from the colours."""
    edge = EDGE if mark.status == ("OPEN",) else "white"
    return mark.look | {
        "markerfacecolor": mark.colour,
        "markeredgecolor": edge,
        "markeredgewidth": 0.4 if few else 0.15,
        "markersize": 4.2 if few else 3.2,
    }


def add_legend(panel: Axes, title: str, all_marks: tuple[Mark, ...] = ()) -> None:
    """The legend above the panel, and the title above that.

    Args:
        panel: Matplotlib's axes.
        title: In matplotlib's words.
        all_marks: Those of the legend; by default of what is drawn.
    """
    handles = [panel.plot([], [], **point_look(mark))[0] for mark in all_marks]
    handles = handles or panel.get_legend_handles_labels()[0]
    panel.set_title(title, pad=16 if handles else None)
    if handles:
        panel.legend(
            handles=handles, loc="lower left", bbox_to_anchor=(-0.02, 0.995), ncols=3,
            handletextpad=0.1,
        )  # fmt: skip
