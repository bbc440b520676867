"""Where two contact surfaces face each other in the plane.

Rays along the interpolated mean normal of the slave join the surfaces.
"""

from __future__ import annotations

import basix
import numpy as np

from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised
from fenics_contact.contact.mortar.overlap import LEAST_SHARE, Overlap, facing_pairs, pieces
from fenics_contact.contact.mortar.ray_projection import meet

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
