"""The surface of a body as triangles that carry its nodal fields, and that of a body of revolution.

Cells are those of the fields' files, of degree 1 or 2; each facet of degree 2 becomes four or eight
triangles, so that all its nodes are used.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.report.drawing.cells import TRIANGLES, Cell, cells_of
from fenics_contact.results.contact_points import BODY_OF_CELLS

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

# More triangles make a page slow on a telephone, and large.
MOST_TRIANGLES = 40_000
# Of the body's size, no round number: places that differ by less are the same.
_SAME = 1.2345e-9


@dataclass(frozen=True)
class BodySurface:
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

    def only_used(self) -> BodySurface:
        """Without the points that no triangle has."""
        used, inverse = np.unique(self.triangles, return_inverse=True)
        renumbered = np.full(len(self.points), -1)
        renumbered[used] = np.arange(len(used))
        lines = renumbered[self.lines]
        return BodySurface(
            self.points[used],
            inverse.reshape(-1, 3),
            lines[(lines >= 0).all(axis=1)],
            {name: values[used] for name, values in self.fields.items()},
        )


def surface_of(
    body: UnstructuredGrid, fields: dict[str, Array], most: int = MOST_TRIANGLES
) -> BodySurface:
    """The surface of a body in space, all of a flat one.

    Args:
        body: Has ``points``, ``cell_connectivity`` and ``celltypes``, as a pyvista grid; its
            pieces need not share the nodes between them.
        fields: Values at the nodes, by name; `displacement` among them, and if known `body`.
        most: Of degree 2, triangles between the corners alone are made where there would be more.

    Raises:
        KeyError: A kind of cell that this program does not write.
    """
    cell, cells = cells_of(body)
    points, fields, cells = _joined(np.asarray(body.points, dtype=float), fields, cells)
    facets, inside = _facets(cell, cells, points)
    facets = _outward(facets, inside, points, cell.corners_of_face)
    if len(facets) * len(TRIANGLES[facets.shape[1]]) > most:
        facets = facets[:, : cell.corners_of_face]
    triangles = facets[:, TRIANGLES[facets.shape[1]]].reshape(-1, 3)
    return BodySurface(points, triangles, _sides(facets, cell.corners_of_face), fields).only_used()


def _joined(
    points: Array, fields: dict[str, Array], cells: Integers
) -> tuple[Array, dict[str, Array], Integers]:
    """Nodes that pieces of a body share, once.

    Two bodies that touch have nodes at the same places, and so have the two sides of a slit in a
    single body: these move by other amounts, if only by the penetration. Ranks compute places each
    for itself, displacements once.
    """
    places = np.round(points / (_SAME * np.ptp(points, axis=0).max()))
    apart = fields.get(BODY_OF_CELLS, fields["displacement"]).reshape(len(points), -1)
    rows = np.ascontiguousarray(np.hstack([places, apart]) + 0.0)
    keys = rows.view(np.dtype((np.void, rows.itemsize * rows.shape[1]))).ravel()
    _, kept, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return points[kept], {name: values[kept] for name, values in fields.items()}, inverse[cells]


def _facets(cell: Cell, cells: Integers, points: Array) -> tuple[Integers, Array]:
    """Facets of the surface, and of each a point on its inner side, (facets, 3)."""
    facets = np.concatenate([cells[:, list(facet)] for facet in cell.faces])
    centres = points[cells].mean(axis=1)
    if len(cell.faces) == 1:
        return facets, centres - [0.0, 0.0, 1.0]
    inside = np.tile(centres, (len(cell.faces), 1))
    alone = _once(facets[:, : cell.corners_of_face])
    return facets[alone], inside[alone]


def _once(rows: Integers) -> Flags:
    """Return for each row whether no other row has the same numbers, in any order."""
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


# The quarter that is missing is the one that is looked into.
REVOLVED = (0.5 * np.pi, 2.0 * np.pi)
_STRIPS = (12, 60)  # around the axis, at the least and at the most
_SHARP = np.cos(np.deg2rad(30))


def revolved(
    body: UnstructuredGrid, fields: dict[str, Array], most: int = MOST_TRIANGLES
) -> BodySurface:
    """The surface of a body of revolution.

    Args:
        body: Its section, as for ``surface_of``; x is the radius, y the axis, which is z then.
        fields: Likewise.
        most: Triangles at the most, if it can be.
    """
    section = surface_of(body, fields, most // 4)
    radius = section.points[:, 0]
    rim = boundary(section.triangles)
    rim = rim[(radius[rim] > 1e-9 * radius.max()).any(axis=1)]  # none along the axis
    room = (most - 2 * len(section.triangles)) // max(2 * len(rim), 1)
    strips = int(np.clip(room, *_STRIPS))
    nodes, edges = np.unique(rim, return_inverse=True)
    edges = edges.reshape(-1, 2)
    angles = np.linspace(*REVOLVED, strips + 1)
    ends = [turned(section, angle) for angle in (angles[0], angles[-1])]
    outside = _part(section, nodes)
    parts = [*ends, *(turned(outside, angle) for angle in angles)]
    second, around = len(section.points), 2 * len(section.points)
    sharp = _corners(outside.points, edges)
    return BodySurface(
        np.concatenate([part.points for part in parts]),
        np.concatenate(
            [
                ends[0].triangles,
                ends[1].triangles[:, ::-1] + second,
                around + strip_triangles(edges, len(nodes), strips),
            ]
        ),
        np.concatenate(
            [ends[0].lines, ends[1].lines + second, around + _rings(sharp, len(nodes), strips)]
        ),
        {name: np.concatenate([part.fields[name] for part in parts]) for name in section.fields},
    ).only_used()


def turned(flat: BodySurface, angle: float) -> BodySurface:
    """A flat surface turned around the axis by an angle."""
    fields = {
        name: turned_vectors(values, angle) if values.ndim > 1 else values
        for name, values in flat.fields.items()
    }
    return replace(flat, points=turned_vectors(flat.points, angle), fields=fields)


def turned_vectors(flat: Array, angle: float) -> Array:
    """Vectors whose first two components are those along radius and axis, (n, 3)."""
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    return np.asarray(np.outer(flat[:, 0], out) + np.outer(flat[:, 1], [0.0, 0.0, 1.0]))


def strip_triangles(edges: Integers, nodes: int, strips: int) -> Integers:
    """Triangles between copies of edges, those of a copy following each other, (triangles, 3).

    Args:
        edges: Numbers of their ends, (edges, 2).
        nodes: In each copy.
        strips: Of which there is one more copy.
    """
    here = edges[None] + nodes * np.arange(strips)[:, None, None]
    a, b = here[..., 0], here[..., 1]
    first = np.stack([a, a + nodes, b], axis=-1)
    second = np.stack([b, a + nodes, b + nodes], axis=-1)
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def _part(section: BodySurface, nodes: Integers) -> BodySurface:
    """Some of its points alone."""
    fields = {name: values[nodes] for name, values in section.fields.items()}
    none = np.zeros((0, 2), dtype=np.int64)
    return BodySurface(section.points[nodes], np.zeros((0, 3), dtype=np.int64), none, fields)


def _corners(points: Array, edges: Integers) -> Integers:
    """Numbers of the points at which a line of edges ends, or turns sharply."""
    along = points[edges[:, 1]] - points[edges[:, 0]]
    along /= np.linalg.norm(along, axis=1)[:, None]
    coming, going = np.zeros_like(points), np.zeros_like(points)
    coming[edges[:, 1]], going[edges[:, 0]] = along, along
    return np.flatnonzero(np.einsum("ij,ij->i", coming, going) < _SHARP)


def _rings(nodes: Integers, count: int, strips: int) -> Integers:
    """Pieces of the circles of some nodes, whose copies follow each other."""
    here = nodes[None] + count * np.arange(strips)[:, None]
    return np.stack([here, here + count], axis=-1).reshape(-1, 2)
