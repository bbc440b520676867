"""The connected parts of a body: two cells are of one part if a chain of shared nodes joins them.

Every rank joins what it holds of the mesh; what hangs together across ranks is found from the
vertices that ranks share, so that any partition gives the same parts.
"""

from __future__ import annotations

import numpy as np
from dolfinx import fem, la
from dolfinx.mesh import Mesh
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.parallel import gather_rows, of_every_rank, total
from fenics_contact.mesh.tagged_mesh import Body


class Parts:
    """The connected parts of a body, in the order in which its mesh was given.

    Attributes:
        names: Of the parts: of a group of cells that is just that part, such as a mesh of
            its own, else ``part 1``, ``part 2``, …
        of_node: Part of each node of this rank, owned then ghost, shape (nodes,).
        arms: Nodes seen from the centre of their part, (nodes, 3) (length).
        sizes: Largest component of ``arms`` in each part, > 0 (length).

    Args:
        body: The mesh and its groups; collective.
        space: Of the displacements.
    """

    def __init__(self, body: Body, space: fem.FunctionSpace) -> None:
        self._comm = body.mesh.comm
        self._owned = space.dofmap.index_map.size_local
        of_cell, count = _parts_of_cells(body.mesh)
        self.names = _names(body, of_cell, count)
        coordinates = space.tabulate_dof_coordinates()
        self.of_node = np.zeros(len(coordinates), dtype=np.int64)
        self.of_node[space.dofmap.list] = of_cell[:, None]
        nodes = self.sums(np.ones(self._owned))
        centres = self.sums(coordinates[: self._owned]) / nodes[:, None]
        self.arms = coordinates - centres[self.of_node]
        self.sizes = self._largest(np.abs(self.arms[: self._owned]).max(axis=1, initial=0.0))

    @property
    def count(self) -> int:
        """Number of parts."""
        return len(self.names)

    def sums(self, values: Array, nodes: AnyIntegers | None = None) -> Array:
        """Sum of values at nodes, first axis nodes, over each part; collective.

        Args:
            values: At the nodes.
            nodes: Which of those that this rank owns; by default all.
        """
        if self.count == 1:
            return np.asarray(total(self._comm, values.sum(axis=0)[None]))
        of_node = self.of_node[: self._owned] if nodes is None else self.of_node[nodes]
        found = np.zeros((self.count, *values.shape[1:]))
        np.add.at(found, of_node, values)
        return np.asarray(total(self._comm, found))

    def _largest(self, values: Array) -> Array:
        """Largest of values ≥ 0 at owned nodes in each part, 1 where it is 0; collective."""
        found = np.zeros(self.count)
        np.maximum.at(found, self.of_node[: self._owned], values)
        of_all = np.max(of_every_rank(self._comm, found), axis=0)
        return np.where(of_all > 0, of_all, 1.0)


def _parts_of_cells(mesh: Mesh) -> tuple[Integers, int]:
    """Part of each cell of this rank (owned and ghost), and the number of parts; collective."""
    of_vertex, of_cell = _local_pieces(mesh)
    least = _least_inputs(mesh, of_cell)
    counts = of_every_rank(mesh.comm, len(least))
    first = int(np.sum(counts[: mesh.comm.rank]))
    index_map = mesh.topology.index_map(0)
    owners = la.vector(index_map, dtype=np.int64)
    owners.array[:] = first + of_vertex
    owners.scatter_forward()
    ghosts = slice(index_map.size_local, None)
    pairs = np.column_stack([first + of_vertex[ghosts], owners.array[ghosts]])
    joints = gather_rows(mesh.comm, np.unique(pairs, axis=0))
    pieces = int(np.sum(counts))
    graph = coo_matrix((np.ones(len(joints)), joints.T), shape=(pieces, pieces))
    count, of_piece = connected_components(graph, directed=False)
    earliest = np.full(count, np.iinfo(np.int64).max)
    np.minimum.at(earliest, of_piece, gather_rows(mesh.comm, least))
    in_order = np.argsort(np.argsort(earliest))
    return in_order[of_piece[first + of_cell]], count


def _local_pieces(mesh: Mesh) -> tuple[Integers, Integers]:
    """Number of the connected piece of each vertex and each cell that this rank holds."""
    links = mesh.topology.connectivity(mesh.topology.dim, 0)
    index_map = mesh.topology.index_map(0)
    vertices = index_map.size_local + index_map.num_ghosts
    offsets = np.concatenate([np.zeros(vertices, dtype=np.int64), links.offsets])
    size = len(offsets) - 1
    graph = csr_matrix(
        (np.ones(len(links.array), dtype=np.int8), links.array, offsets), (size,) * 2
    )
    _, pieces = connected_components(graph, directed=False)
    return pieces[:vertices].astype(np.int64), pieces[vertices:].astype(np.int64)


def _least_inputs(mesh: Mesh, of_cell: Integers) -> Integers:
    """Least number that a node of each piece of this rank had where the mesh was given."""
    least = np.full(int(of_cell.max(initial=-1)) + 1, np.iinfo(np.int64).max)
    inputs = compat.input_nodes(mesh)
    np.minimum.at(least, of_cell, inputs.min(axis=1, initial=np.iinfo(np.int64).max))
    return least


def _names(body: Body, of_cell: Integers, count: int) -> tuple[str, ...]:
    """The first group of cells that is just a part names it; collective."""
    owned = body.mesh.topology.index_map(body.dimension).size_local
    sizes = total(body.mesh.comm, np.bincount(of_cell[:owned], minlength=count))
    names = [""] * count
    for name, group in body.groups.items():
        if group.dimension == body.dimension:
            cells = body.entities(group)
            inside = np.bincount(of_cell[cells[cells < owned]], minlength=count)
            inside = total(body.mesh.comm, inside)
            reached = np.flatnonzero(inside)
            if len(reached) == 1 and inside[reached[0]] == sizes[reached[0]]:
                names[reached[0]] = names[reached[0]] or name
    return tuple(name or f"part {number + 1}" for number, name in enumerate(names))
