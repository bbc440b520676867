"""Elements of one order: with nodes in the middle of edges, faces and cells, or without.

A serendipity cell, such as a hexahedron of 20 nodes, is a special complete one of order 2: with the
nodes that are missing where its own functions put them, both have exactly the same geometry. So is
a cell of order 1.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.mesh.readers.element_kinds import (
    CORNERS,
    EDGES,
    FACES,
    NOT_GIVEN,
    dimension_of,
    order_of,
    shape_of,
)
from fenics_contact.mesh.subdivision.elements import Elements, Middles, Nodes, joined

#: Gmsh's types of each shape by order; those of order 2 are complete.
KIND_OF = {
    "Line": {1: 1, 2: 8},
    "Triangle": {1: 2, 2: 9},
    "Quadrilateral": {1: 3, 2: 10},
    "Tetrahedron": {1: 4, 2: 11},
    "Hexahedron": {1: 5, 2: 12},
    "Prism": {1: 6, 2: 13},
    "Pyramid": {1: 7, 2: 14},
}


def of_order(
    elements: Mapping[int, Elements], order: int, nodes: Nodes, middles: Middles
) -> dict[int, Elements]:
    """All elements in one order, complete, by Gmsh's type.

    Args:
        elements: By Gmsh's type.
        order: 1 or 2.
        nodes: Of the mesh, to which those that are missing are added.
        middles: Takes the nodes in the middle of edges and faces.
    """
    if order == 2:
        for kind in sorted(elements, key=dimension_of, reverse=True):  # cells before their sides
            _gather(kind, elements[kind].nodes, middles)
    found: dict[int, list[Elements]] = {}
    for kind, several in elements.items():
        shape = shape_of(kind)
        rows = several.nodes[:, : CORNERS[shape]]
        if order == 2:
            rows = _with_edges(kind, several.nodes, middles)
            rows = _with_faces(shape, rows, nodes, middles)
            if shape == "Hexahedron":
                rows = np.column_stack([rows, _centres(several.nodes, rows, nodes)])
        found.setdefault(KIND_OF[shape][order], []).append(several.with_nodes(rows))
    return {kind: joined(several) for kind, several in found.items()}


def _gather(kind: int, nodes: Integers, middles: Middles) -> None:
    """Take the nodes on edges and in faces that elements of a type have."""
    shape = shape_of(kind)
    if order_of(kind) == 1:
        return
    ends, first = np.array(EDGES[shape]), CORNERS[shape]
    middles.add(nodes[:, ends].reshape(-1, 2), nodes[:, first : first + len(ends)].ravel())
    for number, face in enumerate(FACES.get(shape, ()), first + len(ends)):
        if number < nodes.shape[1]:
            middles.add(nodes[:, face], nodes[:, number])


def _with_edges(kind: int, nodes: Integers, middles: Middles) -> Integers:
    """Corners, and the nodes on edges: the element's own, where it has them."""
    shape = shape_of(kind)
    first, ends = CORNERS[shape], np.array(EDGES[shape])
    found = middles.of(nodes[:, ends].reshape(-1, 2)).reshape(len(nodes), -1)
    if order_of(kind) == 2:
        own = nodes[:, first : first + len(ends)]
        found = np.where(own == NOT_GIVEN, found, own)
    return np.column_stack([nodes[:, :first], found])


def _with_faces(shape: str, rows: Integers, nodes: Nodes, middles: Middles) -> Integers:
    """Corners, nodes on edges, and those in faces of four corners."""
    edges = [frozenset(edge) for edge in EDGES[shape]]
    found = [rows]
    for face in FACES.get(shape, ()):
        ends = zip(face, (*face[1:], face[0]), strict=True)
        around = [*face, *(CORNERS[shape] + edges.index(frozenset(pair)) for pair in ends)]
        found.append(middles.of(rows[:, face], _Serendipity(nodes, rows[:, around]))[:, None])
    return np.concatenate(found, axis=1)


class _Serendipity:
    """Puts nodes in the middle of faces by four corners and four nodes on edges of each.

    Args:
        nodes: Of the mesh.
        faces: Tags of the corners and of the nodes on edges, (faces, 8).
    """

    def __init__(self, nodes: Nodes, faces: Integers) -> None:
        self._nodes, self._faces = nodes, faces

    def __call__(self, chosen: Integers) -> Array:
        at = self._nodes.at(self._faces[chosen])
        return np.asarray(at[:, 4:].sum(axis=1) / 2 - at[:, :4].sum(axis=1) / 4)


def _centres(given: Integers, rows: Integers, nodes: Nodes) -> Integers:
    """Nodes in the middle of hexahedra: the file's, or where serendipity functions put them."""
    is_complete = given.shape[1] == 27
    found = given[:, 26].copy() if is_complete else np.full(len(rows), NOT_GIVEN)
    missing = np.flatnonzero(found == NOT_GIVEN)
    at = nodes.at(rows[missing, :20])
    found[missing] = nodes.added(at[:, 8:].sum(axis=1) / 4 - at[:, :8].sum(axis=1) / 4)
    return found
