"""The last mesh of an adaptive run, and what lies on it: the zone of contact."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.report.drawing.fields import flat_sides
from fenics_contact.report.drawing.figures import new_figure, save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import DOUBLE, marks, neighbourhood
from fenics_contact.report.drawing.units import labelled
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


def draw_mesh(body: UnstructuredGrid, result: Outcome, table: ContactTable, path: Path) -> Picture:
    """Draw the mesh of a flat model: all of it, and around the contact with its points.

    Args:
        body: A pyvista grid.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
        path: PNG file to write.
    """
    from matplotlib.collections import LineCollection

    points = np.column_stack([table.numbers["x"], table.numbers["y"]])
    low, high = neighbourhood(points, table.closed)
    model = result.model
    title = f"Mesh {len(result.levels)}: {model['cells']} cells, {model['dofs']} dofs"
    figure, panels = new_figure("", (DOUBLE, 3.6), ncols=2)
    figure.set_layout_engine("compressed")  # for panels of equal scales
    figure.suptitle(title, x=0.01, ha="left", fontsize=8.5)
    lines = np.asarray(body.points)[flat_sides(body)[0]][:, :, :2]
    for panel, width in zip(panels, (0.15, 0.3), strict=True):
        panel.add_collection(
            LineCollection(lines, colors="#566573", linewidths=width, rasterized=True)
        )
        panel.set_aspect("equal")
        panel.autoscale()
    for mark in marks(*result.contacts):
        mine = np.isin(table.status, mark.status)
        look = {"markersize": 3.0, "zorder": 3, "clip_on": False}
        if mine.any():
            panels[1].plot(*points[mine].T, **mark.look | look)
    ends = np.asarray(body.bounds)[:4].reshape(2, 2)
    margin = 0.02 * (high - low)
    panels[1].set_xlim(max(low[0], ends[0, 0]) - margin[0], min(high[0], ends[0, 1]) + margin[0])
    panels[1].set_ylim(max(low[1], ends[1, 0]) - margin[1], min(high[1], ends[1, 1]) + margin[1])
    panels[1].legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3, handletextpad=0.1)
    axes = "rz" if model.kinematics == "axisymmetric" else "xy"
    for panel in panels:
        panel.set_xlabel(labelled(f"${axes[0]}$", "length"))
    panels[0].set_ylabel(labelled(f"${axes[1]}$", "length"))
    save(figure, path, tight=True)
    caption = (
        f"The mesh that the estimated errors led to, the last of {len(result.levels)}: all of "
        "it, and around the contact with its points."
    )
    return Picture(path, title, caption)
