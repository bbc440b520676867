"""Points that stick at whatever pressure: Newton's method on the whole is given up for a loop."""

import dataclasses

import pytest

from fenics_contact import Obstacle, SolverSettings, Steps, run
from fenics_contact.verification.published.indenters import half_space_scene

STEPS, MOST = 5, 40


def pressed(coefficient, strategy):
    """A paraboloid on a half-space, pressed in several steps under a large coefficient."""
    scene = half_space_scene(Obstacle("paraboloid", radius=8.0, indentation=1.0))
    rough = dataclasses.replace(scene.contact[0], friction_coefficient=coefficient)
    solver = SolverSettings(strategy=strategy, errors="none")
    return run(dataclasses.replace(scene, contact=(rough,), steps=Steps(STEPS), solver=solver))


def test_a_surface_that_sticks_takes_few_newton_steps():
    """Up to 250 a load step before; the loop that has no such steps finds the same."""
    found, other = (pressed(1e4, way) for way in ("auto", "lagged"))
    assert max(step["newton_iterations"] for step in found.steps) <= MOST
    for name in ("normal_force", "max_contact_pressure", "strain_energy"):
        assert found.quantities[name] == pytest.approx(other.quantities[name], rel=1e-5)
    assert found.quantities["stick_area"] == found.quantities["contact_area"]
