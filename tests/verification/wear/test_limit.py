"""The case of the fretting limit can fail: judged at another circle that sticks it does."""

from types import SimpleNamespace

import numpy as np

from fenics_contact.analytic import contact as formulas
from fenics_contact.verification.published.cycle import compared, rubbed_scene
from fenics_contact.verification.published.shear import SPHERE


def cycle(force, share):
    """A cycle with the exact profile of .6 that sticks; its shear over μ times Hertz's force."""
    radius = np.linspace(0, 1.5, 40)
    points = np.column_stack([radius, 0 * radius, 0 * radius])
    return SimpleNamespace(
        contacts=[{"normal_force": force, "friction_force": (0.15 * share * SPHERE.force, 0, 0)}],
        points=SimpleNamespace(
            coordinates=points * SPHERE.radius,
            own={"worn_depth": formulas.worn_depth(radius, 0.6)},
        ),
    )


def test_another_circle_is_noticed():
    first = cycle(1.0, 1 - 0.7**3)
    force, of_punch = formulas.force_left(0.6), 1.5 * (1 - 0.7**2)
    right = list(compared(first, cycle(force, 0.6 * of_punch)))
    assert [found.passed for found in right] == [True] * 3
    wrong = list(compared(first, cycle(force, 0.7 * of_punch)))
    assert [found.passed for found in wrong] == [True, False, False]


def test_height_stays():
    obstacle = rubbed_scene(0.7).contact[0].obstacle
    assert obstacle.force is None
    assert obstacle.indentation == SPHERE.radius**2 / obstacle.radius
