"""Elements as Gmsh numbers them: its types, the order of their nodes, and the sides of cells.

Quadratic cells without nodes in the middle of faces and cells, made complete. A serendipity cell,
such as a hexahedron of 20 nodes, is a special complete one of order 2: with the nodes that are
missing where its own functions put them, both have exactly the same geometry.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array, Integers

#: Gmsh's types: names as Gmsh calls them, and dimensions.
NAMES = {
    15: "Point",
    1: "Line 2",
    8: "Line 3",
    2: "Triangle 3",
    9: "Triangle 6",
    3: "Quadrilateral 4",
    16: "Quadrilateral 8",
    10: "Quadrilateral 9",
    4: "Tetrahedron 4",
    11: "Tetrahedron 10",
    5: "Hexahedron 8",
    17: "Hexahedron 20",
    12: "Hexahedron 27",
    6: "Prism 6",
    18: "Prism 15",
    7: "Pyramid 5",
    19: "Pyramid 13",
}
_DIMENSIONS = {"Point": 0, "Line": 1, "Triangle": 2, "Quadrilateral": 2, "Polygon": 2}
# Other programs list the nodes on the edges of a cell around its base, around its top, then
# between both. These are the places of Gmsh's nodes among theirs; where none is given, both agree.
_FROM_USUAL = {
    11: (*range(8), 9, 8),
    17: (*range(8), 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14),
}
# VTK's faces of a hexahedron are x = 0, 1, y = 0, 1, z = 0, 1; Gmsh's z = 0, y = 0, x = 0, 1, …
_FROM_USUAL[12] = (*_FROM_USUAL[17], 24, 22, 20, 21, 23, 25, 26)
#: Of each type: Gmsh's type of its sides, and the places of their nodes, in the order in which
#: Abaqus numbers sides.
SIDES = {
    2: (1, ((0, 1), (1, 2), (2, 0))),
    9: (8, ((0, 1, 3), (1, 2, 4), (2, 0, 5))),
    3: (1, ((0, 1), (1, 2), (2, 3), (3, 0))),
    16: (8, ((0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7))),
    4: (2, ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))),
    11: (9, ((0, 1, 2, 4, 5, 6), (0, 3, 1, 7, 9, 4), (1, 3, 2, 9, 8, 5), (2, 3, 0, 8, 7, 6))),
    5: (3, ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))),
    17: (
        16,
        (
            (0, 1, 2, 3, 8, 11, 13, 9),
            (4, 7, 6, 5, 17, 19, 18, 16),
            (0, 4, 5, 1, 10, 16, 12, 8),
            (1, 5, 6, 2, 12, 18, 14, 11),
            (2, 6, 7, 3, 14, 19, 15, 13),
            (3, 7, 4, 0, 15, 17, 10, 9),
        ),
    ),
}
SIDES[10] = (8, SIDES[16][1])
SIDES[12] = (
    10,
    tuple(
        (*side, middle) for side, middle in zip(SIDES[17][1], (20, 25, 21, 23, 24, 22), strict=True)
    ),
)


def dimension_of(kind: int) -> int:
    """Dimension of a type of elements."""
    return dimension_of_name(NAMES[kind])


def dimension_of_name(name: str) -> int:
    """Dimension of a type of elements by Gmsh's name of it, such as ``Triangle 6``."""
    return _DIMENSIONS.get(name.split()[0], 3)


def as_gmsh(kind: int, nodes: Integers) -> Integers:
    """Nodes of elements of a type in Gmsh's order, from that of most programs.

    Args:
        kind: Gmsh's type.
        nodes: Of each element, shape (elements, nodes).
    """
    return nodes[:, np.array(_FROM_USUAL[kind])] if kind in _FROM_USUAL else nodes


