"""A quantity with its gradient, for optimisers; and Taylor's test of the gradient."""

import numpy as np
import pytest

from fenics_contact import Study
from tests.messages import refused
from tests.scenes import box_body
from tests.simulation.studies.cases import BALL, DEPTH, MU, ON_A_FLOOR, square

DOWN, PULL = "support.0.displacement.y", "load.0.traction.0"


def remainders(study, of, keys, start, direction, steps):
    """What the value along a direction is beside the tangent, at each step."""
    objective = study.objective(of, keys)
    value, gradient = objective(start)
    assert objective.evaluations == 1
    slope = float(gradient @ direction)
    return [abs(objective(start + h * direction)[0] - value - h * slope) for h in steps], slope


@pytest.mark.parametrize(
    ("scene", "make", "of", "keys", "start", "direction"),
    [
        (ON_A_FLOOR, square, "strain_energy", (MU, DOWN, PULL), (0.3, -2e-3, 1.0), (0.1, 1e-3, 1)),
        (
            BALL,
            lambda: box_body((6, 6), (1, 1)),
            "normal_force",
            (MU, DEPTH),
            (0.4, 0.02),
            (1, 0.1),
        ),
    ],
)
def test_what_is_beside_the_tangent_is_of_second_order(scene, make, of, keys, start, direction):
    """Taylor: with half of the step it is a quarter, as long as no point changes its status."""
    given = {"contact.0.penalty_parameter": 1e-6, "contact.0.regularisation_parameter": 1e-6}
    study = Study(scene, body=make())
    study.scene = study.changed(given)
    direction = np.array(direction)
    steps = 2e-3 * 0.5 ** np.arange(4)
    found, slope = remainders(study, of, keys, np.array(start), direction, steps)
    orders = np.log2(np.array(found[:-1]) / found[1:])
    assert orders == pytest.approx(2.0, abs=0.1)
    assert found[0] < 0.05 * abs(slope) * steps[0]


def test_as_many_numbers_as_keys():
    objective = Study(ON_A_FLOOR, body=square()).objective("normal_force", [MU, DOWN])
    with refused("objective_of_another_length"):
        objective(0.3)


def test_what_else_is_changed_is_changed_in_all_answers():
    study = Study(ON_A_FLOOR, body=square())
    value, gradient = study.objective("normal_force", [DOWN], {MU: 0.0})([-2e-3])
    assert value == pytest.approx(study.quantities({MU: 0.0}).quantities["normal_force"], rel=1e-9)
    # Without friction, and with all of the floor pressed, the force is in proportion.
    assert gradient.shape == (1,) and gradient[0] < 0
