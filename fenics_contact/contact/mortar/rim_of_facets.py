"""The rim of a surface of facets, and where places are on that of another one."""

from __future__ import annotations

from dataclasses import dataclass

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
# Of curved edges: samples, from the nearest of which Gauss and Newton's steps begin.
_SAMPLES, _STEPS = 9, 20


@dataclass(frozen=True, eq=False)
class Rim:
    """The edges of single facets, each from one end to the other; in 2D each is one node.

    Attributes:
        nodes: Numbers of the displacement nodes, (edges, nodes of an edge).
        geometry: Places of the geometry nodes, (edges, geometry nodes of an edge, dimension)
            (length).
    """

    nodes: Integers
    geometry: Array


def rim_of(mesh: FacetMesh) -> Rim:
    """The rim of a surface."""
    nodes, geometry = [], []
    for edge in _EDGES[mesh.shape]:
        nodes.append(mesh.nodes[:, _along(mesh.shape, edge, mesh.degree)])
        geometry.append(mesh.geometry[:, _along(mesh.shape, edge, mesh.order)])
    every = np.concatenate(nodes).astype(np.int64)
    _, first, counts = np.unique(
        np.sort(every, axis=1), axis=0, return_index=True, return_counts=True
    )
    found_once = first[counts == 1]
    return Rim(every[found_once], np.concatenate(geometry)[found_once])


def _along(shape: str, edge: tuple[int, ...], degree: int) -> Integers:
    """Nodes of a facet along one of its edges, from end to end."""
    corners, places = reference_nodes(shape, 1), reference_nodes(shape, degree)
    ends = corners[[edge[0], edge[-1]]]
    way = np.linalg.norm(places - ends[0], axis=1)
    detour = way + np.linalg.norm(places - ends[1], axis=1) - np.linalg.norm(ends[1] - ends[0])
    along = np.flatnonzero(detour < 1e-9)
    return np.asarray(along[np.argsort(way[along])])


def places_on_rim(points: Array, rim: Rim, node_count: int) -> tuple[Array, Array]:
    """Shares of the nodes of a surface in the place of its rim that is nearest to each point.

    Nodes between the ends of an edge need not divide it evenly, nor be on a straight line.

    Args:
        points: Anywhere, (points, dimension) (length).
        rim: Of the surface.
        node_count: Of its displacement nodes.

    Returns:
        Shares, (points, nodes), and the places, (points, dimension) (length).
    """
    at = _nearest_parameters(points, rim.geometry)
    near = _on_edges(at, rim.geometry)
    rows = np.arange(len(points))
    nearest = np.linalg.norm(points[:, None] - near, axis=2).argmin(axis=1)
    values = _along_edge(at[rows, nearest], rim.nodes.shape[1])
    shares = np.zeros((len(points), node_count))
    np.add.at(shares, (rows[:, None], rim.nodes[nearest]), values)
    return shares, near[rows, nearest]


def _nearest_parameters(points: Array, geometry: Array) -> Array:
    """Where each edge is nearest to each point, from 0 to 1, (points, edges)."""
    begin, way = geometry[:, 0], geometry[:, -1] - geometry[:, 0]
    square = np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
    at = np.einsum("ped,ed->pe", points[:, None] - begin, way) / square
    if geometry.shape[1] <= 2:
        return np.asarray(np.clip(at, 0.0, 1.0))
    samples = np.linspace(0, 1, _SAMPLES)
    sampled = np.einsum("sg,egd->esd", _along_edge(samples, geometry.shape[1]), geometry)
    apart = np.linalg.norm(points[:, None, None] - sampled, axis=3)
    at = np.asarray(samples[apart.argmin(axis=2)])
    bend = 2 * (geometry[:, 0] - 2 * geometry[:, 1] + geometry[:, 2])
    slope = -3 * geometry[:, 0] + 4 * geometry[:, 1] - geometry[:, 2]
    for _ in range(_STEPS):
        tangent = slope + 2 * at[:, :, None] * bend
        left = points[:, None] - _on_edges(at, geometry)
        square = np.maximum((tangent**2).sum(axis=2), np.finfo(float).tiny)
        at = np.clip(at + (tangent * left).sum(axis=2) / square, 0.0, 1.0)
    return np.asarray(at)


def _on_edges(at: Array, geometry: Array) -> Array:
    """Places on edges, (points, edges, dimension) (length).

    Args:
        at: Where, from 0 to 1, (points, edges).
        geometry: As of ``Rim``.
    """
    values = _along_edge(at.ravel(), geometry.shape[1]).reshape(*at.shape, -1)
    return np.asarray(np.einsum("peg,egd->ped", values, geometry))


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