# Gmsh's types: incomplete quadrilaterals and hexahedra, and complete ones.
_QUADRILATERALS, _HEXAHEDRA = (16, 10, "Quadrilateral 9"), (17, 12, "Hexahedron 27")
# Faces of a hexahedron in the order of their middle nodes: corners, and nodes on the edges.
_FACES = (
    (0, 1, 2, 3, 8, 11, 13, 9),
    (0, 1, 5, 4, 8, 12, 16, 10),
    (0, 3, 7, 4, 9, 15, 17, 10),
    (1, 2, 6, 5, 11, 14, 18, 12),
    (2, 3, 7, 6, 13, 15, 19, 14),
    (4, 5, 6, 7, 16, 18, 19, 17),
)


def complete(
    read: Mapping[str, Any], description: Mapping[str, Any]
) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
    """Return a mesh with all its quadratic quadrilaterals and hexahedra complete.

    Args:
        read: Arrays of the process that has read the mesh.
        description: Its description; left as it is, with the arrays, where there are both kinds,
            or nodes are missing.
    """
    kinds = {int(kind) for kind in description["types"]}
    todo = [kinds_of for kinds_of in (_QUADRILATERALS, _HEXAHEDRA) if kinds_of[0] in kinds]
    if not todo or any(new in kinds for _, new, _ in todo):
        return read, description
    quadrilaterals = np.asarray(read.get("nodes_16", np.zeros((0, 8))), dtype=np.int64)
    hexahedra = np.asarray(read.get("nodes_17", np.zeros((0, 20))), dtype=np.int64)
    if not np.isin(
        np.concatenate([quadrilaterals.ravel(), hexahedra.ravel()]), read["node_tags"]
    ).all():
        return read, description
    middles = _Middles(read)
    faces = np.concatenate([quadrilaterals, hexahedra[:, np.array(_FACES)].reshape(-1, 8)])
    of_faces = middles.of_faces(faces)
    of_cells = middles.of_cells(hexahedra)
    count = len(quadrilaterals)
    nodes = {
        16: np.column_stack([quadrilaterals, of_faces[:count]]),
        17: np.column_stack([hexahedra, of_faces[count:].reshape(-1, 6), of_cells]),
    }
    found, types = dict(read) | middles.arrays(), dict(description["types"])
    for old, new, name in todo:
        found[f"nodes_{new}"] = nodes[old]
        for of_each in ("parts", "numbers"):
            found[f"{of_each}_{new}"] = found.pop(f"{of_each}_{old}")
        del found[f"nodes_{old}"], types[str(old)]
        types[str(new)] = name
    return found, dict(description) | {"types": types}


class _Middles:
    """Nodes that are added to a mesh.

    Args:
        read: Its arrays.
    """

    def __init__(self, read: Mapping[str, Any]) -> None:
        self._tags = read["node_tags"].astype(np.int64)
        self._points = read["points"]
        self._order = np.argsort(self._tags)

    def arrays(self) -> dict[str, Any]:
        """Numbers and coordinates of all nodes."""
        return {"node_tags": self._tags, "points": self._points}

    def of_faces(self, faces: Integers) -> Integers:
        """A node in the middle of each face, one for all faces of the same corners.

        Args:
            faces: Four corners and four nodes on edges of each.
        """
        _, first, inverse = np.unique(
            np.sort(faces[:, :4], axis=1), axis=0, return_index=True, return_inverse=True
        )
        at = self._at(faces[first])
        return self._added(at[:, 4:].sum(axis=1) / 2 - at[:, :4].sum(axis=1) / 4)[
            inverse.reshape(-1)
        ]

    def of_cells(self, cells: Integers) -> Integers:
        """A node in the middle of each hexahedron.

        Args:
            cells: Eight corners and twelve nodes on edges of each.
        """
        at = self._at(cells)
        return self._added(at[:, 8:].sum(axis=1) / 4 - at[:, :8].sum(axis=1) / 4)

    def _at(self, nodes: Integers) -> Array:
        places = self._order[np.searchsorted(self._tags[self._order], nodes)]
        return np.asarray(self._points[places])

    def _added(self, points: Array) -> Integers:
        start = int(self._tags.max(initial=0)) + 1
        tags = np.arange(start, start + len(points))
        self._tags = np.concatenate([self._tags, tags])
        self._points = np.concatenate([self._points, points])
        self._order = np.argsort(self._tags)
        return tags
