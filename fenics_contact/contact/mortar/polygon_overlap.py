"""Where two contact surfaces face each other in space, after Puso and Laursen (2004).

Both are projected along the mean normal onto a plane through the centre of each piece of the
slave, and clipped there. https://doi.org/10.1016/j.cma.2003.10.010

Convex polygons are clipped in the plane, many pairs at once. Polygons are
(polygons, corners, 2) (length); where one has fewer corners, its last is repeated.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import basix
import numpy as np

from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised
from fenics_contact.contact.mortar.overlap import LEAST_SHARE, Overlap, Pieces, facing_pairs, pieces
from fenics_contact.contact.mortar.ray_projection import across, meet

_POINTS = 10_000  # quadrature points treated at a time: they stay in the processor's cache
# Common parts are cut into triangles from the corner that is furthest along this direction in
# space: a polygon's first corner depends, as the order of a facet's nodes, on the ranks.
_DIRECTION = np.array([1.0, 0.618, 0.387])


@dataclass(frozen=True, eq=False)
class _Planes:
    """A plane through the centre of each piece of the slave.

    Attributes:
        pieces: Of the slave.
        normals: The mean normals there, (pieces, 3).
        axes: Orthonormal vectors in the planes, (pieces, 3, 2).
        polygons: The pieces seen along the normals, counter-clockwise, (pieces, corners, 2)
            (length).
        areas: Of the polygons, (pieces,) (length²).
    """

    pieces: Pieces
    normals: Array
    axes: Array
    polygons: Array
    areas: Array


@dataclass(frozen=True, eq=False)
class _Triangles:
    """Triangles that fill what is common to pairs of pieces.

    Attributes:
        ours: Slave piece of every triangle, (triangles,).
        theirs: Master piece of every triangle, (triangles,).
        corners: In the plane of the slave piece, (triangles, 3, 2) (length).
    """

    ours: AnyIntegers
    theirs: AnyIntegers
    corners: Array

    def chunks(self, size: int) -> Iterator[_Triangles]:
        """Some triangles at a time."""
        for begin in range(0, len(self.ours), size):
            part = slice(begin, begin + size)
            yield _Triangles(self.ours[part], self.theirs[part], self.corners[part])


def polygon_overlaps(
    slave: FacetMesh, master: FacetMesh, mean_normals: Array, degree: int
) -> Iterator[Overlap]:
    """Where facets of the slave face those of the master, some cells at a time.

    Args:
        slave: Its facets are integrated over.
        master: The other surface.
        mean_normals: Directions of rays at the slave's nodes, (nodes, 3).
        degree: Of the quadrature on each common triangle.
    """
    planes, theirs = _planes(slave, mean_normals), pieces(master)
    ours = planes.pieces
    facet_areas = np.bincount(ours.facets, planes.areas, minlength=len(slave.nodes))
    points, weights = basix.make_quadrature(basix.CellType.triangle, degree)
    count = len(points)
    for cells in _common(planes, master, theirs).chunks(max(_POINTS // count, 1)):
        here, stretch = _on_slave(slave, planes, cells, points)
        facets, opposite = ours.facets[cells.ours], theirs.facets[cells.theirs]
        repeated = np.repeat(facets, count)
        # Along the mean normal of each point: along the plane's, the point that faces would
        # jump from piece to piece.
        there, met = meet(
            master,
            np.repeat(opposite, count),
            slave.positions(repeated, here),
            normalised(slave.interpolate(mean_normals, repeated, here)),
            np.repeat(theirs.reference[cells.theirs], count, axis=0),
        )
        areas = signed_areas(cells.corners)
        yield Overlap(
            facets,
            opposite,
            here.reshape(-1, count, 2),
            there.reshape(-1, count, 2),
            2 * areas[:, None] * weights * (stretch * met).reshape(-1, count),
            areas / facet_areas[facets],
        )


def _planes(slave: FacetMesh, mean_normals: Array) -> _Planes:
    ours = pieces(slave)
    normals = normalised(slave.interpolate(mean_normals, ours.facets, ours.reference))
    axes = across(normals)
    seen = (ours.corners - ours.centres[:, None]) @ axes
    polygons = counter_clockwise(seen)
    return _Planes(ours, normals, axes, polygons, signed_areas(polygons))


def _common(planes: _Planes, master: FacetMesh, theirs: Pieces) -> _Triangles:
    """Common parts of pieces of slave and master, seen along the mean normal."""
    ours = planes.pieces
    none = np.zeros(len(ours.facets))
    first, second = facing_pairs(ours, planes.normals, none, master, theirs)
    seen = (theirs.corners[second] - ours.centres[first, None]) @ planes.axes[first]
    common = clip(planes.polygons[first], counter_clockwise(seen))
    kept = signed_areas(common) > LEAST_SHARE * planes.areas[first]
    first, second = first[kept], second[kept]
    triangles = fan(common[kept], _DIRECTION @ planes.axes[first])
    areas = signed_areas(triangles.reshape(-1, 3, 2)).reshape(triangles.shape[:2])
    # Repeated corners make triangles without area.
    pair, number = np.nonzero(areas > LEAST_SHARE**2 * planes.areas[first, None])
    return _Triangles(first[pair], second[pair], triangles[pair, number])


def _on_slave(
    slave: FacetMesh, planes: _Planes, cells: _Triangles, points: Array
) -> tuple[Array, Array]:
    """The slave's true facets above or below points of triangles.

    Args:
        slave: The surface.
        planes: The planes of its pieces.
        cells: Triangles in these planes.
        points: On the reference triangle, (points, 2).

    Returns:
        Reference coordinates, (triangles × points, 2), and the facet's area per area of the
        plane, 0 where the facet was not met, (triangles × points,).
    """
    ours, corners, count = cells.ours, cells.corners, len(points)
    in_plane = corners[:, :1] + points @ (corners[:, 1:] - corners[:, :1])
    places = planes.pieces.centres[ours, None] + in_plane @ planes.axes[ours].transpose(0, 2, 1)
    facets = np.repeat(planes.pieces.facets[ours], count)
    normals = np.repeat(planes.normals[ours], count, axis=0)
    start = np.repeat(planes.pieces.reference[ours], count, axis=0)
    here, met = meet(slave, facets, places.reshape(-1, 3), normals, start)
    true = normalised(slave.area_normals(facets, here))
    slope = np.abs(np.einsum("pd,pd->p", true, normals))
    return here, met / slope


def signed_areas(polygons: Array) -> Array:
    """Areas, negative for polygons that run clockwise, (polygons,)."""
    x = polygons - polygons[:, :1]
    following = np.roll(x, -1, axis=1)
    return 0.5 * _cross(x, following).sum(axis=1)


def counter_clockwise(polygons: Array) -> Array:
    """The polygons, reversed where they run clockwise."""
    return np.where(signed_areas(polygons)[:, None, None] < 0, polygons[:, ::-1], polygons)


def clip(polygons: Array, windows: Array) -> Array:
    """Common parts of convex polygons and windows that run counter-clockwise.

    After Sutherland and Hodgman: the polygon is cut along each side of the window in turn.
    Parts that are empty have area 0.
    """
    for side in range(windows.shape[1]):
        begin, end = windows[:, side], windows[:, (side + 1) % windows.shape[1]]
        polygons = _cut(polygons, begin, end)
    return polygons


def fan(polygons: Array, directions: Array) -> Array:
    """Triangles from one corner of convex polygons, (polygons, corners − 2, 3, 2).

    Args:
        polygons: The polygons.
        directions: The corner is the furthest one along these, (polygons, 2).
    """
    first = np.argmax(np.einsum("pcd,pd->pc", polygons, directions), axis=1)
    turned = (first[:, None] + np.arange(polygons.shape[1])) % polygons.shape[1]
    polygons = np.take_along_axis(polygons, turned[:, :, None], axis=1)
    begin, end = polygons[:, 1:-1], polygons[:, 2:]
    return np.stack([np.broadcast_to(polygons[:, :1], begin.shape), begin, end], axis=2)


def _cut(polygons: Array, begin: Array, end: Array) -> Array:
    """The parts to the left of lines from begin to end, (polygons, 2) each."""
    count, corners = polygons.shape[:2]
    height = _cross((end - begin)[:, None], polygons - begin[:, None])
    following, height_following = np.roll(polygons, -1, axis=1), np.roll(height, -1, axis=1)
    stays = height >= 0
    crosses = stays != (height_following >= 0)
    share = height / np.where(crosses, height - height_following, 1.0)
    crossing = polygons + share[:, :, None] * (following - polygons)

    # Along each side: its first corner, then where it crosses the line.
    points = np.stack([polygons, crossing], axis=2).reshape(count, 2 * corners, 2)
    kept = np.stack([stays, crosses], axis=2).reshape(count, 2 * corners)
    # A line adds one corner to a convex polygon at most.
    order = np.argsort(~kept, axis=1, kind="stable")[:, : corners + 1]
    last = np.maximum(kept.sum(axis=1) - 1, 0)
    order = np.take_along_axis(order, np.minimum(np.arange(corners + 1), last[:, None]), axis=1)
    return np.take_along_axis(points, order[:, :, None], axis=1)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
