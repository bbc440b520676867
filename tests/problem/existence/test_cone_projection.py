"""The projection onto a cone, against SciPy's least squares with bounds."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from fenics_contact.problem.existence.friction_cones import Ray, separation, separation_from


@pytest.mark.parametrize("seed", range(20))
def test_distance_from_a_cone_of_many_rays(seed):
    random = np.random.default_rng(seed)
    unknowns = int(random.integers(2, 13))
    rays = random.normal(size=(int(random.integers(1, 60)), unknowns))
    rays[:, 0] = np.abs(rays[:, 0]) + 0.3
    load = random.normal(size=unknowns)
    # Not ``nnls``: that of SciPy 1.15 stops at amounts that are not the best ones.
    amounts = lsq_linear(rays.T, load, bounds=(0, np.inf), method="bvls", tol=1e-14).x
    distance = np.linalg.norm(load - amounts @ rays)
    motion = separation_from(rays, load, 0.0)
    if distance < 1e-9:
        assert motion is None
        return
    assert motion is not None
    assert (rays @ motion).max() <= 1e-10
    assert load @ motion == pytest.approx(distance, rel=1e-9)
    assert motion * distance == pytest.approx(load - amounts @ rays, abs=1e-7)


def test_a_round_cone_and_a_load_just_outside():
    """|t| ≤ z: a load at an angle 45° + δ from its axis lies sin δ away."""

    def farthest(direction):
        along = direction[:2] / (np.linalg.norm(direction[:2]) or 1.0)
        return Ray(np.append(along, 1.0), None)

    for angle in (1e-1, 1e-4, 1e-8):
        aside, up = np.sin(np.pi / 4 + angle), np.cos(np.pi / 4 + angle)
        load = 7 * np.array([0.6 * aside, 0.8 * aside, up])
        found = separation(load, farthest)
        assert found.distance == pytest.approx(7 * np.sin(angle), rel=1e-6)
        assert found.motion == pytest.approx(np.sqrt(0.5) * np.array([0.6, 0.8, -1.0]), abs=1e-6)
        inside = load * np.array([1, 1, 1 + 4 * angle])
        assert separation(inside, farthest) is None


def test_rays_that_are_opposite_but_for_round_off_hold_nothing_across():
    rays = np.array([[1.0, 0.0], [-1.0, 1e-16]])
    assert separation_from(rays, np.array([3.0, 1.0]), 1.0) == pytest.approx([0.0, 1.0])
    assert separation_from(rays, np.array([3.0, 0.0]), 1.0) is None


def test_without_rays_every_load_is_outside():
    load = np.array([0.0, -2.0])
    assert separation_from(np.zeros((3, 2)), load, 1.0) == pytest.approx([0.0, -1.0])
    assert separation_from(np.zeros((0, 2)), 0 * load, 1.0) is None
