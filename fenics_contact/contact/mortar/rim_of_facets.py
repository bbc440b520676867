"""The rim of a surface of facets, and where places are on that of another one."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, reference_nodes

# Of a parameter along an edge: a place is that of a node.
_AT_NODE = 1e-7
# Corners at the ends of the edges of a facet.
_EDGES = {
    "interval": ((0,), (1,)),
    "triangle": ((0, 1), (0, 2), (1, 2)),
    "quadrilateral": ((0, 1), (0, 2), (1, 3), (2, 3)),
}


def rim_edges(mesh: FacetMesh) -> Integers:
    """Displacement nodes along the edges of single facets, (edges, nodes of an edge).

    From one end to the other; in 2D each is one node.
    """
    corners, places = reference_nodes(mesh.shape, 1), reference_nodes(mesh.shape, mesh.degree)
    found = []
    for edge in _EDGES[mesh.shape]:
        ends = corners[[edge[0], edge[-1]]]
        way = np.linalg.norm(places - ends[0], axis=1)
        detour = way + np.linalg.norm(places - ends[1], axis=1) - np.linalg.norm(ends[1] - ends[0])
        along = np.flatnonzero(detour < 1e-9)
        found.append(mesh.nodes[:, along[np.argsort(way[along])]])
    every = np.concatenate(found).astype(np.int64)
    keys = np.sort(every, axis=1)
    _, first, counts = np.unique(keys, axis=0, return_index=True, return_counts=True)
    found_once: Integers = every[first[counts == 1]]
    return found_once


def places_on_rim(points: Array, edges: Integers, nodes: Array) -> tuple[Array, Array]:
    """Shares of the nodes of a rim in the nearest place of it to each point.

    Args:
        points: Anywhere, (points, dimension) (length).
        edges: Of the rim, as ``rim_edges`` gives them.
        nodes: Places of all nodes, (nodes, dimension) (length).

    Returns:
        Shares, (points, nodes), and how far it is, (points,) (length).
    """
    begin, end = nodes[edges[:, 0]], nodes[edges[:, -1]]
    way = end - begin
    square = np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
    along = np.einsum("ped,ed->pe", points[:, None] - begin, way) / square
    along = np.clip(along, 0.0, 1.0)
    near = begin + along[:, :, None] * way
    nearest = np.linalg.norm(points[:, None] - near, axis=2).argmin(axis=1)
    rows = np.arange(len(points))
    values = _along_edge(along[rows, nearest], edges.shape[1])
    shares = np.zeros((len(points), len(nodes)))
    np.add.at(shares, (rows[:, None], edges[nearest]), values)
    return shares, np.linalg.norm(points - shares @ nodes, axis=1)


def _along_edge(at: Array, count: int) -> Array:
    """Shape functions along an edge, (points, nodes of an edge)."""
    if count == 1:
        return np.ones((len(at), 1))
    places = np.linspace(0, 1, count)
    apart = np.abs(at[:, None] - places)
    at = np.where(apart.min(axis=1) < _AT_NODE, places[apart.argmin(axis=1)], at)
    found = np.ones((len(at), count))
    for number, place in enumerate(places):
        for other in places[places != place]:
            found[:, number] *= (at - other) / (place - other)
    return found
