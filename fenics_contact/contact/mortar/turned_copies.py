"""Copies of a master surface in other sectors of a ring, which a slave of this sector may face.

A surface goes on beyond the cut of a sector, turned, and so does what stands opposite: a slave may
face the master of the next sector. The copies are searched together with the surface itself. A
node of the copy k sectors ahead moves by R^k u of the sector's own node, R the turn by 2π/sectors,
and gets forces by the transpose.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix, identity, kron, vstack
from scipy.spatial import cKDTree

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.contact.mortar.facet_mesh import FacetMesh


class TurnedCopies:
    """A surface in several sectors, whose nodes are numbered sector by sector.

    Attributes:
        count: Number of the surface's own nodes.
        turns: R^k of each copy, the first of them 1, (copies, components, components).

    Args:
        surface: All facets of the surface in this sector.
        turns: The attribute.
        centre: A point of the axis, (components,) (length).
    """

    def __init__(self, surface: FacetMesh, turns: Array, centre: Array) -> None:
        self.count, self.turns, self._centre = surface.node_count, turns, centre

    @classmethod
    def facing(cls, points: Array, master: FacetMesh, cut: CutFaces | None) -> TurnedCopies:
        """Copies in the sectors that are nearest to points of the slave, and in their neighbours.

        Args:
            points: On the slave in this sector, (points, components) (length).
            master: All facets of the master in this sector.
            cut: The cut faces; None of a whole body, of which there are no copies.
        """
        size = master.dimension
        if cut is None or len(points) == 0 or len(master.nodes) == 0:
            return cls(master, np.eye(size)[None], np.zeros(size))
        sectors, centre = cut.given.sectors, cut.centre[:size]
        turns = np.array([np.linalg.matrix_power(cut.rotation, k) for k in range(sectors)])
        every = centre + np.einsum("kij,fj->kfi", turns, master.centres - centre)
        _, nearest = cKDTree(every.reshape(-1, size)).query(points)
        found = np.unique(nearest // len(master.nodes))
        beside = (found[:, None] + np.array([-1, 0, 1])) % sectors
        others = np.setdiff1d(beside, [0])
        return cls(master, turns[[0, *others]], centre)

    def seen_from(self, other: FacetMesh) -> TurnedCopies:
        """Copies of the surface that these face, turned the other way.

        Args:
            other: Some facets of it in this sector.
        """
        return TurnedCopies(other, self.turns.transpose(0, 2, 1), self._centre)

    @property
    def dimension(self) -> int:
        """Dimension of space."""
        return int(self.turns.shape[1])

    @property
    def size(self) -> int:
        """Number of copies, the surface itself among them."""
        return len(self.turns)

    def of_surface(self, surface: FacetMesh) -> FacetMesh:
        """A surface together with its copies.

        Args:
            surface: All facets in this sector, as meshed or displaced.
        """
        if self.size == 1:
            return surface
        shape = surface.geometry.shape
        places = self.places(surface.geometry.reshape(-1, self.dimension))
        firsts = self.count * np.arange(self.size)
        return replace(
            surface,
            geometry=places.reshape(-1, *shape[1:]),
            nodes=(firsts[:, None, None] + surface.nodes).reshape(-1, surface.nodes.shape[1]),
            normals=self.vectors(surface.normals),
        )

    def vectors(self, nodal: Array) -> Array:
        """Vectors at the nodes of all copies, (copies × nodes, components).

        Args:
            nodal: At the surface's own nodes, (nodes, components).
        """
        return self.directions(nodal).reshape(-1, self.dimension)

    def directions(self, vectors: Array) -> Array:
        """Vectors of this sector in each copy, (copies, vectors, components)."""
        return np.asarray(np.einsum("kij,nj->kni", self.turns, vectors))

    def places(self, points: Array) -> Array:
        """Places of this sector in each copy, (copies, points, components) (length)."""
        return self._centre + self.directions(points - self._centre)

    def expansion(self) -> csr_matrix:
        """Displacements of all copies over those of the surface, (copies × dofs, dofs)."""
        unit = identity(self.count)
        return csr_matrix(vstack([kron(unit, turn) for turn in self.turns]))

    def summed(self, coupling: csr_matrix) -> csr_matrix:
        """Columns of all copies added up: a coupling of scalars, which no turn changes."""
        columns = vstack([identity(self.count)] * self.size)
        return csr_matrix(coupling @ columns)

    def of_any(self, flags: Flags) -> Flags:
        """Whether any copy of a node has a flag, (nodes,).

        Args:
            flags: Of the nodes of all copies.
        """
        return np.asarray(flags.reshape(self.size, self.count).any(axis=0))

    def own(self, nodes: AnyIntegers) -> AnyIntegers:
        """The surface's own numbers of nodes of copies."""
        return nodes % self.count
