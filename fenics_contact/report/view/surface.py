"""The surface of a body as triangles that carry its nodal fields, from arrays alone.

Cells are those of the fields' files, of degree 1 or 2; each facet of degree 2 becomes four or
eight triangles, so that all its nodes are used.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

# More triangles make a page slow on a telephone, and large.
MOST_TRIANGLES = 40_000
# Of the body's size, no round number: places that differ by less are the same.
_SAME = 1.2345e-9


@dataclass(frozen=True)
class _Cell:
    """Where the nodes of a cell are, in VTK's order.

    Attributes:
        facets: Nodes of each facet: its corners in order and, of degree 2, the nodes amid its
            sides in the same order and that of a quadrilateral's centre.
        corners: Of a facet.
    """

    facets: tuple[tuple[int, ...], ...]
    corners: int


def _facets_of_tetrahedron(degree: int) -> tuple[tuple[int, ...], ...]:
    amid = {(0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 3): 7, (1, 3): 8, (2, 3): 9}
    corners = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
    return tuple(_with_sides(facet, amid) if degree > 1 else facet for facet in corners)


def _facets_of_hexahedron(degree: int) -> tuple[tuple[int, ...], ...]:
    amid = {(0, 1): 8, (1, 2): 9, (2, 3): 10, (0, 3): 11}
    amid |= {(4, 5): 12, (5, 6): 13, (6, 7): 14, (4, 7): 15}
    amid |= {(0, 4): 16, (1, 5): 17, (2, 6): 18, (3, 7): 19}
    centres = {(0, 3, 7, 4): 20, (1, 2, 6, 5): 21, (0, 1, 5, 4): 22}
    centres |= {(3, 2, 6, 7): 23, (0, 1, 2, 3): 24, (4, 5, 6, 7): 25}
    if degree == 1:
        return tuple(centres)
    return tuple((*_with_sides(facet, amid), centre) for facet, centre in centres.items())


def _with_sides(facet: tuple[int, ...], amid: dict[tuple[int, int], int]) -> tuple[int, ...]:
    sides = zip(facet, (*facet[1:], facet[0]), strict=True)
    return (*facet, *(amid[min(a, b), max(a, b)] for a, b in sides))


# By VTK's number of the kind of cell. A flat cell is its own facet.
_CELLS = {
    5: _Cell(((0, 1, 2),), 3),
    69: _Cell((tuple(range(6)),), 3),
    9: _Cell(((0, 1, 2, 3),), 4),
    70: _Cell((tuple(range(9)),), 4),
    10: _Cell(_facets_of_tetrahedron(1), 3),
    71: _Cell(_facets_of_tetrahedron(2), 3),
    12: _Cell(_facets_of_hexahedron(1), 4),
    72: _Cell(_facets_of_hexahedron(2), 4),
}
# Of a facet by the number of its nodes: the triangles that it becomes, and its sides in pieces.
_TRIANGLES: dict[int, list[tuple[int, int, int]]] = {
    3: [(0, 1, 2)],
    4: [(0, 1, 2), (0, 2, 3)],
    6: [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)],
    9: [
        *((0, 4, 8), (0, 8, 7), (4, 1, 5), (4, 5, 8)),
        *((8, 5, 2), (8, 2, 6), (7, 8, 6), (7, 6, 3)),
    ],
}


@dataclass(frozen=True)
class Surface:
    """Triangles between points that carry fields.

    Attributes:
        points: Undeformed, (points, 3) (length).
        triangles: Numbers of each triangle's points, (triangles, 3).
        lines: Numbers of the ends of pieces of cells' sides, (pieces, 2).
        fields: Values at the points, by name; those with three components are vectors.
    """

    points: Array
    triangles: Integers
    lines: Integers
    fields: dict[str, Array]

    def only_used(self) -> Surface:
        """Without the points that no triangle has."""
        used, inverse = np.unique(self.triangles, return_inverse=True)
        renumbered = np.full(len(self.points), -1)
        renumbered[used] = np.arange(len(used))
        lines = renumbered[self.lines]
        return Surface(
            self.points[used],
            inverse.reshape(-1, 3),
            lines[(lines >= 0).all(axis=1)],
            {name: values[used] for name, values in self.fields.items()},
        )


def surface_of(
    body: UnstructuredGrid, fields: dict[str, Array], most: int = MOST_TRIANGLES
) -> Surface:
    """The surface of a body in space, all of a flat one.

    Args:
        body: Has ``points``, ``cell_connectivity`` and ``celltypes``, as a pyvista grid; its
            pieces need not share the nodes between them.
        fields: Values at the nodes, by name; `displacement` among them.
        most: Of degree 2, triangles between the corners alone are made where there would be more.

    Raises:
        KeyError: A kind of cell that this program does not write.
    """
    cell, cells = _cells(body)
    points, fields, cells = _joined(np.asarray(body.points, dtype=float), fields, cells)
    facets, inside = _facets(cell, cells, points)
    facets = _outward(facets, inside, points, cell.corners)
    if len(facets) * len(_TRIANGLES[facets.shape[1]]) > most:
        facets = facets[:, : cell.corners]
    triangles = facets[:, _TRIANGLES[facets.shape[1]]].reshape(-1, 3)
    return Surface(points, triangles, _sides(facets, cell.corners), fields).only_used()


def _cells(body: UnstructuredGrid) -> tuple[_Cell, Integers]:
    """The kind of all cells, and their nodes, (cells, nodes)."""
    (kind,) = np.unique(body.celltypes).tolist()
    return _CELLS[kind], np.asarray(body.cell_connectivity, np.int64).reshape(body.n_cells, -1)


def _joined(
    points: Array, fields: dict[str, Array], cells: Integers
) -> tuple[Array, dict[str, Array], Integers]:
    """Nodes that pieces of a body share, once.

    Two bodies that touch have nodes at the same places, but these move by other amounts, if only
    by the penetration. Ranks compute places each for itself, displacements once.
    """
    places = np.round(points / (_SAME * np.ptp(points, axis=0).max()))
    rows = np.ascontiguousarray(np.hstack([places, fields["displacement"]]) + 0.0)
    keys = rows.view(np.dtype((np.void, rows.itemsize * rows.shape[1]))).ravel()
    _, kept, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return points[kept], {name: values[kept] for name, values in fields.items()}, inverse[cells]


def _facets(cell: _Cell, cells: Integers, points: Array) -> tuple[Integers, Array]:
    """Facets of the surface, and of each a point on its inner side, (facets, 3)."""
    facets = np.concatenate([cells[:, list(facet)] for facet in cell.facets])
    centres = points[cells].mean(axis=1)
    if len(cell.facets) == 1:
        return facets, centres - [0.0, 0.0, 1.0]
    inside = np.tile(centres, (len(cell.facets), 1))
    alone = _once(facets[:, : cell.corners])
    return facets[alone], inside[alone]


def _once(rows: Integers) -> Flags:
    """Which rows have numbers that no other row has, in any order."""
    ordered = np.sort(rows, axis=1)
    keys = ordered[:, 0]
    for column in ordered[:, 1:].T:  # of two keys one, small enough for the next product
        _, keys = np.unique(keys, return_inverse=True)
        keys = keys * (column.max(initial=0) + 1) + column
    _, inverse, count = np.unique(keys, return_inverse=True, return_counts=True)
    return np.asarray(count[inverse] == 1)


def _outward(facets: Integers, inside: Array, points: Array, corners: int) -> Integers:
    """Facets whose nodes go round them counter-clockwise, seen from outside."""
    a, b, c = (points[facets[:, corner]] for corner in (0, 1, 2))
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - inside) > 0
    back = [0, *range(corners - 1, 0, -1)]
    sides = [*range(2 * corners - 1, corners - 1, -1)]
    turned = [*back, *sides, *range(2 * corners, facets.shape[1])]
    return np.where(outward[:, None], facets, facets[:, turned[: facets.shape[1]]])


def _sides(facets: Integers, corners: int) -> Integers:
    """Sides of the facets in pieces, each once, (pieces, 2)."""
    ends = facets[:, :corners], np.roll(facets[:, :corners], -1, axis=1)
    if facets.shape[1] == corners:
        pieces = [np.stack(ends, axis=-1)]
    else:
        amid = facets[:, corners : 2 * corners]
        pieces = [np.stack([end, amid], axis=-1) for end in ends]
    return np.unique(np.sort(np.concatenate(pieces).reshape(-1, 2), axis=1), axis=0)


def boundary(triangles: Integers) -> Integers:
    """Sides that only one triangle has, in its sense, (sides, 2)."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return sides[_once(sides)]
