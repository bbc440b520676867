"""What has no meaning where bodies move is refused in one sentence."""

import dataclasses

import pytest

from fenics_contact import (
    Accuracy,
    Contact,
    Load,
    Material,
    Motion,
    Obstacle,
    Path,
    PressureFormula,
    Scene,
    Steps,
)
from fenics_contact.common.errors import SceneError
from tests.messages import refused

MOVING = Scene(
    kinematics="plane strain",
    material=Material(1000, 0.3, density=1.0),
    motion=Motion(step=0.1, end=1.0, velocity={"body": (1.0, 0.0)}),
)
BY_FORMULA = PressureFormula(kind="formula", pressure="c * d^1.5", parameters={"c": 2e4})
PLANE = Obstacle("plane", position=(0.0, 0.0), normal=(0.0, 1.0))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"steps": Steps(number=3)}, "motion_with_steps"),
        ({"accuracy": Accuracy(main=1e-2)}, "motion_with_accuracy"),
        ({"load": (Load("body", body_force=(0.0, -1.0)),)}, "motion_without_path_of_load"),
        ({"contact": (Contact("y0", obstacle=PLANE, friction_coefficient=0.3),)}, "no_velocities"),
        ({"contact": (Contact("y0", normal_law=BY_FORMULA, obstacle=PLANE),)}, "motion_of_formula"),
        (
            {"contact": (Contact("y0", obstacle=Obstacle("plane", normal=(0.0, 1.0), force=3)),)},
            "motion_with_obstacle_force",
        ),
        (
            {"motion": Motion(step=0.1, end=1.0, velocity={"body": (1.0, 0.0, 0.0)})},
            "velocity_in_3d",
        ),
    ],
)
def test_what_cannot_be_had_is_said(change, words):
    with refused(words, SceneError):
        dataclasses.replace(MOVING, **change)


def test_what_always_acts_is_taken():
    always = Load("body", body_force=(0.0, -1.0), path=Path(time=(0.0,), factor=(1.0,)))
    assert dataclasses.replace(MOVING, load=(always,)).load_steps.number == 10


def test_a_step_is_not_longer_than_all():
    with refused("motion_step_exceeds_end", SceneError):
        Motion(step=2.0, end=1.0)
