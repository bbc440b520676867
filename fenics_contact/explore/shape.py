"""Shape that the page draws: the surface of the body, and the places of contact points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from dolfinx import plot
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.wording import one_line
from fenics_contact.explore.messages import Message
from fenics_contact.problem.problem import Problem
from fenics_contact.report.bodies.surface import BodySurface, boundary, surface_of
from fenics_contact.report.contacts.line import positions, tangents
from fenics_contact.report.drawing.charts import Cylinder, Plane, chart_of
from fenics_contact.report.drawing.style import neighbourhood
from fenics_contact.results.contact_points import ContactPoints, ContactTable
from fenics_contact.results.records.contacts import ContactRecord

# More triangles, or sides of cells, would not follow while one drags.
_MOST_TRIANGLES, _MOST_LINES = 12_000, 8_000
_INTERRUPTED = 4.0  # spacing of points over those beside it, where a line is interrupted
STATUS = ("OPEN", "STICK", "SLIP")


@dataclass(frozen=True)
class _Grid:
    """The part of a pyvista grid by which the surface of a body is found."""

    points: Array
    celltypes: Integers
    cell_connectivity: Integers

    @property
    def n_cells(self) -> int:
        return len(self.celltypes)


@dataclass(frozen=True)
class ContactPlaces:
    """Where the points of a contact stand on the page.

    Attributes:
        name: Of the contact.
        rows: Its rows among all contact points, in the order in which they are drawn.
        at: Positions along the line, or two coordinates on the surface, (points, 1 or 2) (length).
        along: Unit vectors along the line, (points, 3); of a surface none.
        names: Of the coordinates.
        nodes: The body's node at each point, -1 where there is none, (points,).
        pieces: Of the points that are nodes: ends of segments or corners of triangles between them.
        is_rigid: Whether a rigid obstacle stands against it.
    """

    name: str
    rows: Integers
    at: Array
    along: Array
    names: tuple[str, ...]
    nodes: Integers
    pieces: Integers
    is_rigid: bool

    def parts(self, points: ContactPoints) -> dict[str, Array]:
        """Return the values of an answer for curves and maps, in the order of the points."""
        rows = self.rows
        codes = np.select([points.status[rows] == word for word in STATUS], [0, 1, 2])
        found = {"friction": points.friction_traction[rows], "slip": points.slip[rows]}
        return {
            "pressure": points.contact_pressure[rows],
            "gap": points.gap[rows],
            "status": codes.astype(np.int32),
            **{name: self._shown(vectors) for name, vectors in found.items()},
        }

    def _shown(self, vectors: Array) -> Array:
        """Components along a line; on a surface lengths."""
        if len(self.along):
            return np.asarray(np.einsum("ij,ij->i", vectors, self.along))
        return np.asarray(np.linalg.norm(vectors, axis=1))

    def obstacle(self, points: ContactPoints, displacement: Array) -> Array:
        """From the undeformed points to the obstacle: u_n + gap along the normal, (points, 3)."""
        normals, gap = points.normals[self.rows], points.gap[self.rows]
        moved = np.where(self.nodes[:, None] >= 0, displacement[self.nodes], np.nan)
        return np.asarray((np.einsum("ij,ij->i", moved, normals) + gap)[:, None] * normals)

    def zone(self, points: ContactPoints) -> Array:
        """Lowest and highest coordinates around what touches, (2, 3) (length)."""
        places, closed = points.coordinates[self.rows], points.status[self.rows] != "OPEN"
        return np.array(neighbourhood(places, closed))


class BodyShape:
    """The body and its contacts as the page draws them; of one rank.

    Attributes:
        contacts: The places of each contact's points, in scene order.
        nodes: The body's node of every point of the surface.
        dimension: 2 of plane and axisymmetric models, else 3.

    Args:
        problem: On the body.
        points: Of an answer.
        records: Of the contacts.
    """

    def __init__(
        self, problem: Problem, points: ContactPoints, records: Sequence[ContactRecord]
    ) -> None:
        spaces = problem.spaces
        self.dimension = spaces.components
        self._coordinates = np.asarray(spaces.coordinates)
        self._surface, self.nodes = _surface_of(problem)
        facets = self._facets()
        self.contacts = [
            self._places(points, number, record, np.asarray(contact.nodes), facets)
            for number, (record, contact) in enumerate(zip(records, problem.contacts, strict=True))
        ]
        self._at = points.coordinates

    def is_of(self, problem: Problem, points: ContactPoints) -> bool:
        """Whether a body's answer can be drawn on it."""
        same = np.array_equal(self._coordinates, problem.spaces.coordinates)
        return same and np.array_equal(self._at, points.coordinates)

    def message(self) -> Message:
        """Return the message of the shape to the page."""
        surface, size = self._surface, np.ptp(self._coordinates, axis=0)
        lines = surface.lines
        if len(lines) > _MOST_LINES:
            lines = boundary(surface.triangles) if self.dimension == 2 else lines[:0]
        arrays: dict[str, Any] = {
            "points": surface.points,
            "triangles": surface.triangles,
            "lines": lines,
        }
        for number, places in enumerate(self.contacts):
            arrays[f"{number}.at"] = places.at
            arrays[f"{number}.places"] = self._at[places.rows]
            arrays[f"{number}.pieces"] = places.pieces
            arrays[f"{number}.breaks"] = _breaks(places.at)
        header = {
            "dimension": self.dimension,
            "size": float(np.linalg.norm(size)),
            "contacts": [
                {"name": one_line(places.name), "axes": list(places.names)}
                for places in self.contacts
            ],
        }
        return Message("shape", header, arrays)

    def _facets(self) -> Integers:
        """Segments of the outline, or triangles of the surface, by the body's nodes."""
        triangles = self._surface.triangles
        pieces = boundary(triangles) if self.dimension == 2 else triangles
        return np.asarray(self.nodes[pieces])

    def _places(
        self,
        points: ContactPoints,
        number: int,
        record: ContactRecord,
        own: Integers,
        facets: Integers,
    ) -> ContactPlaces:
        rows = np.flatnonzero(points.of(number))
        table = _table(points, rows)
        if self.dimension == 2:
            axis, circle, position = positions(table)
            order = np.argsort(position, kind="stable")
            along = tangents(table, axis, circle)[order]
            along = np.column_stack([along, np.zeros(len(along))])
            names: tuple[str, ...] = ("xy"[axis],) if circle is None else ("along the arc",)
            rows, at = rows[order], position[order, None]
        else:
            chart = chart_of(table)
            at, along, names = chart.flat(points.coordinates[rows]), np.zeros((0, 3)), _names(chart)
        nodes = self._nodes_at(points.coordinates[rows], own)
        place_of = np.full(len(self._coordinates) + 1, -1)
        place_of[nodes[nodes >= 0]] = np.flatnonzero(nodes >= 0)
        pieces = place_of[facets]
        pieces = pieces[(pieces >= 0).all(axis=1)]
        if self.dimension == 3:  # none across the seam of a cylinder
            pieces = pieces[np.ptp(at[pieces, 0], axis=1) < 0.5 * np.ptp(at[:, 0])]
        is_rigid = record.is_rigid and record.master is None
        return ContactPlaces(record.name, rows, at, along, names, nodes, pieces, is_rigid)

    def _nodes_at(self, places: Array, own: Integers) -> Integers:
        """The contact's own node at each of its points, -1 where there is none."""
        if not len(own):
            return np.full(len(places), -1)
        distance, found = cKDTree(self._coordinates[own]).query(places)
        same = distance < 1e-9 * np.ptp(self._coordinates, axis=0).max()
        return np.where(same, own[found], -1)


