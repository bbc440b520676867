"""The facets of a body that carry a contact, so that pictures show the surface that there is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.report.drawing.cells import TRIANGLES, cells_of
from fenics_contact.results.contact_points import ContactTable, facet_flags
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


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
