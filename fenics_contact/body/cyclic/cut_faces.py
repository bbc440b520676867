"""The condition between the cut faces of a sector: u(R x) = R u(x), R a turn by 2π/sectors.

The displacement of one face, ``on``, follows from that of the other, so that it has no unknowns of
its own: solvers eliminate it. With u = C u' of all dofs of ``on``, forces on these act on the other
face by Cᵀ. Where the face ends on the axis, u = R u leaves motions along the axis alone.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, kron, vstack

from fenics_contact.body.cyclic.gathered_dofs import GatheredDofs
from fenics_contact.body.cyclic.matching import FaceNodes, Mortar, NodeShares, matched_nodes
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import gather_rows, largest, total
from fenics_contact.scene.loading.cyclic_symmetry import CyclicSymmetry

# Of an entry of a turn: round-off of a sine or cosine that is 0.
_NONE = 1e-14
# Of the largest displacement of supports.
_SAME_VALUE = 1e-9
# Of the extent of the faces: how near the axis a node is on it, and a point that users give.
_ON_AXIS, _GIVEN_ON_AXIS = 1e-9, 1e-6


class CutFaces:
    """The cut faces of a sector, and how the displacement of one follows from that of the other.

    Attributes:
        given: What the scene says.
        axis: Unit vector along the axis, (3,).
        centre: A point of it, (3,) (length).
        rotation: R, which takes ``against`` to ``on``, (components, components).
        slaves: The dofs that follow: those of ``on``.
        masters: Those that they follow from.
        matrix: C, (slaves, masters).

    Args:
        given: What the scene says.
        spaces: Those of the body.
        mortar: Finds how nodes follow where the meshes of the faces do not match; collective.

    Raises:
        InputError: The faces are no turned copies of each other.
    """

    def __init__(self, given: CyclicSymmetry, spaces: Spaces, mortar: Mortar) -> None:
        self.given, self._spaces = given, spaces
        size = spaces.components
        along = np.array((0.0, 0.0, 1.0) if given.axis is None else given.axis, dtype=np.float64)
        self.axis = along / np.linalg.norm(along)
        self.centre = np.zeros(3)
        self.centre[:size] = 0.0 if given.at is None else given.at
        on, against = self._nodes("on", given.on), self._nodes("against", given.against)
        self._extent = max(float(self._distances(face.places).max()) for face in (on, against))
        turn, pairs = matched_nodes(given, self.axis, self.centre, (on, against), mortar)
        self.rotation = np.where(np.abs(turn) < _NONE, 0.0, turn)[:size, :size]
        self._nodes_of_both = np.union1d(on.numbers, against.numbers)
        is_off = self._distances(on.places) > _ON_AXIS * self._extent
        self._off_axis, on_axis = on.numbers[is_off], on.numbers[~is_off]
        self._shares = self._of_both(pairs)
        axial, held = self._along_axis(on_axis)
        turned = csr_matrix(kron(self._shares, self.rotation) @ axial)
        every = (self._nodes_of_both[:, None] * size + np.arange(size)).ravel()
        rows = (self._off_axis[:, None] * size + np.arange(size)).ravel()
        rows, matrix = np.concatenate([rows, every[held]]), vstack([turned, axial[held]], "csr")
        matrix.eliminate_zeros()
        order, columns = np.argsort(rows), np.unique(matrix.indices)
        self.slaves = GatheredDofs(rows[order], spaces)
        self.masters = GatheredDofs(every[columns], spaces)
        self.matrix = csr_matrix(matrix[order][:, columns])

    def _nodes(self, side: str, name: str) -> FaceNodes:
        """The nodes of a face; collective."""
        spaces = self._spaces
        nodes = spaces.nodes(spaces.body.boundary(name, f"cyclic_symmetry.{side}"))
        own = nodes[nodes < spaces.owned_nodes]
        index_map = spaces.displacement_space.dofmap.index_map
        numbers = np.asarray(index_map.local_to_global(own), dtype=np.int64)
        numbers = gather_rows(spaces.comm, numbers)
        known = spaces.coordinates[own], spaces.parts.of_node[own]
        return FaceNodes(numbers, *(gather_rows(spaces.comm, one) for one in known))

    def _distances(self, places: Array) -> Array:
        """From the axis, (places,) (length)."""
        arms = places - self.centre
        return np.asarray(np.linalg.norm(arms - np.outer(arms @ self.axis, self.axis), axis=1))

    def _of_both(self, pairs: NodeShares) -> csr_matrix:
        """Shares of nodes of both faces in those of ``on`` off the axis, (nodes, nodes of both)."""
        order = np.argsort(pairs.on)
        rows = order[np.searchsorted(pairs.on[order], self._off_axis)]
        entries = pairs.shares[rows].tocoo()
        columns = np.searchsorted(self._nodes_of_both, pairs.against[entries.col])
        shape = (len(rows), len(self._nodes_of_both))
        return csr_matrix(coo_matrix((entries.data, (entries.row, columns)), shape=shape))

    def _along_axis(self, nodes: Integers) -> tuple[csr_matrix, Integers]:
        """Displacements of nodes of both faces, of which those on the axis move along it alone.

        Their components follow from the largest one of the axis; in the plane there is none.

        Args:
            nodes: Those on the axis.

        Returns:
            Over all dofs of these nodes, square, and the places of those that follow.
        """
        size, count = self._spaces.components, len(self._nodes_of_both)
        first = int(np.abs(self.axis[:size]).argmax())
        others = np.array([k for k in range(size) if size == 2 or k != first])
        factors = np.zeros(size) if size == 2 else self.axis / self.axis[first]
        places = np.searchsorted(self._nodes_of_both, nodes)[:, None] * size
        held = (places + others).ravel()
        free = np.setdiff1d(np.arange(count * size), held)
        ahead = np.repeat(places + first, len(others))
        values = np.concatenate([np.ones(len(free)), np.tile(factors[others], len(nodes))])
        entries = np.concatenate([free, held]), np.concatenate([free, ahead])
        shape = (count * size, count * size)
        return csr_matrix(coo_matrix((values, entries), shape=shape)), held

    @property
    def tolerance(self) -> float:
        """How near the axis a point that users give is on it (length)."""
        return _GIVEN_ON_AXIS * self._extent

    def on_axis(self, place: Array) -> Array:
        """The point of the axis nearest to a place, (components,) (length)."""
        size = len(place)
        axis, centre = self.axis[:size], self.centre[:size]
        return np.asarray(centre + ((place - centre) @ axis) * axis)

    def reached_by(self, nodes: Integers) -> tuple[bool, bool]:
        """Whether some nodes are in the cut, and whether both faces have them alike; collective.

        Args:
            nodes: Of a set (local indices, owned and ghost).

        Returns:
            Both; the second is that a node which follows is in the set just if all those are that
            it follows from.
        """
        inside = np.zeros((len(self._spaces.coordinates), self._spaces.components))
        inside[nodes] = 1.0
        on, against = (
            dofs.gathered(inside.reshape(-1)) > 0 for dofs in (self.slaves, self.masters)
        )
        shares = abs(self.matrix)
        outside = shares @ (~against).astype(np.float64) > 0
        follows = shares @ np.ones(len(against)) > 0  # nodes on the axis have components that rest
        is_alike = bool((on != outside)[follows].all())
        return bool(on.any() or against.any()), is_alike

    @property
    def scalar_shares(self) -> tuple[Integers, Integers, csr_matrix]:
        """How values without a direction, such as temperatures, follow at nodes of ``on``.

        Returns:
            Numbers of the nodes off the axis that follow, those of the nodes of both faces, and
            shares of these in them, (nodes that follow, nodes of both).
        """
        return self._off_axis, self._nodes_of_both, self._shares

    def shares_among(self, numbers: Integers) -> tuple[Integers, csr_matrix]:
        """Nodes off the axis that follow from others of the same set, and shares of these in them.

        Args:
            numbers: Of the set over all ranks, (nodes,).

        Returns:
            Places in the set of those that follow, and (these, nodes).
        """
        order, among = np.argsort(numbers), np.isin(self._nodes_of_both, numbers)
        outside = self._shares @ (~among).astype(np.float64)
        chosen = np.flatnonzero(np.isin(self._off_axis, numbers) & (np.abs(outside) == 0))
        entries = self._shares[chosen].tocoo()
        of_both = order[np.searchsorted(numbers[order], self._nodes_of_both[entries.col])]
        shape = (len(chosen), len(numbers))
        shares = csr_matrix(coo_matrix((entries.data, (entries.row, of_both)), shape=shape))
        return order[np.searchsorted(numbers[order], self._off_axis[chosen])], shares

    @property
    def is_slave(self) -> Flags:
        """Flags of this rank's displacement dofs that follow, owned and ghost, (dofs,)."""
        found = np.zeros(len(self._spaces.coordinates) * self._spaces.components, dtype=bool)
        found[self.slaves.local] = True
        return found

    @cached_property
    def nodes(self) -> Flags:
        """Flags of this rank's nodes with a dof that follows, or that others follow, (nodes,)."""
        found = self.is_slave
        found[self.masters.local] = True
        return np.asarray(found.reshape(-1, self._spaces.components).any(axis=1))

    def followed(self, nodal: Array) -> Array:
        """Displacements with those that follow brought to where they belong; collective.

        Args:
            nodal: (nodes, components) (length).
        """
        found = nodal.reshape(-1).copy()
        self.slaves.place(self.matrix @ self.masters.gathered(found), found)
        return found.reshape(nodal.shape)

    def jumps(self, fields: Array) -> Array:
        """U − C u' at the slaves, (slaves, …), the same on every rank; collective.

        Args:
            fields: At this rank's nodes, (nodes, components, …).
        """
        flat = fields.reshape(-1, *fields.shape[2:])
        return np.asarray(self.slaves.gathered(flat) - self.matrix @ self.masters.gathered(flat))

    def forces(self, needed: Array) -> Array:
        """Forces f across the cut, −Cᵀ f on the other face, (nodes, components); collective.

        Args:
            needed: Forces that the body needs at its nodes beside loads and contacts, likewise
                (force).
        """
        found = np.zeros(needed.size)
        on = self.slaves.gathered(needed.reshape(-1))
        self.masters.place(-(self.matrix.T @ on), found)
        self.slaves.place(on, found)
        return found.reshape(needed.shape)

    def folded(self, nodal: Array) -> Array:
        """Forces with those on what follows taken to what it follows from; collective.

        Args:
            nodal: (nodes, components) (force).
        """
        return nodal - self.forces(nodal)

    def require_held_alike(self, constrained: Integers, prescribed: Array) -> None:
        """Refuse supports that hold points of ``on`` otherwise than those of the other; collective.

        Args:
            constrained: Dofs that supports hold (local indices, owned and ghost).
            prescribed: Their displacements (length).

        Raises:
            InputError: They do; on every rank.
        """
        flat = np.zeros((len(self._spaces.coordinates) * self._spaces.components, 2))
        flat[constrained] = np.column_stack([np.ones(len(constrained)), prescribed])
        held, moved = self.slaves.gathered(flat).T
        ahead, others = self.masters.gathered(flat).T
        loose = (np.abs(self.matrix) @ (1 - ahead)) > 0
        off = np.abs(moved - self.matrix @ others)
        scale = largest(self._spaces.comm, np.abs(prescribed))
        if ((held > 0) & (loose | (off > _SAME_VALUE * scale))).any():
            raise InputError(
                f"cyclic_symmetry: supports hold points of '{self.given.on}' otherwise than those "
                f"of '{self.given.against}', turned; hold all components on both, or give "
                "axes.cylindrical"
            )

    def exchanged(self, nodal: Array) -> Array:
        """What the other face adds to values at nodes of the cut, turned, (nodes, …); collective.

        Args:
            nodal: At this rank's nodes, (nodes, columns): vectors (components), then scalars.
        """
        size, numbers = self._spaces.components, self._nodes_of_both
        index_map = self._spaces.displacement_space.dofmap.index_map
        local = index_map.global_to_local(numbers)
        own = (local >= 0) & (local < self._spaces.owned_nodes)
        values = np.zeros((len(numbers), nodal.shape[1]))
        values[own] = nodal[local[own]]
        values = np.asarray(total(self._spaces.comm, values))
        slaves = np.searchsorted(numbers, self._off_axis)
        on, against = self._shares @ values, self._shares.T @ values[slaves]
        on[:, :size] = on[:, :size] @ self.rotation.T
        against[:, :size] = against[:, :size] @ self.rotation
        against[slaves] += on
        found = np.zeros_like(nodal)
        found[local[local >= 0]] = against[local >= 0]
        return found

    def mismatch(self, displacement: Array) -> float:
        """Largest jump between the faces, over the largest displacement of them; collective.

        Args:
            displacement: At this rank's nodes, (nodes, components) (length).
        """
        size = largest(self._spaces.comm, np.abs(displacement[self.nodes]))
        return float(np.abs(self.jumps(displacement)).max(initial=0.0)) / (size or 1.0)

    @property
    def words(self) -> str:
        """Part of the whole that is modelled, in words."""
        about = "z" if self.given.axis is None else _named(self.axis)
        return f"1 of {self.given.sectors} sectors about {about}"


def _named(axis: Array) -> str:
    """An axis in words."""
    for number, name in enumerate("xyz"):
        if abs(axis[number]) > 1 - _NONE:
            return name
    return f"({', '.join(f'{x:.6g}' for x in axis)})"
