"""The part of a contact's tangent between its points, where forces at one follow others' jumps."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.laws.force import ContactForce
from fenics_contact.contact.surface.averaging import SurfaceAverage


class NeighbourStiffness:
    """Entries between dofs of the surface; the same places every time.

    Attributes:
        rows: Dofs of the surface of every entry of this rank; an entry may come several times.
        columns: Likewise.

    Args:
        force: Whose points are coupled.
        neighbours: How.
    """

    def __init__(self, force: ContactForce, neighbours: SurfaceAverage) -> None:
        self._force, trace = force, force.site.trace
        size = trace.surface.components
        self._pairs: Integers = np.flatnonzero(trace.owned[neighbours.rows])
        points = neighbours.rows[self._pairs]
        nodes, shares = neighbours.nodes_of_places
        own, other = neighbours.places[points], neighbours.columns[self._pairs]
        factors = shares[own][:, :, None] * shares[other][:, None, :]
        # A point between nodes moves with all of its facet's; its force is theirs.
        self._pair, first, second = np.nonzero(factors)
        self._factor = factors[self._pair, first, second] * trace.weights[points[self._pair]]
        shape = (len(self._pair), size, size)
        rows = nodes[own[self._pair], first][:, None] * size + np.arange(size)
        columns = nodes[other[self._pair], second][:, None] * size + np.arange(size)
        self.rows: Integers = np.broadcast_to(rows[:, :, None], shape).ravel()
        self.columns: Integers = np.broadcast_to(columns[:, None, :], shape).ravel()

    def values(self) -> Array:
        """Present values of the entries; collective."""
        blocks = self._force.tangent_between_points()[self._pairs]
        return np.asarray((blocks[self._pair] * self._factor[:, None, None]).ravel())
