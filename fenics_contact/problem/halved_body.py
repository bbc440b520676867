"""A body in cells of half the size, new corners on the curves that its sides stand for."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.mortar.facet_mesh import normalised, reference_nodes
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface
from fenics_contact.mesh.refinement import halved
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.curved_sides import exterior_pairs, gathered_facets

# Of the body's extent: places that are the same but for round-off.
_SAME = 1e-9
# Square of the sine of an angle between two sides, below which they are of one curve.
_TURN = 0.1


def halved_body(spaces: Spaces) -> Body:
    """All edges of its cells halved; collective.

    Without the curves it would be the same polygon, and a ball would never get its weight.

    Args:
        spaces: Those of a body of cells of order 1.
    """
    finer = halved(spaces.body)
    places, moves = _onto_curves(spaces)
    nodes = finer.mesh.geometry.x
    size = spaces.components
    distance, nearest = cKDTree(places).query(nodes[:, :size])
    known = distance <= _SAME * np.ptp(places, axis=0).max()
    nodes[known, :size] += moves[nearest[known]]
    return finer


def _onto_curves(spaces: Spaces) -> tuple[Array, Array]:
    """Middles of all sides and of their edges, and the way from there to the curve; collective."""
    facets, _ = gathered_facets(spaces, exterior_pairs(spaces))
    corners = len(reference_nodes(facets.shape, 1))
    middles = reference_nodes(facets.shape, 2)[corners:]
    number = np.repeat(np.arange(len(facets.geometry)), len(middles))
    reference = np.tile(middles, (len(facets.geometry), 1))
    places = facets.positions(number, reference)
    offsets = SmoothSurface(facets).offsets(number, reference)
    normals = normalised(facets.normals_at_centres())[number]
    rounded = np.round(places / (_SAME * np.ptp(places, axis=0).max()))
    _, first, same = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return places[first], _common(same.reshape(-1), normals, offsets)


def _common(same: Integers, normals: Array, offsets: Array) -> Array:
    """Ways that lead onto all curves of which places are known from several sides.

    Args:
        same: Number of each place, (sides,).
        normals: There, (sides, components).
        offsets: Along them, (sides,).

    Returns:
        m by least squares of n · m − d, (places, components).
    """
    count, size = same.max() + 1, normals.shape[1]
    squares, right = np.zeros((count, size, size)), np.zeros((count, size))
    np.add.at(squares, same, normals[:, :, None] * normals[:, None, :])
    np.add.at(right, same, normals * offsets[:, None])
    return np.asarray(np.einsum("pij,pj->pi", np.linalg.pinv(squares, rcond=_TURN), right))
