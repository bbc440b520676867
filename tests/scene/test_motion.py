"""What has no meaning where bodies move is refused in one sentence."""

import dataclasses

import pytest

from fenics_contact import (
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
        ({"steps": Steps(number=3)}, "have no steps"),
        ({"load": (Load("body", body_force=(0.0, -1.0)),)}, "load\\[0\\].path is missing"),
        (
            {"contact": (Contact("y0", obstacle=PLANE, friction_coefficient=0.3),)},
            "only Coulomb's friction of law = 'incremental', or with",
        ),
        (
            {"contact": (Contact("y0", normal_law=BY_FORMULA, obstacle=PLANE),)},
            "only contacts that are prescribed, unilateral",
        ),
        (
            {"contact": (Contact("y0", obstacle=Obstacle("plane", normal=(0.0, 1.0), force=3)),)},
            "an obstacle has no mass",
        ),
        (
            {"motion": Motion(step=0.1, end=1.0, velocity={"body": (1.0, 0.0, 0.0)})},
            "has 3 entries",
        ),
    ],
)
def test_what_cannot_be_had_is_said(change, words):
    with pytest.raises(SceneError, match=words):
        dataclasses.replace(MOVING, **change)


def test_what_always_acts_is_taken():
    always = Load("body", body_force=(0.0, -1.0), path=Path(time=(0.0,), factor=(1.0,)))
    assert dataclasses.replace(MOVING, load=(always,)).load_steps.number == 10


def test_a_step_is_not_longer_than_all():
    with pytest.raises(SceneError, match="must not exceed"):
        Motion(step=2.0, end=1.0)
