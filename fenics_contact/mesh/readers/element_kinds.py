"""Elements as Gmsh numbers them: its types, the order of their nodes, and the sides of cells.

Shapes of all types that are read: corners, edges, faces and sides, and the order of their nodes.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Integers

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
    13: "Prism 18",
    14: "Pyramid 14",
}
#: In place of a node in the middle of an edge that a file does not give.
NOT_GIVEN = -1
_DIMENSIONS = {"Point": 0, "Line": 1, "Triangle": 2, "Quadrilateral": 2, "Polygon": 2}
# Other programs list the nodes on the edges of a cell around its base, around its top, then
# between both. These are the places of Gmsh's nodes among theirs; where none is given, both agree.
_FROM_USUAL = {
    11: (*range(8), 9, 8),
    17: (*range(8), 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14),
    18: (*range(6), 6, 8, 12, 7, 13, 14, 9, 11, 10),
    19: (*range(5), 5, 8, 9, 6, 10, 7, 11, 12),
}
# VTK's faces of a hexahedron are x = 0, 1, y = 0, 1, z = 0, 1; Gmsh's z = 0, y = 0, x = 0, 1, …
_FROM_USUAL[12] = (*_FROM_USUAL[17], 24, 22, 20, 21, 23, 25, 26)
_FROM_USUAL[13] = (*_FROM_USUAL[18], 15, 17, 16)
#: Corners of each edge, in the order of Gmsh's nodes on them, which follow those at corners.
EDGES = {
    "Line": ((0, 1),),
    "Triangle": ((0, 1), (1, 2), (2, 0)),
    "Quadrilateral": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "Tetrahedron": ((0, 1), (1, 2), (2, 0), (0, 3), (2, 3), (1, 3)),
    "Hexahedron": (
        *((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3)),
        *((2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)),
    ),
    "Prism": ((0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)),
    "Pyramid": ((0, 1), (0, 3), (0, 4), (1, 2), (1, 4), (2, 3), (2, 4), (3, 4)),
}
#: Corners of each face of four corners, in the order of Gmsh's nodes in their middles.
FACES = {
    "Quadrilateral": ((0, 1, 2, 3),),
    "Hexahedron": (
        *((0, 1, 2, 3), (0, 1, 5, 4), (0, 3, 7, 4)),
        *((1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7)),
    ),
    "Prism": ((0, 1, 4, 3), (0, 2, 5, 3), (1, 2, 5, 4)),
    "Pyramid": ((0, 1, 2, 3),),
}
#: Corners of each side in the order in which Abaqus numbers sides; in space they turn about normals
#: that point into the cell.
SIDE_CORNERS: Mapping[str, tuple[tuple[int, ...], ...]] = {
    "Triangle": EDGES["Triangle"],
    "Quadrilateral": EDGES["Quadrilateral"],
    "Tetrahedron": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "Hexahedron": (
        *((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1)),
        *((1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
    ),
    "Prism": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
    "Pyramid": ((0, 1, 2, 3), (0, 4, 1), (1, 4, 2), (2, 4, 3), (3, 4, 0)),
}
#: Corners of each shape.
CORNERS = {
    name: 1 + max(corner for edge in edges for corner in edge) for name, edges in EDGES.items()
}
_SIDE_KINDS = {  # Gmsh's types by their nodes at corners, and on the whole
    **{(2, 2): 1, (2, 3): 8, (3, 3): 2, (3, 6): 9},
    **{(4, 4): 3, (4, 8): 16, (4, 9): 10},
}


def shape_of(kind: int) -> str:
    """The shape of a type of elements, such as ``Triangle``."""
    return NAMES[kind].split()[0]


def order_of(kind: int) -> int:
    """The order of a type of elements that have edges, 1 or 2."""
    return 1 if int(NAMES[kind].split()[1]) == CORNERS[shape_of(kind)] else 2


def _sides_of(kind: int) -> tuple[tuple[int, tuple[int, ...]], ...]:
    """Gmsh's type of each side of a type of cells, and the places of its nodes."""
    shape, count = shape_of(kind), int(NAMES[kind].split()[1])
    corners, edges = CORNERS[shape], [frozenset(edge) for edge in EDGES[shape]]
    faces = [frozenset(face) for face in FACES.get(shape, ())]
    found = []
    for side in SIDE_CORNERS[shape]:
        places = list(side)
        if count > corners:
            ends = zip(side, (*side[1:], side[0]), strict=True)
            ways = [frozenset(pair) for pair in ends][: 1 if len(side) == 2 else None]
            places += [corners + edges.index(way) for way in ways]
            first = corners + len(edges)
            if len(side) == 4 and count > first:
                places.append(first + faces.index(frozenset(side)))
        found.append((_SIDE_KINDS[len(side), len(places)], tuple(places)))
    return tuple(found)


#: Of each type of cells: Gmsh's type of each side and the places of its nodes, in Abaqus's order.
SIDES = {kind: _sides_of(kind) for kind in NAMES if shape_of(kind) in SIDE_CORNERS}


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


def corner_keys(corners: Integers) -> NDArray[np.uint64]:
    """One number for each side or edge, whatever the order of its corners: the sum of their hashes.

    Args:
        corners: Tags of nodes, (sides, corners).
    """
    hashes = corners.astype(np.uint64)
    for factor in (0xBF58476D1CE4E5B9, 0x94D049BB133111EB):  # of splitmix64
        hashes = (hashes ^ (hashes >> np.uint64(30))) * np.uint64(factor)
    return np.asarray((hashes ^ (hashes >> np.uint64(31))).sum(axis=1, dtype=np.uint64))
