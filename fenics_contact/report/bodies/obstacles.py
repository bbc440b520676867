"""Where the obstacles of a run stand in its end, from the gaps of its contact points."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.report.drawing.facets import contact_pieces
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_FACING = 0.5  # surfaces that curve more have a mean normal shorter than this


@dataclass(frozen=True)
class ObstacleSurface:
    """A rigid obstacle's surface opposite a contact surface.

    It lies at X + k (u_n + gap) n for points X of the undeformed surface with normals n: gaps are
    magnified as the displacements are, or the body would enter the obstacle, or seem apart.

    Attributes:
        points: Undeformed points of the body's surface, (points, 3) (length).
        offsets: u_n + gap along the normals, (points,) (length).
        normals: Of the body, outward, (points, 3).
        nodes: Numbers of the body's nodes there, (points,).
        pieces: Points of the segments or triangles that it is made of, (pieces, 2 or 3).
    """

    points: Array
    offsets: Array
    normals: Array
    nodes: Integers
    pieces: Integers

    def then(self, body: UnstructuredGrid) -> ObstacleSurface | None:
        """Where it stood at another time, from the points that touched it; None without any.

        Obstacles move without turning, so that all their offsets change by the same.

        Args:
            body: The grid with its fields at that time.
        """
        closed = np.asarray(body["status"])[self.nodes] > 0
        if not closed.any():
            return None
        moved = np.asarray(body["displacement"])[self.nodes][closed]
        normal = self.normals.mean(axis=0)
        share = self.normals[closed] @ normal / (normal @ normal)
        apart = np.einsum("ij,ij->i", moved, self.normals[closed]) - self.offsets[closed]
        shift = float(np.median(apart / np.where(np.abs(share) > 0.1, share, 1.0)))
        offsets = self.offsets + shift * (self.normals @ normal) / (normal @ normal)
        return replace(self, offsets=offsets)

    def at(self, factor: float) -> Array:
        """Its points with displacements magnified, (points, 3) (length)."""
        return self.points + factor * self.offsets[:, None] * self.normals


def obstacles_of(
    body: UnstructuredGrid, contacts: list[tuple[ContactTable, ContactRecord]]
) -> list[ObstacleSurface]:
    """The obstacles of a run in its end.

    Args:
        body: A pyvista grid with its fields.
        contacts: Points and entries in ``result.json`` of its contacts.
    """
    found = (obstacle_surface(body, rows, contact) for rows, contact in contacts)
    return [obstacle for obstacle in found if obstacle is not None]


def obstacle_surface(
    body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord
) -> ObstacleSurface | None:
    """The obstacle of a contact; None for springs, given pressures and bodies opposite.

    Args:
        body: A pyvista grid with the fields ``displacement`` and ``status``.
        rows: Points of the contact.
        contact: Its entry in ``result.json``.
    """
    if not contact.is_rigid or contact.master is not None:
        return None
    surface = contact_pieces(body, rows, contact)
    surface = surface.only(np.isfinite(surface.rows.numbers["gap"]))
    found, nodes = surface.rows, surface.nodes
    normals = found.vectors("nx", "ny", "nz")
    if len(nodes) < 2 or np.linalg.norm(normals.mean(axis=0)) < _FACING:
        return None
    moved = np.einsum("ij,ij->i", np.asarray(body["displacement"])[nodes], normals)
    points, offsets = found.vectors("x", "y", "z"), moved + found.numbers["gap"]
    return ObstacleSurface(points, offsets, normals, nodes, surface.pieces)
