"""Triangles and tetrahedra that are a mesh already, cut where that is wanted.

Cells are bisected as A. Plaza and G. F. Carey, Local refinement of simplicial grids based on the
skeleton, Appl. Numer. Math. 32 (2000) 195-218, by dolfinx, on rank 0; then they are dealt out
anew. Corners and groups stay.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gathered_on_root, on_root
from fenics_contact.mesh.tagged_mesh import Body

Tags = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Simplices:
    """A mesh of order 1 as arrays, cells in the order of the ranks that own them.

    Attributes:
        cell: ``triangle`` or ``tetrahedron``.
        points: (points, dimension) (length).
        cells: Corners of each.
        cell_tags: Of each.
        facets: Corners of those that have tags.
        facet_tags: Of these.
    """

    cell: str
    points: Array
    cells: Integers
    cell_tags: Tags
    facets: Integers
    facet_tags: Tags

    def cut(self, marked: Flags) -> Simplices:
        """All edges of the marked cells halved, and of others what that asks for."""
        dimension = self.points.shape[1]
        mesh = compat.create_mesh(MPI.COMM_SELF, self.cell, 1, self.points, self.cells)
        tags = [
            compat.distributed_tags(mesh, dimension, self.cells, self.cell_tags),
            compat.distributed_tags(mesh, dimension - 1, self.facets, self.facet_tags),
        ]
        chosen = np.flatnonzero(marked[mesh.topology.original_cell_index]).astype(np.int32)
        mesh, (of_cells, of_facets) = compat.refined(mesh, chosen, tags)
        return Simplices(
            self.cell,
            mesh.geometry.x[:, :dimension],
            compat.geometry_nodes(mesh).astype(np.int64),
            _all_values(of_cells, len(compat.geometry_nodes(mesh))),
            compat.nodes_of_entities(mesh, dimension - 1, of_facets.indices),
            of_facets.values.astype(np.int32),
        )


def gathered(body: Body) -> Simplices | None:
    """A body of cells of order 1 on rank 0, None on the others; collective."""
    mesh, dimension = body.mesh, body.dimension
    numbers = np.asarray(mesh.geometry.input_global_indices)
    own = mesh.topology.index_map(dimension).size_local
    nodes = compat.geometry_nodes(mesh)[:own]
    facet_tags = body.facet_tags
    mine = facet_tags.indices < mesh.topology.index_map(dimension - 1).size_local
    facets = compat.nodes_of_entities(mesh, dimension - 1, facet_tags.indices[mine])
    rows = gathered_on_root(
        mesh.comm,
        (
            numbers[nodes],
            mesh.geometry.x[nodes][:, :, :dimension],
            _all_values(body.cell_tags, own),
            numbers[facets],
            facet_tags.values[mine],
        ),
    )
    if rows is None:
        return None
    cells, points, cell_tags, facets, tags = (
        np.concatenate(part) for part in zip(*rows, strict=True)
    )
    known, first, inverse = np.unique(cells, return_index=True, return_inverse=True)
    return Simplices(
        mesh.topology.cell_name(),
        points.reshape(-1, dimension)[first],
        inverse.reshape(cells.shape).astype(np.int64),
        cell_tags.astype(np.int32),
        np.searchsorted(known, facets).astype(np.int64),
        tags.astype(np.int32),
    )


def refined(body: Body, marked: Flags | None) -> Body:
    """The body with marked cells cut, dealt out anew; collective.

    Args:
        body: Of triangles or tetrahedra of order 1.
        marked: On rank 0, of the cells of all ranks, one after the other.
    """
    comm, dimension, found = body.mesh.comm, body.dimension, gathered(body)
    made: list[Simplices] = []  # stays on rank 0

    def cut() -> None:
        assert found is not None and marked is not None
        made.append(found.cut(marked))

    on_root(comm, cut)
    if made:
        all_of = made[0]
    else:
        cell = body.mesh.topology.cell_name()
        none = [np.zeros((0, corners), dtype=np.int64) for corners in (dimension + 1, dimension)]
        no_tags = np.zeros(0, dtype=np.int32)
        all_of = Simplices(cell, np.zeros((0, dimension)), none[0], no_tags, none[1], no_tags)
    mesh = compat.create_mesh(comm, all_of.cell, 1, all_of.points, all_of.cells)
    return Body(
        mesh,
        compat.distributed_tags(mesh, dimension, all_of.cells, all_of.cell_tags),
        compat.distributed_tags(mesh, dimension - 1, all_of.facets, all_of.facet_tags),
        body.groups,
        body.source,
        body.numbers,
    )


def _all_values(tags: Any, number: int) -> Tags:
    """The tag of each of the first cells; of those without, one that no group has."""
    values = np.full(number, np.iinfo(np.int32).min, dtype=np.int32)
    mine = tags.indices < number
    values[tags.indices[mine]] = tags.values[mine]
    return values
