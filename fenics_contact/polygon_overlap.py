"""Where two contact surfaces face each other in space, after Puso and Laursen (2004).

Both are projected along the mean normal onto a plane through the centre of each piece of the
slave, and clipped there. https://doi.org/10.1016/j.cma.2003.10.010
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import basix
import numpy as np

from fenics_contact import clipping
from fenics_contact.facet_mesh import Array, BoolArray, FacetMesh, IntArray, normalised
from fenics_contact.facing import across, meet
from fenics_contact.overlap import LEAST_SHARE, Overlap, Pieces, facing_pairs, pieces

_POINTS = 50_000  # quadrature points treated at a time


@dataclass(frozen=True, eq=False)
class _Triangles:
    """Triangles that fill what is common to pairs of pieces.

    Attributes:
        ours: Slave piece of every triangle, (triangles,).
        theirs: Master piece of every triangle, (triangles,).
        corners: In the plane of the slave piece, (triangles, 3, 2) (length).
    """

    ours: IntArray
    theirs: IntArray
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
    ours, theirs = pieces(slave), pieces(master)
    normals = normalised(slave.interpolate(mean_normals, ours.facets, ours.reference))
    planes = across(normals)
    pairs = facing_pairs(
        ours,
        normals,
        np.zeros(len(normals)),
        theirs,
        master.area_normals(theirs.facets, theirs.reference),
    )
    own = clipping.counter_clockwise((ours.corners - ours.centres[:, None]) @ planes)
    own_areas = clipping.areas(own)
    facet_areas = np.bincount(ours.facets, own_areas, minlength=len(slave.nodes))
    points, weights = basix.make_quadrature(basix.CellType.triangle, degree)
    triangles = _common(ours, theirs, planes, own, pairs)
    for cells in triangles.chunks(max(_POINTS // len(points), 1)):
        corners = cells.corners
        in_plane = corners[:, :1] + points @ (corners[:, 1:] - corners[:, :1])
        depth = planes[cells.ours].transpose(0, 2, 1)
        places = (ours.centres[cells.ours, None] + in_plane @ depth).reshape(-1, 3)
        rays = np.repeat(normals[cells.ours], len(points), axis=0)
        here, on_slave = _traced(slave, ours, cells.ours, places, rays)
        there, on_master = _traced(master, theirs, cells.theirs, places, rays)
        facets = ours.facets[cells.ours]
        true = normalised(slave.area_normals(np.repeat(facets, len(points)), here))
        slope = np.abs(np.einsum("pd,pd->p", true, rays))
        factor = np.where(on_slave & on_master, 1 / slope, 0.0).reshape(-1, len(points))
        areas = clipping.areas(corners)
        yield Overlap(
            facets,
            theirs.facets[cells.theirs],
            here.reshape(-1, len(points), 2),
            there.reshape(-1, len(points), 2),
            2 * areas[:, None] * weights * factor,
            areas / facet_areas[facets],
        )


def _common(
    ours: Pieces, theirs: Pieces, planes: Array, own: Array, pairs: tuple[IntArray, IntArray]
) -> _Triangles:
    """What pairs of pieces have in common, seen along the normal of the slave's piece.

    Args:
        ours: The slave's pieces.
        theirs: The master's pieces.
        planes: Vectors along the plane of every slave piece, (slave pieces, 3, 2).
        own: The slave's pieces in their planes, counter-clockwise, (slave pieces, corners, 2).
        pairs: Slave pieces and master pieces, (pairs,) each.
    """
    first, second = pairs
    other = (theirs.corners[second] - ours.centres[first, None]) @ planes[first]
    common = clipping.clip(own[first], clipping.counter_clockwise(other))
    least = LEAST_SHARE * clipping.areas(own)[first]
    kept = clipping.areas(common) > least
    first, second, least = first[kept], second[kept], least[kept]
    triangles = clipping.fan(common[kept])
    areas = clipping.areas(triangles.reshape(-1, 3, 2)).reshape(triangles.shape[:2])
    # Repeated corners make triangles without area.
    pair, side = np.nonzero(areas > LEAST_SHARE * least[:, None])
    return _Triangles(first[pair], second[pair], triangles[pair, side])


def _traced(
    mesh: FacetMesh, parts: Pieces, chosen: IntArray, places: Array, rays: Array
) -> tuple[Array, BoolArray]:
    """Where rays from the points of cells meet the true facets behind the cells' pieces."""
    count = len(places) // len(chosen)
    start = np.repeat(parts.reference[chosen], count, axis=0)
    return meet(mesh, np.repeat(parts.facets[chosen], count), places, rays, start)
