"""The points of a contact as rows: one across, and one or two along the surface.

Across, a row tells the gap that is left and takes the compressive force; along, it tells the slip
and takes friction, both as friction feels them: where that is longer along one direction than along
another, a row has M t in place of a unit tangent t. The slip M s and the force M⁻¹ f do the same
work as s and f, and friction is at most g in all directions (``laws/friction/metric``).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, of_every_rank
from fenics_contact.contact.contact_surface import ContactSurface

# Of a unit vector, the part from which an axis is not along it.
_ACROSS = 0.9


class ContactPoints:
    """Rows of the points of one contact that have something opposite, in the order of the ranks.

    Attributes:
        contact: The contact.
        own: Which points of this rank are its own rows, (own,).
        directions: Of each row of these, (own, rows of a point, components).
        size: Number of rows of a point, which is that of components.
        count: Number of points on all ranks.

    Args:
        contact: The contact; making this is collective.
    """

    def __init__(self, contact: ContactSurface) -> None:
        self.contact, trace = contact, contact.trace
        self._comm = contact.spaces.comm
        self.own = self._reached()
        normals = trace.normals[self.own]
        self.size = normals.shape[1]
        self._tangents = tangents_of(normals)
        metric = contact.friction.rule.metric
        everywhere = np.zeros((len(trace.normals), self.size, self.size - 1))
        everywhere[self.own] = self._tangents.swapaxes(1, 2)
        along = metric.at_each(everywhere)[self.own].swapaxes(1, 2)
        self.directions = np.concatenate([-normals[:, None], along], axis=1)
        counts = of_every_rank(self._comm, len(self.own))
        self._first = int(sum(counts[: self._comm.rank]))
        self.count = int(sum(counts))

    def _reached(self) -> Integers:
        """Points of this rank that have something opposite now."""
        return np.flatnonzero(self.contact.trace.owned & self.contact.kinematics.reached)

    @property
    def are_all(self) -> bool:
        """Whether these are still the points of this rank that have something opposite."""
        return np.array_equal(self.own, self._reached())

    @cached_property
    def weights(self) -> Array:
        """Areas of all points, on every rank, (points,); collective."""
        return gather_rows(self._comm, self.contact.trace.weights[self.own])

    def of_all_ranks(self, at_points: Array) -> Array:
        """Values at this rank's points, for the points of all ranks; collective.

        Args:
            at_points: First axis all points of this rank's trace.
        """
        return gather_rows(self._comm, at_points[self.own])

    def jump_rows(self) -> csr_matrix:
        """Rows over the dofs of the whole surface, on every rank; collective.

        Returns:
            Sparse, (points × rows of a point, dofs): gaps and slips of a jump at its dofs.
        """
        trace = self.contact.trace
        points, nodes, shares = trace.point_rows
        place = np.full(len(trace.normals), -1)
        place[self.own] = self._first + np.arange(len(self.own))
        kept = place[points] >= 0
        points, nodes, shares = points[kept], nodes[kept], shares[kept]
        local = place[points] - self._first
        size = self.size
        shape = (len(points), size, size)
        rows = place[points][:, None, None] * size + np.arange(size)[:, None]
        dofs = trace.surface.numbers[nodes][:, None, None] * size + np.arange(size)
        values = shares[:, None, None] * self.directions[local]
        parts = [np.broadcast_to(part, shape).ravel() for part in (rows, dofs, values)]
        rows, dofs, values = (gather_rows(self._comm, part) for part in parts)
        return csr_matrix((values, (rows, dofs)), (self.count * size, len(trace.surface.dofs)))

    def openings(self) -> Array:
        """Gaps and slips of the present jump, of the points of all ranks; collective.

        Returns:
            (points, rows of a point) (length).
        """
        kinematics, own = self.contact.kinematics, self.own
        jump = kinematics.jump_at_points()
        slip = self.contact.friction.effective_slip(kinematics.tangential(jump))[own]
        found = np.einsum("pij,pj->pi", self.directions, slip)
        found[:, 0] = -self.contact.normal.depth(jump)[own]
        return gather_rows(self._comm, found)

    def tractions(self, forces: Array) -> tuple[Array, Array]:
        """Pressures (points,) and tractions along the surface, at all points of this rank.

        Collective.

        Args:
            forces: Of all ranks, on every rank, (points, rows of a point) (force).
        """
        own = forces[self._first : self._first + len(self.own)]
        stresses = own / self.contact.trace.weights[self.own][:, None]
        pressure, traction = np.zeros(len(self._every)), np.zeros(self._every.shape)
        pressure[self.own] = stresses[:, 0]
        traction[self.own] = np.einsum("pi,pij->pj", stresses[:, 1:], self.directions[:, 1:])
        return self._of_owners(pressure), self._of_owners(traction)

    def rows_of(self, pressure: Array, traction: Array) -> Array:
        """Forces of all ranks that pressures and tractions along the surface are; collective.

        Args:
            pressure: At all points of this rank, (points,) (stress).
            traction: Likewise, (points, components) (stress).

        Returns:
            On every rank, (points × rows of a point,) (force).
        """
        own, areas = self.own, self.contact.trace.weights[self.own][:, None]
        inverse = np.linalg.pinv(self.directions[:, 1:])
        along = np.einsum("pj,pji->pi", traction[own], inverse)
        rows = np.concatenate([pressure[own][:, None], along], axis=1) * areas
        return gather_rows(self._comm, rows).ravel()

    def gradient_of_rows(self, of_pressure: Array, of_traction: Array) -> Array:
        """Gradient in forces of all ranks, by that in pressures and tractions; collective.

        Args:
            of_pressure: At all points of this rank, (points,).
            of_traction: Likewise, (points, components).

        Returns:
            On every rank, (points × rows of a point,).
        """
        own, areas = self.own, self.contact.trace.weights[self.own][:, None]
        along = np.einsum("pj,pij->pi", of_traction[own], self.directions[:, 1:])
        rows = np.concatenate([of_pressure[own][:, None], along], axis=1) / areas
        return gather_rows(self._comm, rows).ravel()

    def at_points(self, values: Array) -> Array:
        """Values at all points of this rank, 0 at those that are no rows; collective.

        Args:
            values: Of all ranks, on every rank, (points,) or (points, several).
        """
        found = np.zeros((len(self._every), *values.shape[1:]))
        found[self.own] = values[self._first : self._first + len(self.own)]
        return self._of_owners(found)

    def in_space(self, rows: Array) -> tuple[Array, Array]:
        """Gradients in openings as those across and along, at all points of this rank; collective.

        Args:
            rows: Of all ranks, on every rank, (points, rows of a point).

        Returns:
            In the gap, (points,), and in the slip since its reference, (points, components).
        """
        along = np.zeros(self._every.shape)
        own = rows[self._first : self._first + len(self.own), 1:]
        along[self.own] = np.einsum("pi,pij->pj", own, self.directions[:, 1:])
        return self.at_points(rows[:, 0]), self._of_owners(along)

    def flags(self, chosen: Flags) -> Flags:
        """Flags of points of all ranks, at all points of this rank; collective.

        Args:
            chosen: (points,), on every rank.
        """
        own = np.zeros(len(self._every))
        own[self.own] = chosen[self._first : self._first + len(self.own)]
        return self._of_owners(own) > 0

    @property
    def _every(self) -> Array:
        return self.contact.trace.normals

    def _of_owners(self, values: Array) -> Array:
        """Values at this rank's own points, at ghost nodes, too; collective."""
        trace = self.contact.trace
        count = len(trace.nodes)
        nodal = trace.surface.of_owners(trace.at_all_nodes(values[:count]))
        return np.concatenate([nodal[trace.numbers], values[count:]])


def tangents_of(normals: Array) -> Array:
    """Orthogonal unit vectors along the surface, (points, components − 1, components).

    Args:
        normals: Unit normals, (points, components).

    >>> tangents_of(np.array([[0.0, 1.0]])).tolist()
    [[[1.0, -0.0]]]
    """
    if normals.shape[1] == 2:
        return np.stack([normals[:, 1], -normals[:, 0]], axis=1)[:, None]
    first = np.where(np.abs(normals[:, :1]) < _ACROSS, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = first - np.einsum("ij,ij->i", first, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(normals, first)], axis=1)
