"""The limit of fretting by the reduction to one dimension, integrated as numbers."""

import numpy as np
import pytest
from scipy.integrate import quad

from fenics_contact.analytic import contact as formulas


def reduced(x, stick):
    """The rigid profile in one dimension; depth and radius are 1, so that R is 1."""
    return x**2 if x < stick else 1.0


def in_space(radius, stick):
    """The rigid profile at a radius, with x = r sin(t), which takes the root at x = r away."""
    edge = np.arcsin(stick / radius)
    found, _ = quad(lambda t: reduced(radius * np.sin(t), stick), 0, np.pi / 2, points=[edge])
    return 2 / np.pi * found


@pytest.mark.parametrize("stick", [0.5, 0.7, 0.9])
def test_force_is_that_of_springs(stick):
    worn, _ = quad(lambda x: 1 - reduced(x, stick), 0, 1, points=[stick])
    whole, _ = quad(lambda x: 1 - x**2, 0, 1)
    assert formulas.force_left(stick) == pytest.approx(worn / whole, rel=1e-10)


@pytest.mark.parametrize("stick", [0.5, 0.7, 0.9])
def test_depth_is_by_the_profile_in_space(stick):
    for r in (0.5 * (stick + 1), 1.0, formulas.worn_radius(stick) - 1e-3):
        expected = in_space(r, stick) - r**2 / 2
        found = formulas.worn_depth(np.array([r]), stick)
        assert found == pytest.approx(expected, rel=1e-6)
        assert expected > 0


@pytest.mark.parametrize(("stick", "radius"), [(0.5, 1.2298), (0.7, 1.1429), (0.9, 1.0492)])
def test_wear_ends_at_the_radius(stick, radius):
    assert formulas.worn_radius(stick) == pytest.approx(radius, abs=1e-4)
    inside_and_beyond = np.array([0.5 * stick, radius + 1e-3])
    assert (formulas.worn_depth(inside_and_beyond, stick) == 0).all()
