"""Meshes that are there already: brought to one rank, their cells cut, and dealt out again.

Meshes that are there already, with cells cut where that is wanted; corners and groups stay.
Triangles and tetrahedra are bisected as A. Plaza and G. F. Carey, Local refinement of simplicial
grids based on the skeleton, Appl. Numer. Math. 32 (2000) 195-218, by dolfinx. Quadrilaterals and
hexahedra can only be halved along all their edges, all of them at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gathered_on_root, on_root
from fenics_contact.mesh.tagged_mesh import Body

Tags = NDArray[np.int32]

CORNERS = {"triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8}
_FACET_CORNERS = {"triangle": 2, "quadrilateral": 2, "tetrahedron": 3, "hexahedron": 4}


@dataclass(frozen=True, eq=False)
class GatheredMesh:
    """A mesh of order 1 as arrays, cells in the order of the ranks that own them.

    Attributes:
        cell: Kind of the cells.
        points: (points, dimension) (length).
        cells: Corners of each, in dolfinx's order.
        cell_tags: Of each.
        facets: Corners of those that have tags, in dolfinx's order.
        facet_tags: Of these.
    """

    cell: str
    points: Array
    cells: Integers
    cell_tags: Tags
    facets: Integers
    facet_tags: Tags


def is_of_order_1(mesh: Any) -> bool:
    """Whether cells have no nodes but their corners."""
    return bool(compat.geometry_nodes(mesh).shape[1] == CORNERS[mesh.topology.cell_name()])


def changed(body: Body, change: Callable[[GatheredMesh], GatheredMesh]) -> Body:
    """A body with another mesh, dealt out anew; collective.

    Args:
        body: Of cells of order 1.
        change: Of its mesh, on rank 0.
    """
    comm, dimension, found = body.mesh.comm, body.dimension, _gathered(body)
    made: list[GatheredMesh] = []  # stays on rank 0

    def make() -> None:
        assert found is not None
        made.append(change(found))

    on_root(comm, make)
    every = made[0] if made else _empty(body)
    mesh = compat.create_mesh(comm, every.cell, 1, every.points, every.cells)
    return Body(
        mesh,
        compat.distributed_tags(mesh, dimension, every.cells, every.cell_tags),
        compat.distributed_tags(mesh, dimension - 1, every.facets, every.facet_tags),
        body.groups,
        body.source,
        body.numbers,
    )


def all_values(tags: Any, number: int) -> Tags:
    """The tag of each of the first cells; of those without, one that no group has."""
    values = np.full(number, np.iinfo(np.int32).min, dtype=np.int32)
    mine = tags.indices < number
    values[tags.indices[mine]] = tags.values[mine]
    return values


def _gathered(body: Body) -> GatheredMesh | None:
    """A body on rank 0, None on the others; collective."""
    mesh, dimension = body.mesh, body.dimension
    cell = mesh.topology.cell_name()
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
            all_values(body.cell_tags, own),
            numbers[facets].reshape(-1, _FACET_CORNERS[cell]),
            facet_tags.values[mine],
        ),
    )
    if rows is None:
        return None
    cells, points, cell_tags, facets, tags = (
        np.concatenate(part) for part in zip(*rows, strict=True)
    )
    known, first, inverse = np.unique(cells, return_index=True, return_inverse=True)
    return GatheredMesh(
        cell,
        points.reshape(-1, dimension)[first],
        inverse.reshape(cells.shape).astype(np.int64),
        cell_tags.astype(np.int32),
        np.searchsorted(known, facets).astype(np.int64),
        tags.astype(np.int32),
    )


def _empty(body: Body) -> GatheredMesh:
    """Return the empty mesh of ranks other than 0."""
    cell, no_tags = body.mesh.topology.cell_name(), np.zeros(0, dtype=np.int32)
    corners = (CORNERS[cell], _FACET_CORNERS[cell])
    cells, facets = (np.zeros((0, count), dtype=np.int64) for count in corners)
    return GatheredMesh(cell, np.zeros((0, body.dimension)), cells, no_tags, facets, no_tags)


def refined(body: Body, marked: Flags | None) -> Body:
    """The body with marked cells cut, dealt out anew; collective.

    Args:
        body: Of triangles or tetrahedra of order 1.
        marked: On rank 0, of the cells of all ranks, one after the other.
    """

    def cut(mesh: GatheredMesh) -> GatheredMesh:
        assert marked is not None
        return _cut(mesh, marked)

    return changed(body, cut)


def halved(body: Body) -> Body:
    """The body with all edges of its cells halved, dealt out anew; collective.

    Args:
        body: Of cells of order 1.
    """
    if compat.is_tensor_cell(body.mesh):
        return changed(body, _halved_boxes)
    return changed(body, lambda mesh: _cut(mesh, np.ones(len(mesh.cells), dtype=bool)))


def _cut(mesh: GatheredMesh, marked: Flags) -> GatheredMesh:
    """All edges of the marked simplices halved, and of others what that asks for."""
    dimension = mesh.points.shape[1]
    whole = compat.create_mesh(MPI.COMM_SELF, mesh.cell, 1, mesh.points, mesh.cells)
    tags = [
        compat.distributed_tags(whole, dimension, mesh.cells, mesh.cell_tags),
        compat.distributed_tags(whole, dimension - 1, mesh.facets, mesh.facet_tags),
    ]
    chosen = np.flatnonzero(marked[whole.topology.original_cell_index]).astype(np.int32)
    finer, (of_cells, of_facets) = compat.refined(whole, chosen, tags)
    return GatheredMesh(
        mesh.cell,
        finer.geometry.x[:, :dimension],
        compat.geometry_nodes(finer).astype(np.int64),
        all_values(of_cells, len(compat.geometry_nodes(finer))),
        compat.nodes_of_entities(finer, dimension - 1, of_facets.indices),
        of_facets.values.astype(np.int32),
    )


def _halved_boxes(mesh: GatheredMesh) -> GatheredMesh:
    """Each quadrilateral as four, each hexahedron as eight, facets as they lie on them.

    A new point is known by the corners that it is the mean of: one, those of an edge, of a face or
    of a cell.
    """
    dimension = mesh.points.shape[1]
    of_cells, of_facets = _means(mesh.cells, dimension), _means(mesh.facets, dimension - 1)
    corners = 2**dimension
    filled = np.full((*of_facets.shape[:2], corners), -1, dtype=np.int64)
    filled[:, :, -of_facets.shape[2] :] = of_facets
    every = np.concatenate([part.reshape(-1, corners) for part in (of_cells, filled)])
    known, numbers = np.unique(every, axis=0, return_inverse=True)
    numbers = numbers.reshape(-1).astype(np.int64)
    count = len(of_cells) * 3**dimension
    there = known >= 0
    places = np.where(there[:, :, None], mesh.points[known], 0.0)
    return GatheredMesh(
        mesh.cell,
        places.sum(axis=1) / there.sum(axis=1)[:, None],
        _pieces(numbers[:count].reshape(len(mesh.cells), -1), dimension),
        np.repeat(mesh.cell_tags, 2**dimension),
        _pieces(numbers[count:].reshape(len(mesh.facets), -1), dimension - 1),
        np.repeat(mesh.facet_tags, 2 ** (dimension - 1)),
    )


def _means(boxes: Integers, dimension: int) -> Integers:
    """Corners that each of the 3^d points of a halved box is the mean of, sorted behind -1's.

    Args:
        boxes: Corners of each as dolfinx has them, along the first axis first, (boxes, 2^d).
        dimension: d.

    Returns:
        (boxes, 3^d, 2^d), the points in the order of ``product`` over the axes.
    """
    found = np.full((len(boxes), 3**dimension, 2**dimension), -1, dtype=np.int64)
    for point, place in enumerate(product(range(3), repeat=dimension)):
        ends = [(0,) if at == 0 else (1,) if at == 2 else (0, 1) for at in place]
        corners = [sum(end << axis for axis, end in enumerate(one)) for one in product(*ends)]
        found[:, point, : len(corners)] = boxes[:, corners]
    return np.sort(found, axis=2)


def _pieces(points: Integers, dimension: int) -> Integers:
    """Corners of the 2^d pieces of each halved box, as dolfinx has them, (2^d boxes, 2^d)."""
    number = np.arange(3**dimension).reshape((3,) * dimension)
    pieces = []
    for begin in product(range(2), repeat=dimension):
        ends = product(range(2), repeat=dimension)
        pieces.append([number[tuple(np.add(begin, end[::-1]))] for end in ends])
    return points[:, np.array(pieces)].reshape(-1, 2**dimension)
