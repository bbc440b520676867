"""Surfaces that give way by a power of the depth, under a block that hits them."""

import functools

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    Motion,
    NormalCompliance,
    Obstacle,
    Point,
    Run,
    Scene,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.impacts import along

COEFFICIENT, POWER, SPEED = 4e3, 2, 0.5
# Where ½ m v² = A c d³/3, of a block of mass and area 1.
DEPTH = (1.5 * SPEED**2 / COEFFICIENT) ** (1 / 3)


@functools.cache
def hit(steps):
    """A stiff block, which comes back within .3."""
    law = NormalCompliance("normal compliance", COEFFICIENT, POWER)
    plane = Obstacle("plane", position=(0.0, 0.0), normal=(0.0, 1.0))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e7, 0.0, density=1.0),
        discretisation=Discretisation(1),
        support=(Support("block", {"x": 0}),),
        contact=(Contact("block.y0", normal_law=law, obstacle=plane),),
        point=(Point(name="top", at=(0.5, 1.0)),),
        motion=Motion(step=0.3 / steps, end=0.3, velocity={"block": (0.0, -SPEED)}),
    )
    found = Run(scene, body=boxes((Box("block", (0, 0), (1, 1), (2, 2)),))).solve()
    assert found.passed, found.verdict
    return found


@pytest.mark.parametrize(("steps", "allowed"), [(50, 3e-3), (200, 2e-4)])
def test_depth_and_force_of_a_block_that_hits_rough_ground(steps, allowed):
    """The largest of steps is below the largest of times by their second order, too."""
    found = hit(steps)
    deepest = -along(found, "displacement_top")[:, 1].min()
    assert deepest == pytest.approx(DEPTH, rel=allowed)
    force = along(found, "normal_force").max()
    assert force == pytest.approx(COEFFICIENT * DEPTH**POWER, rel=allowed)
    assert along(found, "kinetic_energy")[-1] == pytest.approx(0.5 * SPEED**2, rel=1e-5)


def test_what_steps_leave_open_falls_with_their_square():
    left = [np.abs(along(hit(steps), "energy_defect")).max() for steps in (50, 200)]
    assert left[0] / left[1] == pytest.approx(16, rel=0.3)
