"""Friction that falls with the speed: by its table, and bodies that stick and slip by turns."""

import dataclasses
import functools

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    Motion,
    Obstacle,
    Path,
    Run,
    Scene,
    SpeedDependentFriction,
    Support,
)
from fenics_contact.verification.published.impacts import along
from fenics_contact.verification.published.sliding import belt, period_on_belt
from tests.messages import refused
from tests.scenes import box_body

ALWAYS = Path(time=(0.0,), factor=(1.0,))
BELT = 5.0


def solved(scene, body):
    found = Run(scene, body=body).solve()
    assert found.passed, found.verdict
    return found


def rubbed_by_a_belt(dimension):
    """A stiff block, held all over but for the side that a moving belt is pressed on."""
    up = dimension - 1
    normal = np.eye(dimension)[up]
    axes = "xyz"[:dimension]
    return Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(1e6, 0.0, density=1e-3),
        discretisation=Discretisation(1),
        support=(Support(f"{axes[up]}1", dict.fromkeys(axes, 0)),),
        contact=(
            Contact(
                f"{axes[up]}0",
                friction_coefficient=0.4,
                law="incremental",
                friction_law=SpeedDependentFriction("speed dependent", (2, 10), (1, 0.5)),
                obstacle=Obstacle(
                    "plane",
                    position=tuple(0.0 * normal),
                    normal=tuple(normal),
                    indentation=1e-6,
                    path=ALWAYS,
                    displacement=(BELT, *(0.0 for _ in range(dimension - 1))),
                    displacement_path=Path(time=(0, 2), factor=(0, 2)),
                ),
            ),
        ),
        motion=Motion(step=0.01, end=0.04, start="static"),
    )


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_slides_carries_the_share_of_its_speed(dimension):
    """The belt slides at 5, between the speeds 2 and 10 of the table."""
    found = solved(rubbed_by_a_belt(dimension), box_body((3, 2, 2)[:dimension]))
    last = found.quantities
    share = np.interp(BELT, (2, 10), (1, 0.5))
    # Waves in the block move its side by up to τ/(ρ c), .003 of the belt's speed.
    assert last["friction_force"][0] == pytest.approx(0.4 * share * last["normal_force"], rel=3e-3)


@functools.cache
def on_belt():
    """A mass over some periods."""
    return solved(*belt(50, 2.8))


def test_a_mass_sticks_and_slips_by_turns():
    """As often as the formula says."""
    assert period_on_belt(on_belt()) == pytest.approx(1, abs=5e-3)


def test_it_rests_on_the_belt_in_between():
    """But for slip that goes back, at most ε, whatever the spring pulls."""
    found = on_belt()
    places = along(found, "displacement_mass")[:, 0]
    moved = np.abs(np.diff(places)) / np.ptp(places)
    rests = moved < 1e-4
    assert 0.3 < rests.mean() < 0.7


def test_another_fall_of_friction_has_another_period():
    """The comparison sees a coefficient that is 10 % off."""
    assert abs(period_on_belt(solved(*belt(50, 2.8, kinetic=0.6))) - 1) > 0.05


def test_without_motion_it_is_refused():
    scene = rubbed_by_a_belt(2)
    with refused("speed_dependent_friction_at_rest", ValueError):
        dataclasses.replace(scene, motion=None)
