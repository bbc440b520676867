"""Elements as Gmsh numbers them: its types, the order of their nodes, and the sides of cells."""

from __future__ import annotations

import numpy as np

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
