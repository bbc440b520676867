"""Tetrahedra and triangles in place of other cells.

Each side of four corners is cut by the diagonal from its smallest node, so that the two cells that
share it cut it in the same way (J. Dompierre, P. Labbé, M.-G. Vallet, R. Camarero: How to subdivide
pyramids, prisms and hexahedra into tetrahedra. 8th International Meshing Roundtable, 1999). The
cells are those between the smallest node of a cell and the triangles of its sides that do not have
this node: 2 of a pyramid, 3 of a prism, 6 of a hexahedron, or 5 where no diagonal meets the corner
that lies opposite.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.mesh.readers.element_kinds import (
    CORNERS,
    EDGES,
    FACES,
    SIDE_CORNERS,
    corner_keys,
    shape_of,
)
from fenics_contact.mesh.subdivision.elements import Elements, Middles

#: The shape of the simplex of each dimension.
SIMPLEX = {2: "Triangle", 3: "Tetrahedron"}
_UNIT = np.array(  # corners of a hexahedron
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)


_OPPOSITE = (6, 7, 4, 5, 2, 3, 0, 1)  # corners of a hexahedron


def subdivided(
    kind: int, elements: Elements, middles: Middles, edges: NDArray[np.uint64] | None = None
) -> Elements:
    """The simplices that elements are cut into, of the same order.

    Args:
        kind: Gmsh's type of the elements, complete.
        elements: Cells or sides.
        middles: Nodes in the middle of edges and faces; takes those of diagonals.
        edges: Keys of the edges of all cells, in order; sides are cut along these.
    """
    shape, nodes = shape_of(kind), elements.nodes
    corners = nodes[:, : CORNERS[shape]]
    if shape == "Quadrilateral":
        found, parents = triangles_of(corners, first_corners(corners, edges))
    elif shape in ("Hexahedron", "Prism", "Pyramid"):
        found, parents = _tetrahedra(shape, corners)
    else:
        return elements
    if nodes.shape[1] > CORNERS[shape]:
        first = CORNERS[shape] + len(EDGES[shape])
        for number, face in enumerate(FACES[shape], first):
            start = first_corners(nodes[:, face], edges)
            places = np.column_stack([start, start + 2])
            middles.add(np.take_along_axis(nodes[:, face], places, axis=1), nodes[:, number])
        if shape == "Hexahedron":
            smallest = np.argmin(corners, axis=1)
            places = np.column_stack([smallest, np.array(_OPPOSITE)[smallest]])
            middles.add(np.take_along_axis(corners, places, axis=1), nodes[:, 26])
        ends = found[:, np.array(EDGES[SIMPLEX[found.shape[1] - 1]])]
        of_edges = middles.find(ends.reshape(-1, 2)).reshape(len(found), -1)
        found = np.column_stack([found, of_edges])
    return elements.with_nodes(found, parents)


def edge_keys(kind: int, elements: Elements) -> NDArray[np.uint64]:
    """Keys of all edges of elements, each once, in order.

    Args:
        kind: Gmsh's type of the elements.
        elements: Of that type.
    """
    return np.unique(corner_keys(elements.nodes[:, np.array(EDGES[shape_of(kind)])].reshape(-1, 2)))


def first_corners(faces: Integers, edges: NDArray[np.uint64] | None = None) -> Integers:
    """Where the diagonals of faces begin: 0 for the one from the first corner, 1 for the other.

    Args:
        faces: Tags of four corners in order around each, (faces, 4).
        edges: Keys of edges, in order; where just one diagonal is an edge, it is that one.
    """
    by_node = np.argmin(faces, axis=1) % 2
    if edges is None:
        return by_node
    one, other = (np.isin(corner_keys(faces[:, [n, n + 2]]), edges) for n in (0, 1))
    return np.where(one == other, by_node, np.where(other, 1, 0))


def triangles_of(faces: Integers, first: Integers) -> tuple[Integers, Integers]:
    """Two triangles of each face, one after the other; and the place of the face of each.

    Args:
        faces: Tags of four corners in order around each, (faces, 4).
        first: Where the diagonal of each begins, 0 or 1.
    """
    places = np.array([[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]])[first]
    found = np.take_along_axis(faces[:, None, :], places, axis=2)
    return found.reshape(-1, 3), np.repeat(np.arange(len(faces)), 2)


def _tetrahedra(shape: str, corners: Integers) -> tuple[Integers, Integers]:
    """Tetrahedra of cells in the cells' order, and the place of the cell of each.

    Args:
        shape: Of the cells.
        corners: Their tags, (cells, corners).
    """
    cells = [np.zeros((0, 4), dtype=np.int64)]
    parents = [np.zeros(0, dtype=np.int64)]
    smallest = np.argmin(corners, axis=1)
    for place in range(CORNERS[shape]):
        rows = np.flatnonzero(smallest == place)
        mine = corners[rows]
        is_of_five = _meet_not(mine, place) if shape == "Hexahedron" else np.zeros(len(rows), bool)
        for side in SIDE_CORNERS[shape]:
            if place in side:
                continue
            faces = mine[:, side]
            if len(side) == 3:
                triangles, of_face = faces, np.arange(len(faces))
            else:
                triangles, of_face = triangles_of(faces, first_corners(faces))
            if shape == "Hexahedron":
                far = mine[of_face, _OPPOSITE[place]]
                kept = ~(is_of_five[of_face] & (triangles == far[:, None]).any(axis=1))
                triangles, of_face = triangles[kept], of_face[kept]
            cells.append(np.column_stack([triangles, mine[of_face, place]]))
            parents.append(rows[of_face])
        if is_of_five.any():
            cells.extend(_at_middle(mine[is_of_five], place))
            parents.extend(2 * [rows[is_of_five]])
    found, of_cell = np.concatenate(cells), np.concatenate(parents)
    order = np.argsort(of_cell, kind="stable")
    return found[order], of_cell[order]


def _meet_not(corners: Integers, place: int) -> Flags:
    """Whether no diagonal ends at the corner of a hexahedron that lies opposite of one."""
    found = np.ones(len(corners), dtype=bool)
    far = _OPPOSITE[place]
    for side in SIDE_CORNERS["Hexahedron"]:
        if far in side:
            found &= first_corners(corners[:, side]) != side.index(far) % 2
    return found


def _at_middle(corners: Integers, place: int) -> tuple[Integers, Integers]:
    """Two tetrahedra on both sides of the neighbours of the corner that lies opposite of one."""
    far = _OPPOSITE[place]
    near = [n for n in range(8) if np.abs(_UNIT[n] - _UNIT[far]).sum() == 1]
    if np.linalg.det((_UNIT[near] - _UNIT[place]).astype(float)) < 0:
        near[0], near[1] = near[1], near[0]
    turned = [near[1], near[0], near[2]]
    return corners[:, [place, *near]], corners[:, [far, *turned]]
