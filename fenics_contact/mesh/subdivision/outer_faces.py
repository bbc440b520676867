"""Faces of four corners on the boundary of cells: what cutting them by a diagonal changes.

Inside, the two cells of a face are cut in the same way. On the boundary a face that is not plane
becomes two triangles; where it lies against two triangles of other cells, these must be the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import basix
import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.mesh.readers.element_kinds import EDGES, SIDES, corner_keys, dimension_of
from fenics_contact.mesh.subdivision.elements import Elements, Middles, Nodes
from fenics_contact.mesh.subdivision.simplices import first_corners, triangles_of

_QUADRATURE = 8  # degree: exact for the volume behind faces of order 2
# Nodes of a face along its two directions.
_AT = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]])


@dataclass(frozen=True, eq=False)
class OuterFaces:
    """Quadrilateral faces on the outside of a mesh.

    Attributes:
        nodes: Tags of each, those of corners first; they turn about normals into the cell.
        numbers: The file's number of the cell of each.
    """

    nodes: Integers
    numbers: Integers


def outer_faces(cells: Mapping[int, Elements], width: int) -> OuterFaces:
    """Faces of four corners that only one cell has.

    Args:
        cells: In space, by Gmsh's type; complete, and all of one order.
        width: Nodes of a face: 4, or 9 of order 2.
    """
    nodes, numbers = [np.zeros((0, width), dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for kind, elements in cells.items():
        for _, places in SIDES[kind] if dimension_of(kind) == 3 else ():
            if len(places) == width:
                nodes.append(elements.nodes[:, places])
                numbers.append(elements.numbers)
    every, of_cells = np.concatenate(nodes), np.concatenate(numbers)
    _, inverse, counts = np.unique(
        corner_keys(every[:, :4]), return_inverse=True, return_counts=True
    )
    outer = counts[inverse] == 1
    return OuterFaces(every[outer], of_cells[outer])


def volume_added(faces: OuterFaces, middles: Middles, nodes: Nodes) -> float:
    """How much larger the cells become where their outer faces are cut into triangles (volume).

    Args:
        faces: Of the cells.
        middles: With those of diagonals, of order 2.
        nodes: Of the mesh.
    """
    if len(faces.nodes) == 0:
        return 0.0
    corners = faces.nodes[:, :4]
    triangles, parents = triangles_of(corners, first_corners(corners))
    at = nodes.at(faces.nodes)
    origin = at[:, :4].mean(axis=1)
    if faces.nodes.shape[1] > 4:
        ends = triangles[:, np.array(EDGES["Triangle"])].reshape(-1, 2)
        triangles = np.column_stack([triangles, middles.find(ends).reshape(len(triangles), -1)])
    cut = nodes.at(triangles) - origin[parents][:, None]
    before = _behind(at - origin[:, None], basix.CellType.quadrilateral)
    return float(before.sum() - _behind(cut, basix.CellType.triangle).sum())


def _behind(at: Array, cell: basix.CellType) -> Array:
    """Volume between faces and the origin, positive on the side to which their normals point.

    Args:
        at: Nodes of each face in Gmsh's order, (faces, nodes, 3) (length).
        cell: What the faces are.
    """
    points, weights = basix.make_quadrature(cell, _QUADRATURE)
    if cell == basix.CellType.triangle:
        shapes, along, across = _of_triangle(points, at.shape[1])
    else:
        shapes, along, across = _of_quadrilateral(points, at.shape[1])
    x, dx, dy = (np.einsum("qn,fnd->fqd", each, at) for each in (shapes, along, across))
    return np.asarray((x * np.cross(dx, dy)).sum(axis=2) @ weights / 3)


def _of_quadrilateral(points: Array, count: int) -> tuple[Array, Array, Array]:
    """Shape functions and their two derivatives at points, (points, nodes) each."""
    x, y = points[:, :1], points[:, 1:]
    if count == 4:
        places = _AT[:4] // 2
        one, two = ((np.hstack([1 - t, t]), np.tile([-1.0, 1.0], (len(t), 1))) for t in (x, y))
    else:
        places = _AT
        one, two = (
            (
                np.hstack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)]),
                np.hstack([4 * t - 3, 4 - 8 * t, 4 * t - 1]),
            )
            for t in (x, y)
        )
    (f, df), (g, dg) = one, two
    first, second = places[:, 0], places[:, 1]
    return f[:, first] * g[:, second], df[:, first] * g[:, second], f[:, first] * dg[:, second]


def _of_triangle(points: Array, count: int) -> tuple[Array, Array, Array]:
    """Shape functions and their two derivatives at points, (points, nodes) each."""
    shares = np.column_stack([1 - points.sum(axis=1), points])
    slopes = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    if count == 3:
        along, across = (np.tile(slopes[:, n], (len(points), 1)) for n in (0, 1))
        return shares, along, across
    ends = np.array(EDGES["Triangle"])
    first, second = shares[:, ends[:, 0]], shares[:, ends[:, 1]]
    along, across = (
        np.hstack(
            [
                (4 * shares - 1) * slopes[:, n],
                4 * (first * slopes[ends[:, 1], n] + second * slopes[ends[:, 0], n]),
            ]
        )
        for n in (0, 1)
    )
    return np.hstack([shares * (2 * shares - 1), 4 * first * second]), along, across


def check_against_triangles(where: str, faces: OuterFaces, edges: NDArray[np.uint64]) -> None:
    """Refuse faces that lie against two triangles of other cells, cut by the other diagonal.

    Args:
        where: What begins a message: the file.
        faces: Of the cells.
        edges: Keys of the edges of all cells.

    Raises:
        InputError: There are such.
    """
    corners = faces.nodes[:, :4]
    other = 1 - first_corners(corners)
    ends = np.take_along_axis(corners, np.column_stack([other, other + 2]), axis=1)
    bad = np.isin(corner_keys(ends), edges)
    if bad.any():
        raise InputError(
            f"{where}: a face of four corners of the element {faces.numbers[bad][0]} lies against "
            f"two triangles of other cells ({bad.sum()} such faces), which do not fit together; "
            "put pyramids between them, or mesh one of the two bodies on its own and put a bonded "
            "contact between both"
        )
