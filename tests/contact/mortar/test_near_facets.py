"""Facets near many lines, chosen by blocks of lines: the same as all facets against all lines."""

import numpy as np
import pytest

from fenics_contact.contact.facet_obstacle import FacetObstacle
from fenics_contact.contact.mortar import ray_projection
from fenics_contact.mesh.rigid_surface import RigidSurface

SIDES = 24  # of a wavy sheet of triangles


@pytest.fixture
def sheet():
    places = np.linspace(-1, 1, SIDES + 1)
    x, y = (part.ravel() for part in np.meshgrid(places, places, indexing="ij"))
    points = np.stack([x, y, 0.1 * np.sin(4 * x) * np.cos(3 * y)], axis=1)
    corner = (np.arange(SIDES)[:, None] * (SIDES + 1) + np.arange(SIDES)).ravel()
    near, far = corner + 1, corner + SIDES + 1
    triangles = np.concatenate(
        [np.stack([corner, far, near], axis=1), np.stack([near, far, far + 1], axis=1)]
    )
    return FacetObstacle(RigidSurface(points, triangles))._facets


@pytest.mark.parametrize("slant", [0.0, 0.3, 10.0])
def test_blocks_of_lines_find_the_same_facets(sheet, slant, monkeypatch):
    random = np.random.default_rng(3)
    points = random.uniform(-1, 1, (400, 3))
    directions = np.array([0, 0, 1.0]) + slant * random.normal(size=(400, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    whole = ray_projection._near_facets(sheet, points, directions)
    monkeypatch.setattr(ray_projection, "_TABLE", 2**14)  # fewer pairs than there are
    blocks = ray_projection._near_facets(sheet, points, directions)
    assert len(whole[0]) > 400
    if slant < 1:  # those of other blocks are passed over
        seen = ray_projection._seen_from(points[:1], directions[:1], sheet.centres, sheet.radii)
        assert len(seen) < len(sheet.radii) / 10
    for one, other in zip(whole, blocks, strict=True):
        np.testing.assert_array_equal(one, other)