def _surface_of(problem: Problem) -> tuple[BodySurface, Integers]:
    """Return the surface of a problem's body, and the node of each of its points."""
    space = problem.spaces.displacement_space
    cells, kinds, points = plot.vtk_mesh(space)
    width = space.dofmap.dof_layout.num_dofs
    nodes = np.asarray(cells).reshape(-1, width + 1)[:, 1:]
    grid = _Grid(np.asarray(points), np.asarray(kinds), nodes.reshape(-1).astype(np.int64))
    count = len(points)
    fields = {
        "displacement": np.zeros((count, 3)),
        "node": np.arange(count, dtype=float),
        "body": np.asarray(problem.spaces.parts.of_node, dtype=float),
    }
    found = surface_of(cast(Any, grid), fields, _MOST_TRIANGLES)
    return found, found.fields["node"].astype(np.int64)


def _breaks(at: Array) -> Integers:
    """After which points a line is interrupted."""
    if at.shape[1] != 1 or len(at) < 3:
        return np.zeros(0, dtype=np.int64)
    spacing = np.diff(at[:, 0])
    beside = np.maximum(np.append(spacing[1:], 0.0), np.insert(spacing[:-1], 0, 0.0))
    return np.flatnonzero(spacing > _INTERRUPTED * beside)


def _names(chart: Plane | Cylinder) -> tuple[str, ...]:
    if isinstance(chart, Cylinder):
        return "along the arc", "along the axis"
    return tuple(name.replace("$", "") for name in chart.names)


def _table(points: ContactPoints, rows: Integers) -> ContactTable:
    """The columns that charts and lines are found by."""
    columns = np.column_stack([points.coordinates, points.normals])[rows].T
    numbers = dict(zip(("x", "y", "z", "nx", "ny", "nz"), columns, strict=True))
    numbers |= {"gap": points.gap[rows], "contact_pressure": points.contact_pressure[rows]}
    return ContactTable(np.full(len(rows), ""), points.status[rows], numbers)
