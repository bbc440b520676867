"""A quantity that a file registers brings its gradient, too."""

import math

import pytest

from fenics_contact import Study, load_scene, run
from fenics_contact.simulation.sensitivities import gradients
from tests.messages import refused
from tests.quantities import weighted_pressure
from tests.quantities.test_extension import DEPTH, E_STAR, RADIUS, scene
from tests.quantities.weighted_pressure import NAME

assert scene  # a fixture
pytestmark = [pytest.mark.serial, pytest.mark.errors]
QUIET = '[solver]\nerrors = "none"'


@pytest.fixture(autouse=True)
def registered():
    weighted_pressure.register()
    yield
    weighted_pressure.unregister()


def value(path, depth):
    return run(load_scene(path, [f"{DEPTH}={depth!r}"])).quantities[NAME]


def test_its_value_is_that_of_hertz(scene):
    """8/3π of the largest pressure √(P E*/πR) of a cylinder: Johnson 1985, equation 4.45."""
    found = run(load_scene(scene(QUIET, cells=64))).quantities
    peak = math.sqrt(found["normal_force"] * E_STAR / (math.pi * RADIUS))
    assert found[NAME] == pytest.approx(8 / (3 * math.pi) * peak, rel=0.06)  # a block is stiffer


def test_its_derivative_is_the_difference_quotient(scene):
    path = scene(QUIET)
    found = Study(load_scene(path)).derivatives([NAME], [DEPTH, "material.youngs_modulus"])[NAME]
    by_depth = (value(path, 0.0201) - value(path, 0.0199)) / 0.0002
    assert found[DEPTH] == pytest.approx(by_depth, rel=2e-3)
    # Depths are given: all stresses are in proportion to the modulus.
    by_modulus = value(path, 0.02) / 1000
    assert found["material.youngs_modulus"] == pytest.approx(by_modulus, rel=1e-3)


def test_a_scene_asks_for_it_and_its_mesh_is_refined_for_it(scene):
    asked = f'[derivatives]\nof = ["{NAME}"]\nby = ["{DEPTH}"]\n[accuracy]\n{NAME} = 0.02'
    found = run(load_scene(scene(asked, cells=8)))
    slope = found.derivatives[NAME][DEPTH]
    assert slope.discrete > 0 and found.exit_code == 0 and len(found.levels) > 1
    assert found.errors[NAME]["total"] <= 0.02 * found.quantities[NAME]


def test_without_its_gradient_it_is_refused_in_one_sentence(scene):
    gradients.unregister(NAME)
    try:
        with refused("weighted_pressure_has_no_derivatives"):
            Study(load_scene(scene(QUIET))).derivatives([NAME], [DEPTH])
    finally:
        gradients.register(NAME, weighted_pressure.gradient)


def test_a_gradient_is_given_once():
    with refused("gradient_is_there_already", ValueError):
        gradients.register(NAME, weighted_pressure.gradient)
