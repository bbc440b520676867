"""Displacements along the contact lines of a flat model (the paper's Fig. 12)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.report.contacts.curves import draw_strip
from fenics_contact.report.contacts.line import SurfaceLine
from fenics_contact.report.drawing.facets import nodes_at
from fenics_contact.report.drawing.figures import in_words, new_figure, save, set_title, surface_of
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLOURS, COLUMN, WIDE
from fenics_contact.report.drawing.units import labelled
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import UnstructuredGrid

_NEAR = 0.4  # contact zones whose neighbourhood is smaller than this share are looked at alone
_HEIGHT, _STRIP, _MARGIN = 1.5, 0.16, 0.45


@dataclass(frozen=True)
class SurfaceDisplacement:
    """Displacement of the points of a contact line.

    Attributes:
        line: Its points that are nodes of the body.
        vectors: Their displacements (length), (points, 2).
    """

    line: SurfaceLine
    vectors: Array

    @classmethod
    def of(
        cls, body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord
    ) -> SurfaceDisplacement:
        """Take the displacement at the body's nodes.

        Args:
            body: A pyvista grid with the fields ``displacement`` and ``status``.
            rows: Points of the contact.
            contact: Its entry in ``result.json``.
        """
        line = SurfaceLine.of(body, nodes_at(body, rows, contact)[0], contact)
        _, nodes = nodes_at(body, line.rows, contact)
        return cls(line, np.asarray(body["displacement"])[nodes, :2])

    @property
    def normal(self) -> Array:
        """u_n, along the outward normal (length)."""
        normal: Array = np.sum(self.vectors * self.line.rows.vectors("nx", "ny"), axis=1)
        return normal

    @property
    def tangential(self) -> Array:
        """u_T, positive along the axis of the plot (length)."""
        tangential: Array = np.sum(self.vectors * self.line.tangents, axis=1)
        return tangential

    @property
    def shown(self) -> Flags:
        """The points near the contact zone if it is small, else all."""
        low, high = self.line.view
        position = self.line.position
        if high - low > _NEAR * np.ptp(position):
            return np.ones(len(position), dtype=bool)
        near: Flags = (position >= low) & (position <= high)
        return near


def draw_surface_displacement(
    body: UnstructuredGrid,
    table: ContactTable,
    contacts: list[ContactRecord],
    axes: str,
    path: Path,
) -> Picture:
    """Draw u_n and u_T over a strip of the status, a column a contact.

    Args:
        body: A pyvista grid with the fields ``displacement`` and ``status``.
        table: The content of ``contact.csv``.
        contacts: The contacts' entries in ``result.json``.
        axes: Letters of the model's axes.
        path: PNG file to write.
    """
    count = len(contacts)
    names = in_words([surface_of(contact) for contact in contacts])
    heights = (_HEIGHT, _HEIGHT, _STRIP)
    title = f"Displacement of {names}"
    figure, panels = new_figure(
        "",
        (WIDE if count == 1 else COLUMN * count, sum(heights) + _MARGIN),
        nrows=3,
        ncols=count,
        height_ratios=heights,
        sharex="col",
    )
    for number, contact in enumerate(contacts):
        found = SurfaceDisplacement.of(body, table.of(contact.name), contact)
        column = panels[number::count]
        _components(column, found)
        draw_strip(column[-1], found.line, contact)
        position = found.line.position[found.shown]
        margin = 0.03 * np.ptp(position)
        column[-1].set_xlim(position.min() - margin, position.max() + margin)
        found.line.label(column[-1], axes)
        set_title(column[0], title if count == 1 else surface_of(contact))
    for panel, label in zip(panels[::count], ("normal, $u_n$", "tangential, $u_T$"), strict=False):
        panel.set_ylabel(labelled(label, "length"))
    figure.align_ylabels(panels[:-1:count])
    save(figure, path)
    return Picture(
        path,
        title,
        "Displacement of the surface along its outward normal, u_n, and along it, u_T, against the "
        "position in the undeformed body. The strip below shows the status.",
    )


def _components(panels: list[Axes], found: SurfaceDisplacement) -> None:
    for panel, component in zip(panels, (found.normal, found.tangential), strict=False):
        panel.plot(*found.line.curve(component, found.shown), color=COLOURS["STICK"])
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
