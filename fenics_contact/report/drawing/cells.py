"""Facets of a body that carry a contact, and where their nodes are in the cells of its files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.results.contact_points import ContactTable, facet_flags
from fenics_contact.results.records.contacts import ContactRecord

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


@dataclass(frozen=True)
class ContactPieces:
    """A contact surface in flat pieces between its nodes: segments, in space triangles.

    Attributes:
        rows: Its points that are nodes.
        nodes: The body's number of each, (points,).
        pieces: Numbers of the points of each piece, (pieces, 2) or (pieces, 3).
    """

    rows: ContactTable
    nodes: Integers
    pieces: Integers

    @property
    def closed(self) -> Flags:
        """Flags of the pieces of which more than half the points touch, (pieces,)."""
        return np.asarray(self.rows.closed[self.pieces].mean(axis=1) > 0.5)

    def only(self, wanted: Flags) -> ContactPieces:
        """Some of the points, and the pieces between these.

        Args:
            wanted: Which points, (points,).
        """
        number = np.where(wanted, np.cumsum(wanted) - 1, -1)
        pieces = number[self.pieces]
        pieces = pieces[(pieces >= 0).all(axis=1)]
        return ContactPieces(self.rows.rows(wanted), self.nodes[wanted], pieces)

    @property
    def connected(self) -> Integers:
        """Number of the connected part of the surface that each point is of, (points,)."""
        ends = self.pieces[:, [0, 1]], self.pieces[:, [1, -1]]
        links = np.concatenate(ends).T
        graph = coo_matrix((np.ones(links.shape[1]), links), shape=(len(self.nodes),) * 2)
        found: Integers = connected_components(graph, directed=False)[1].astype(np.int64)
        return found

    def cut(self, axis: int, place: float) -> Array:
        """Where the closed triangles cross a plane, the ends of each line, (lines, 2, 3) (length).

        Args:
            axis: Number of the axis that the plane is across.
            place: Its coordinate (length).
        """
        corners = self.rows.vectors("x", "y", "z")[self.pieces[self.closed]]
        before = corners[:, :, axis] < place
        crossed = corners[before.any(axis=1) & ~before.all(axis=1)]
        after = np.roll(crossed, -1, axis=1)
        here, there = crossed[:, :, axis], after[:, :, axis]
        meets = (here < place) != (there < place)  # two sides of each
        share = (place - here[meets]) / (there[meets] - here[meets])
        ends: Array = crossed[meets] + share[:, None] * (after[meets] - crossed[meets])
        return ends.reshape(-1, 2, 3)


def contact_pieces(
    body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord
) -> ContactPieces:
    """The surface of a contact, of its points that are nodes.

    Args:
        body: A pyvista grid with the field ``status`` and the facets of contacts.
        rows: Points of the contact.
        contact: Its entry in ``result.json``.
    """
    found, nodes = _nodes_at(body, rows, contact)
    number = np.full(body.n_points, -1)
    number[nodes] = np.arange(len(nodes))
    pieces = number[_simplices(_facets(body, contact), flat=_is_flat(body))]
    return ContactPieces(found, nodes, pieces[(pieces >= 0).all(axis=1)])


def nodes_at(
    body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord
) -> tuple[ContactTable, Integers]:
    """The points of a contact that are nodes of the body, and the numbers of these nodes.

    Between bodies those that face nothing are left out: their normals are others.

    Args:
        body: As for ``contact_pieces``.
        rows: Points of the contact.
        contact: Its entry in ``result.json``.
    """
    if contact.master is not None:
        rows = rows.rows(np.isfinite(rows.numbers["gap"]))
    return _nodes_at(body, rows, contact)


def _nodes_at(
    body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord
) -> tuple[ContactTable, Integers]:
    """Return the points of a contact that the body shows, and the body's nodes there."""
    facets = _facets(body, contact)
    status = np.asarray(body["status"])
    # not those of a surface opposite, at the same places
    on_contact = np.flatnonzero(status >= 0) if facets is None else np.unique(facets)
    if len(on_contact) == 0:
        return rows.rows(np.zeros(0, dtype=np.int64)), np.zeros(0, dtype=np.int64)
    nodes = np.asarray(body.points)[on_contact]
    distance, found = cKDTree(nodes).query(rows.vectors("x", "y", "z"))
    drawn = distance < 1e-6 * np.ptp(nodes)
    return rows.rows(drawn), on_contact[found[drawn]]


def _facets(body: UnstructuredGrid, contact: ContactRecord) -> Integers:
    """Nodes of the facets that carry a contact, (facets, nodes)."""
    flags = np.asarray(body.cell_data[facet_flags(contact.name)]).astype(np.int64)
    cell, cells = cells_of(body)
    parts = [cells[flags >> i & 1 == 1][:, list(facet)] for i, facet in enumerate(cell.facets)]
    return np.concatenate(parts)


def _is_flat(body: UnstructuredGrid) -> bool:
    return bool(cells_of(body)[0].whole)


def _simplices(facets: Integers, flat: bool) -> Integers:
    """Segments or triangles between the nodes of facets, (pieces, 2) or (pieces, 3)."""
    if not flat:
        return facets[:, TRIANGLES[facets.shape[1]]].reshape(-1, 3)
    parts = [(0, 1)] if facets.shape[1] == 2 else [(0, 2), (2, 1)]
    return facets[:, parts].reshape(-1, 2)
