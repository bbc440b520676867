"""What stands behind a point on the far side of a ring is no overlap."""

import numpy as np
import pytest

from fenics_contact.contact.mortar.facet_mesh import FacetMesh
from fenics_contact.contact.mortar.projection import integrate
from fenics_contact.contact.mortar.ray_projection import entries_behind, hits


def circle(radius, middle=(0.0, 0.0), count=24):
    """Straight facets along a circle of a body inside."""
    angles = 2 * np.pi * np.arange(count) / count
    normals = np.column_stack([np.sin(angles), np.cos(angles)])
    nodes = np.column_stack([np.arange(count), (np.arange(count) + 1) % count])
    positions = np.array(middle) + radius * normals
    return FacetMesh("interval", 1, 1, positions[nodes], nodes, normals)


@pytest.fixture(scope="module")
def ring():
    return circle(1.0)


def test_a_roller_does_not_reach_the_far_side_of_its_ring(ring):
    # On top of the ring: behind the roller's own top stands the ring's bottom, 2.5 below.
    top, up = np.array([[0.0, 1.5]]), np.array([[0.0, 1.0]])
    found = hits(ring, top, up)
    assert found.facet[0] == -1
    assert entries_behind(ring, top, up)[0] == pytest.approx(0.5)


def test_an_overlap_that_is_deeper_than_its_facets_is_seen(ring):
    # Facets of .26 and an overlap of .9.
    lowest, down = np.array([[0.0, 0.1]]), np.array([[0.0, -1.0]])
    found = hits(ring, lowest, down)
    assert found.distance[0] == pytest.approx(-0.9)
    assert np.isinf(entries_behind(ring, lowest, down)[0])


def test_only_what_stands_beside_is_joined(ring):
    roller = circle(0.25, (0.0, 1.25))
    integrals = integrate(roller, ring, roller.normals, False)
    upper = roller.normals[:, 1] > 0.8
    assert integrals.mass.diagonal()[upper].max() == 0
    assert integrals.mass.sum() > 0


def test_a_point_on_a_side_of_the_master_may_still_overlap():
    """A line that begins on a facet along which it hardly goes does not enter there."""
    places = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    nodes = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    outward = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) / np.sqrt(2)
    square = FacetMesh("interval", 1, 1, places[nodes], nodes, outward)
    # Down and outward: behind lie the side, at the point itself, and the top at .1.
    point, direction = np.array([[1.0, 0.9]]), np.array([[0.01, -1.0]])
    found = hits(square, point, direction / np.linalg.norm(direction))
    assert found.facet[0] == 2
    assert found.distance[0] == pytest.approx(-0.1, rel=1e-3)
