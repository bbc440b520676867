"""Impacts at corners, bodies that collide and slide or that rock, and steps that are too long."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Motion,
    Obstacle,
    Path,
    Run,
    Scene,
)
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.hard.scenes import box
from fenics_contact.verification.published.impacts import along, worst_defect

MATERIAL = (Material(1000.0, 0.3, density=1.0),)
FLOOR = Obstacle("plane", position=(0.0, 0.0), normal=(0.0, 1.0))
ROUGH = {"friction_coefficient": 0.3, "law": "incremental"}


def solved(scene, body):
    return Run(scene, body=body).solve(announce=lambda number, step: None)


def on_its_corner(points):
    """A square turned by 45 degrees."""
    return np.column_stack([points[:, 0] - points[:, 1], points[:, 0] + points[:, 1]]) / np.sqrt(2)


@pytest.mark.parametrize("simplices", [False, True])
@pytest.mark.parametrize("degree", [1, 2])
def test_a_square_that_lands_on_its_corner_rebounds(degree, simplices):
    """Without friction it leaves with nearly all of its momentum, straight up."""
    body = box((4, 4), (1, 1), move=on_its_corner, simplices=simplices)
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        discretisation=Discretisation(degree),
        contact=tuple(Contact(side, obstacle=FLOOR) for side in ("bottom", "left")),
        motion=Motion(step=2e-3, end=0.2, velocity={"body": (0.0, -0.3)}),
    )
    found = solved(scene, body)
    assert found.passed, found.verdict
    sideways, up = found.quantities["momentum"]
    assert 0.95 * 0.3 < up < 0.3 and abs(sideways) < 1e-9
    assert along(found, "contact_area")[-1] == 0 and worst_defect(found) < 1e-3
    rough = tuple(dataclasses.replace(contact, **ROUGH) for contact in scene.contact)
    motion = Motion(step=2e-3, end=0.2, velocity={"body": (0.2, -0.3)})
    rubbed = solved(dataclasses.replace(scene, contact=rough, motion=motion), body)
    assert rubbed.passed, rubbed.verdict
    slowed, impulse = 0.2 - rubbed.quantities["momentum"][0], rubbed.quantities["momentum"][1] + 0.3
    assert 0 < slowed <= 0.3 * impulse * (1 + 1e-9)  # Coulomb's bound, over all of the impact


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
def test_bodies_that_collide_and_slide_keep_their_momentum(cell):
    """Their meshes do not match."""
    parts = Box("lower", (0, 0), (3, 1), (13, 4)), Box("upper", (0.5, 1.01), (1.5, 2.01), (5, 5))
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        discretisation=Discretisation(1),
        contact=(Contact("upper.y0", against="lower.y1", **ROUGH),),
        motion=Motion(step=2e-3, end=0.3, velocity={"upper": (0.3, -0.3)}),
    )
    found = solved(scene, boxes(parts, cell))
    assert found.passed, found.verdict
    assert found.quantities["momentum"] == pytest.approx([0.3, -0.3], abs=1e-9)
    along_it, across = found.quantities["impulse"]
    assert across > 0.3 and 0.95 * 0.3 < abs(along_it) / across <= 0.3 * (1 + 1e-9)
    assert found.quantities["friction_work"] > 0 and worst_defect(found) < 2e-3


def test_a_block_that_is_pushed_rocks_lifts_and_comes_back():
    lasting = Path(time=(0, 0.1, 0.1001, 9), factor=(1, 1, 0, 0))
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        load=(
            Load("block", body_force=(0, -10.0), path=Path(time=(0,), factor=(1,))),
            Load("block.x0", traction=(1.2, 0), path=lasting),
        ),
        contact=(Contact("block.y0", obstacle=FLOOR, friction_coefficient=0.6, law="incremental"),),
        discretisation=Discretisation(1),
        motion=Motion(step=2e-3, end=0.7),
    )
    found = solved(scene, boxes((Box("block", (0, 0), (0.3, 1.2), (3, 12)),)))
    assert found.passed, found.verdict
    areas = along(found, "contact_area")
    lifted = areas < 0.2
    assert lifted.any() and areas[-1] < 0.3 and areas.max() == pytest.approx(0.3)
    assert worst_defect(found) < 1e-2


def test_steps_far_too_long_fail_the_balance_of_energy():
    """They throw the body back faster than it came."""
    floor = dataclasses.replace(FLOOR, position=(0.0, -0.02))
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        contact=(Contact("bottom", obstacle=floor),),
        motion=Motion(step=0.2, end=1.0, velocity={"body": (0.0, -0.3)}),
    )
    found = solved(scene, box((4, 4), (1, 1)))
    assert not found.passed and not found.checks["energy_balance"].passed
    assert "energy balance" in found.verdict and "take more" in found.verdict
    shorter = dataclasses.replace(scene, motion=dataclasses.replace(scene.motion, step=0.005))
    assert solved(shorter, box((4, 4), (1, 1))).passed
