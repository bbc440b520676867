"""Cells of the fields' files: where the nodes of their facets are, in VTK's order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Integers

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


@dataclass(frozen=True)
class Cell:
    """Where the nodes of a cell are.

    Attributes:
        facets: Nodes of each facet, which stand in the order of the reference cell of the finite
            elements: corners in order and, of degree 2, the nodes amid its sides in the same
            order and that of a quadrilateral's centre.
        corners: Of a facet.
        whole: Nodes of a flat cell in the same order, none in space.
    """

    facets: tuple[tuple[int, ...], ...]
    corners: int
    whole: tuple[int, ...] = ()

    @property
    def faces(self) -> tuple[tuple[int, ...], ...]:
        """Faces of a surface: facets of cells in space, and flat cells themselves."""
        return (self.whole,) if self.whole else self.facets

    @property
    def corners_of_face(self) -> int:
        """Number of corners of one of ``faces``."""
        if not self.whole:
            return self.corners
        return {3: 3, 6: 3, 4: 4, 9: 4}[len(self.whole)]


def _triangle(degree: int) -> Cell:
    sides = ((1, 2), (0, 2), (0, 1))
    if degree == 1:
        return Cell(sides, 2, (0, 1, 2))
    amid = {(0, 1): 3, (1, 2): 4, (0, 2): 5}
    return Cell(tuple((*side, amid[side]) for side in sides), 2, tuple(range(6)))


def _quadrilateral(degree: int) -> Cell:
    sides = ((0, 1), (0, 3), (1, 2), (3, 2))
    if degree == 1:
        return Cell(sides, 2, (0, 1, 2, 3))
    amid = {(0, 1): 4, (1, 2): 5, (3, 2): 6, (0, 3): 7}
    return Cell(tuple((*side, amid[side]) for side in sides), 2, tuple(range(9)))


def _tetrahedron(degree: int) -> Cell:
    corners = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))
    amid = {(0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 3): 7, (1, 3): 8, (2, 3): 9}
    return Cell(tuple(_with_sides(f, amid) if degree > 1 else f for f in corners), 3)


def _hexahedron(degree: int) -> Cell:
    amid = {(0, 1): 8, (1, 2): 9, (2, 3): 10, (0, 3): 11}
    amid |= {(4, 5): 12, (5, 6): 13, (6, 7): 14, (4, 7): 15}
    amid |= {(0, 4): 16, (1, 5): 17, (2, 6): 18, (3, 7): 19}
    centres = {(0, 1, 2, 3): 24, (0, 1, 5, 4): 22, (0, 3, 7, 4): 20}
    centres |= {(1, 2, 6, 5): 21, (3, 2, 6, 7): 23, (4, 5, 6, 7): 25}
    if degree == 1:
        return Cell(tuple(centres), 4)
    return Cell(tuple((*_with_sides(f, amid), centre) for f, centre in centres.items()), 4)


def _with_sides(facet: tuple[int, ...], amid: dict[tuple[int, int], int]) -> tuple[int, ...]:
    sides = zip(facet, (*facet[1:], facet[0]), strict=True)
    return (*facet, *(amid[min(a, b), max(a, b)] for a, b in sides))


# By VTK's number of the kind of cell.
_CELLS = {
    5: _triangle(1),
    69: _triangle(2),
    9: _quadrilateral(1),
    70: _quadrilateral(2),
    10: _tetrahedron(1),
    71: _tetrahedron(2),
    12: _hexahedron(1),
    72: _hexahedron(2),
}
# Of a face by the number of its nodes: the triangles that it becomes.
TRIANGLES: dict[int, list[tuple[int, int, int]]] = {
    3: [(0, 1, 2)],
    4: [(0, 1, 2), (0, 2, 3)],
    6: [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)],
    9: [
        *((0, 4, 8), (0, 8, 7), (4, 1, 5), (4, 5, 8)),
        *((8, 5, 2), (8, 2, 6), (7, 8, 6), (7, 6, 3)),
    ],
}


def cells_of(body: UnstructuredGrid) -> tuple[Cell, Integers]:
    """The kind of all cells of a grid, and their nodes, (cells, nodes).

    Raises:
        KeyError: A kind of cell that this program does not write.
    """
    (kind,) = np.unique(body.celltypes).tolist()
    return _CELLS[kind], np.asarray(body.cell_connectivity, np.int64).reshape(body.n_cells, -1)
