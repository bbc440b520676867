"""Meshes that are there already, with cells cut where that is wanted; corners and groups stay.

Triangles and tetrahedra are bisected as A. Plaza and G. F. Carey, Local refinement of simplicial
grids based on the skeleton, Appl. Numer. Math. 32 (2000) 195-218, by dolfinx. Quadrilaterals and
hexahedra can only be halved along all their edges, all of them at once.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from mpi4py import MPI

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.mesh.gathered_mesh import GatheredMesh, all_values, changed
from fenics_contact.mesh.tagged_mesh import Body


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
