"""Where contact surfaces face each other: points of quadrature in common, and overlaps in 2D.

In the plane, rays along the interpolated mean normal of the slave join the surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import basix
import numpy as np

from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised, reference_nodes
from fenics_contact.contact.mortar.ray_projection import entries_behind, hits, meet, near_lines

# Corners of the straight pieces of a facet, in turn, among its geometry nodes. Curved segments
# need none: their ends are projected onto the true facet.
_PIECES = {
    ("interval", 1): [[0, 1]],
    ("interval", 2): [[0, 1]],
    ("triangle", 1): [[0, 1, 2]],
    ("triangle", 2): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    ("quadrilateral", 1): [[0, 1, 3, 2]],
    ("quadrilateral", 2): [[0, 4, 8, 5], [4, 1, 6, 8], [5, 8, 7, 2], [8, 6, 3, 7]],
}
LEAST_SHARE = 1e-9  # of a facet's area: smaller overlaps are round-off
_MARGIN = 1.1  # of the radii of straight pieces, for curved ones
_SAME_LAYER = 1e-6  # of a facet's radius: by how much a nearer point is another one


@dataclass(frozen=True, eq=False)
class Overlap:
    """Quadrature points on segments or triangles ("cells") common to both surfaces.

    Attributes:
        slave: Slave facet of every cell, (cells,).
        master: Master facet of every cell, (cells,).
        slave_reference: Points on the slave facet, (cells, points, dimension − 1).
        master_reference: The points that face them, (cells, points, dimension − 1).
        weights: Of the integral over the slave's surface, (cells, points) (length^(dimension − 1)).
        shares: Of the slave facet's area, (cells,).
    """

    slave: AnyIntegers
    master: AnyIntegers
    slave_reference: Array
    master_reference: Array
    weights: Array
    shares: Array

    def without(self, facets: Flags) -> Overlap:
        """Cells on other facets of the slave than these.

        Args:
            facets: Which facets of the slave are left out, (slave facets,).
        """
        kept = ~facets[self.slave]
        return Overlap(*(getattr(self, each.name)[kept] for each in fields(self)))


def nearest_layer(
    overlap: Overlap, slave: FacetMesh, master: FacetMesh, mean_normals: Array, layered: Flags
) -> Overlap:
    """An overlap without points of the master that are behind others of it, seen from the slave.

    Args:
        overlap: Where both face each other.
        slave: The surface that is integrated over.
        master: The other surface.
        mean_normals: Directions of rays at the slave's nodes, (nodes, dimension).
        layered: Facets of the slave of which some part faces several layers, (slave facets,).
    """
    cells = np.flatnonzero(layered[overlap.slave])
    if len(cells) == 0:
        return overlap
    count, size = overlap.weights.shape[1], slave.dimension - 1
    ours, theirs = (np.repeat(of[cells], count) for of in (overlap.slave, overlap.master))
    here = overlap.slave_reference[cells].reshape(-1, size)
    there = overlap.master_reference[cells].reshape(-1, size)
    rays = normalised(slave.interpolate(mean_normals, ours, here))
    places = slave.positions(ours, here)
    reach = np.abs(np.einsum("pd,pd->p", master.positions(theirs, there) - places, rays))
    nearest = np.abs(hits(master, places, rays).distance)
    seen = (reach <= nearest + _SAME_LAYER * master.radii[theirs]).reshape(-1, count)
    weights, shares = overlap.weights.copy(), overlap.shares.copy()
    whole = weights[cells].sum(axis=1)
    weights[cells] = np.where(seen, weights[cells], 0.0)
    shares[cells] *= weights[cells].sum(axis=1) / np.where(whole > 0, whole, 1.0)
    return replace(overlap, weights=weights, shares=shares)


@dataclass(frozen=True, eq=False)
class Pieces:
    """Straight pieces of facets: all of a segment, a whole flat facet, quarters of curved ones.

    Attributes:
        facets: Facet of every piece, (pieces,).
        reference: The piece's centre on it, (pieces, dimension − 1).
        corners: In turn, (pieces, corners, dimension) (length).
        centres: Mean of the corners, (pieces, dimension) (length).
        radii: Of spheres about the centres, (pieces,) (length).
    """

    facets: AnyIntegers
    reference: Array
    corners: Array
    centres: Array
    radii: Array


def pieces(mesh: FacetMesh) -> Pieces:
    """The pieces of all facets, in the order of the facets."""
    table = np.array(_PIECES[mesh.shape, mesh.order])
    count = len(mesh.nodes)
    corners = mesh.geometry[:, table].reshape(-1, table.shape[1], mesh.dimension)
    reference = reference_nodes(mesh.shape, mesh.order)[table].mean(axis=1)
    centres = corners.mean(axis=1)
    return Pieces(
        np.repeat(np.arange(count), len(table)),
        np.tile(reference, (count, 1)),
        corners,
        centres,
        _MARGIN * np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1, initial=0),
    )


def facing_pairs(
    slave: Pieces, directions: Array, spreads: Array, surface: FacetMesh, master: Pieces
) -> tuple[AnyIntegers, AnyIntegers]:
    """Pairs (slave piece, master piece) that may face each other, of several layers the nearest.

    Args:
        slave: Pieces from whose centres the rays begin.
        directions: Mean normals there, (slave pieces, dimension).
        spreads: How much the mean normal differs within each piece, (slave pieces,).
        surface: The other surface.
        master: Its pieces.
    """
    found = near_lines(
        slave.centres, directions, slave.radii, spreads, master.centres, master.radii
    )
    tables = list(found)
    first = np.concatenate([table[0] for table in tables])
    second = np.concatenate([table[1] for table in tables])
    outward = surface.area_normals(master.facets, master.reference)
    opposed = np.einsum("pd,pd->p", directions[first], outward[second]) < 0
    first, second = first[opposed], second[opposed]
    reach = master.centres[second] - slave.centres[first]
    along = np.einsum("pd,pd->p", reach, directions[first])
    size = 2 * (slave.radii[first] + master.radii[second])
    far_behind = along < -size
    if far_behind.any():
        lines = np.unique(first[far_behind])
        reaches = np.full(len(slave.centres), np.inf)
        reaches[lines] = entries_behind(surface, slave.centres[lines], directions[lines])
        kept = ~far_behind | (-along < reaches[first])
        first, second, along, size = first[kept], second[kept], along[kept], size[kept]
    distance = np.abs(along)
    least = np.full(len(slave.centres), np.inf)
    np.minimum.at(least, first, distance)
    near = distance <= least[first] + size
    return first[near], second[near]


_NEWTON_STEPS = 20
_CONVERGED = 1e-8  # reference coordinates; the next step would be its square


def segment_overlap(
    slave: FacetMesh, master: FacetMesh, mean_normals: Array, degree: int
) -> Overlap:
    """Where segments of the slave face those of the master.

    Args:
        slave: Its facets are integrated over.
        master: The other surface.
        mean_normals: Directions of rays at the slave's nodes, (nodes, 2).
        degree: Of the quadrature on each common segment.
    """
    facets, opposite, low, high = _common(slave, master, mean_normals)
    points, weights = basix.make_quadrature(basix.CellType.interval, degree)
    count = len(points)
    reference = (low[:, None] + (high - low)[:, None] * points[:, 0]).reshape(-1, 1)
    repeated = np.repeat(facets, count)
    rays = normalised(slave.interpolate(mean_normals, repeated, reference))
    places = slave.positions(repeated, reference)
    there, met = meet(master, np.repeat(opposite, count), places, rays)
    lengths = np.linalg.norm(slave.area_normals(repeated, reference), axis=1)
    measure = ((high - low)[:, None] * weights) * (lengths * met).reshape(-1, count)
    return Overlap(
        facets,
        opposite,
        reference.reshape(-1, count, 1),
        there.reshape(-1, count, 1),
        measure,
        measure.sum(axis=1) / _facet_lengths(slave, points, weights)[facets],
    )


def _common(
    slave: FacetMesh, master: FacetMesh, mean_normals: Array
) -> tuple[AnyIntegers, AnyIntegers, Array, Array]:
    """Pairs (slave facet, master facet), and from where to where on the slave they face."""
    ours, theirs = pieces(slave), pieces(master)
    directions = normalised(slave.interpolate(mean_normals, ours.facets, ours.reference))
    spreads = np.linalg.norm(mean_normals[slave.nodes] - directions[:, None], axis=2)
    facets, opposite = facing_pairs(
        ours, directions, spreads.max(axis=1, initial=0), master, theirs
    )
    ends = [
        _ray_origins(slave, facets, mean_normals, theirs.corners[opposite, end]) for end in range(2)
    ]
    low, high = np.sort(np.clip(ends, 0.0, 1.0), axis=0)
    kept = high - low > LEAST_SHARE
    return facets[kept], opposite[kept], low[kept], high[kept]


def _facet_lengths(mesh: FacetMesh, points: Array, weights: Array) -> Array:
    """Lengths of all facets by a quadrature rule, (facets,)."""
    facets = np.repeat(np.arange(len(mesh.nodes)), len(points))
    normals = mesh.area_normals(facets, np.tile(points, (len(mesh.nodes), 1)))
    return np.asarray(np.linalg.norm(normals, axis=1).reshape(-1, len(points)) @ weights)


def _ray_origins(
    slave: FacetMesh, facets: AnyIntegers, mean_normals: Array, points: Array
) -> Array:
    """Reference coordinates of where the slave's rays through points begin, (points,).

    Beyond −1 and 2 only the side is right.
    """
    reference = np.full((len(points), 1), 0.5)
    nodal = mean_normals[slave.nodes[facets]]
    for _ in range(_NEWTON_STEPS):
        reach = points - slave.positions(facets, reference)
        tangents = slave.tangents(facets, reference)[:, :, 0]
        normals = np.einsum("pn,pnd->pd", slave.shape_functions(reference), nodal)
        turning = np.einsum("pn,pnd->pd", slave.shape_gradients(reference)[0], nodal)
        slope = _cross(reach, turning) - _cross(tangents, normals)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.nan_to_num(_cross(reach, normals) / slope)
        before = reference
        reference = np.clip(reference - step[:, None], -1.0, 2.0)
        if np.abs(reference - before).max(initial=0) <= _CONVERGED:
            break
    return reference[:, 0]


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
