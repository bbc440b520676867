"""Displacements along the contact lines of a flat model (the paper's Fig. 12)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fenics_contact.contact_table import ContactTable
from fenics_contact.figures import new_figure, save, surface_of
from fenics_contact.picture_style import COLOURS
from fenics_contact.surface_line import SurfaceLine

Array = NDArray[np.float64]

_NEAR = 0.4  # contact zones whose neighbourhood is smaller than this share are looked at alone
_WIDTH, _HEIGHT = 7.2, 2.3  # of a panel


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
    def of(cls, body: Any, rows: ContactTable, contact: dict[str, Any]) -> SurfaceDisplacement:
        """Take the displacement at the body's nodes.

        Args:
            body: A pyvista grid with the fields ``displacement`` and ``status``.
            rows: Points of the contact.
            contact: Its entry in ``result.json``.
        """
        on_contact = np.asarray(body["status"]) >= 0  # not the surface of a body opposite
        nodes = np.asarray(body.points)[on_contact, :2]
        tree = cKDTree(nodes)
        distance, _ = tree.query(rows.vectors("x", "y"))
        drawn = distance < 1e-6 * np.ptp(nodes)
        if "master" in contact:  # beyond what faces it normals are others
            drawn &= np.isfinite(rows.numbers["gap"])
        line = SurfaceLine.of(rows.rows(drawn), contact)
        _, found = tree.query(line.rows.vectors("x", "y"))
        return cls(line, np.asarray(body["displacement"])[on_contact][found, :2])

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
    def shown(self) -> NDArray[np.bool_]:
        """The points near the contact zone if it is small, else all."""
        low, high = self.line.view
        position = self.line.position
        if high - low > _NEAR * np.ptp(position):
            return np.ones(len(position), dtype=bool)
        near: NDArray[np.bool_] = (position >= low) & (position <= high)
        return near


def draw_surface_displacement(
    body: Any,
    table: ContactTable,
    contacts: list[dict[str, Any]],
    axes: str,
    path: Path,
) -> Path:
    """Draw u_n, u_T and the deformed line, a column a contact.

    Args:
        body: A pyvista grid with the fields ``displacement`` and ``status``.
        table: The content of ``contact.csv``.
        contacts: The contacts' entries in ``result.json``.
        axes: Letters of the model's axes.
        path: PNG file to write.
    """
    names = " and ".join(surface_of(contact) for contact in contacts)
    figure, panels = new_figure(
        f"Displacement of {names}",
        (_WIDTH * len(contacts), 3 * _HEIGHT),
        nrows=3,
        ncols=len(contacts),
    )
    for number, contact in enumerate(contacts):
        found = SurfaceDisplacement.of(body, table.of(contact["name"]), contact)
        _components(panels[number :: len(contacts)], found, axes)
        _deformed(panels[2 * len(contacts) + number], found, axes)
    save(figure, path)
    return path


def _components(panels: list[Any], found: SurfaceDisplacement, axes: str) -> None:
    values = {"normal, $u_n$": found.normal, "tangential, $u_T$": found.tangential}
    position = found.line.position[found.shown]
    for panel, (name, component) in zip(panels, values.items(), strict=False):
        panel.plot(position, component[found.shown], color=COLOURS["STICK"])
        panel.axhline(0, color="black", linewidth=0.6)
        panel.set_ylabel(name)
        panel.set_xlabel(f"position along the surface, ${axes[found.line.axis]}$")


def _deformed(panel: Any, found: SurfaceDisplacement, axes: str) -> None:
    """Where the line was, and where its points moved to."""
    line, other = found.line, 1 - found.line.axis
    before = line.rows.vectors("x", "y")[found.shown]
    after = before + found.vectors[found.shown]
    panel.plot(
        before[:, line.axis], before[:, other], "--", color="0.5", linewidth=1, label="undeformed"
    )
    panel.plot(
        after[:, line.axis], after[:, other], color=COLOURS["STICK"], linewidth=1, label="deformed"
    )
    for mark in line.marks:
        mine = np.isin(line.rows.status[found.shown], mark.status)
        panel.plot(
            after[mine, line.axis],
            after[mine, other],
            mark.shape,
            color=mark.colour,
            markerfacecolor=mark.colour if mark.filled else "white",
            markersize=3.5,
            label=mark.label if mine.any() else None,
        )
    panel.set_xlabel(f"${axes[line.axis]}$")
    panel.set_ylabel(f"${axes[other]}$")
    panel.legend(frameon=False, fontsize=9)
