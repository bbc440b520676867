"""The ends of a part of the body along an axis: plane, and at right angles to it."""

from __future__ import annotations

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.mesh.tagged_mesh import Group

# Of the length, that a facet of an end may be off its plane.
_FLAT = 1e-6


class PartEnds:
    """The two ends of a group of cells; collective.

    Between them a part may have any free surface, but it may hang together with the rest of the
    body only at its ends, or along sides that are parallel to the axis.

    Attributes:
        distance: From one to the other (length).

    Args:
        group: Of cells.
        axis: Unit vector, (3,).
        spaces: Those of the body.
        words: What messages call the part.

    Raises:
        InputError: An end is not plane, or not normal to the axis.
    """

    def __init__(self, group: Group, axis: Array, spaces: Spaces, words: str) -> None:
        self._spaces, self._group = spaces, group
        self._along = spaces.body.mesh.geometry.x @ axis
        cells = spaces.body.entities(group)
        nodes = np.unique(compat.geometry_nodes(spaces.body.mesh)[cells])
        low = smallest(spaces.comm, self._along[nodes])
        high = largest(spaces.comm, self._along[nodes])
        self.distance = high - low
        facets, is_inside = self._surface()
        heights = self._heights(facets)
        close = _FLAT * self.distance
        at = [np.abs(heights - end).max(axis=1, initial=0.0) <= close for end in (low, high)]
        oblique = np.ptp(heights, axis=1) > close if len(heights) else np.zeros(0, dtype=bool)
        oblique &= ~self._is_parallel(facets, axis)
        astray = is_inside & ~at[0] & ~at[1] & (oblique | (np.ptp(heights, axis=1) <= close))
        found = [int(total(spaces.comm, int(flags.sum()))) for flags in (*at, astray)]
        if found[0] == 0 or found[1] == 0 or found[2] > 0:
            direction = ", ".join(f"{x:.4g}" for x in axis[: spaces.components])
            raise InputError(
                f"{words}: its ends must be plane and normal to the axis ({direction}), so that "
                "its length and the force at its ends are known"
            )

    def _surface(self) -> tuple[Integers, Flags]:
        """Facets of this rank's own cells of the part with no other cell of it beyond.

        And which of them have another part of the body beyond.
        """
        body = self._spaces.body
        topology, dimension = body.mesh.topology, body.dimension
        owned = topology.index_map(dimension).size_local
        facets_of = topology.connectivity(dimension, dimension - 1).array
        facets_of = facets_of.reshape(topology.connectivity(dimension, dimension - 1).num_nodes, -1)
        cells = body.entities(self._group)
        index_map = topology.index_map(dimension - 1)
        count = index_map.size_local + index_map.num_ghosts
        of_part = np.bincount(facets_of[cells].ravel(), minlength=count)
        of_own = np.bincount(facets_of[cells[cells < owned]].ravel(), minlength=count)
        of_body = np.bincount(facets_of.ravel(), minlength=count)
        facets = np.flatnonzero((of_part == 1) & (of_own == 1))
        return facets, of_body[facets] > 1

    def _nodes(self, facets: Integers) -> Integers:
        """Return the nodes of facets by the mesh's geometry, (facets, nodes)."""
        body = self._spaces.body
        return compat.nodes_of_entities(body.mesh, body.dimension - 1, facets.astype(np.int32))

    def _heights(self, facets: Integers) -> Array:
        """Coordinates of their nodes along the axis, (facets, nodes) (length)."""
        if len(facets) == 0:
            return np.zeros((0, self._spaces.body.dimension))
        return np.asarray(self._along[self._nodes(facets)])

    def _is_parallel(self, facets: Integers, axis: Array) -> Flags:
        """Whether the axis lies in the facets, to round-off and what cells make of curves."""
        if len(facets) == 0:
            return np.zeros(0, dtype=bool)
        places = self._spaces.body.mesh.geometry.x[self._nodes(facets)]
        arms = places[:, 1:] - places[:, :1]
        if self._spaces.body.dimension == 2:
            across = arms[:, 0] - np.outer(arms[:, 0] @ axis, axis)
            return np.asarray(
                np.linalg.norm(across, axis=1) <= _FLAT * np.linalg.norm(arms[:, 0], axis=1)
            )
        normals = np.cross(arms[:, 0], arms[:, 1])
        return np.asarray(np.abs(normals @ axis) <= _FLAT * np.linalg.norm(normals, axis=1))
