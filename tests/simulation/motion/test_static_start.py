"""Motions that begin from the static answer: they rest, or move on from it as waves do."""

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
    Point,
    Run,
    Scene,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.impacts import along, times_of
from tests.messages import refused
from tests.scenes import box_body

ALWAYS = Path(time=(0.0,), factor=(1.0,))
FLOOR = Contact(
    "y0",
    obstacle=Obstacle("plane", position=(0.0, 0.0), normal=(0.0, 1.0)),
    friction_coefficient=0.3,
    law="incremental",
)
BLOCK = Scene(
    kinematics="plane strain",
    material=Material(1e3, 0.3, density=1.0),
    discretisation=Discretisation(1),
    load=(Load("body", body_force=(2.0, -10.0), path=ALWAYS),),
    contact=(FLOOR,),
    point=(Point(name="top", at=(1.0, 1.0)),),
    motion=Motion(step=2e-3, end=0.02, start="static"),
)


def solved(scene, body):
    found = Run(scene, body=body).solve()
    assert found.passed, found.verdict
    return found


@pytest.mark.parametrize("degree", [1, 2])
def test_what_friction_holds_does_not_move(degree):
    """A block that is pulled by less than friction can bear, and sticks in part."""
    scene = dataclasses.replace(BLOCK, discretisation=Discretisation(degree))
    found = solved(scene, box_body((8, 4), (2.0, 1.0)))
    places = along(found, "displacement_top")
    assert np.abs(places[0]).min() > 1e-3  # deformed from the first step on
    assert np.ptp(places, axis=0).max() < 1e-9 * np.abs(places).max()
    assert along(found, "kinetic_energy").max() < 1e-9 * found.quantities["strain_energy"]
    assert np.abs(along(found, "energy_defect")).max() < 1e-9 * found.quantities["strain_energy"]
    assert found.quantities["impulse"] == pytest.approx([-4 * 0.02, 20 * 0.02], rel=1e-6)


def test_two_bodies_that_lie_on_each_other_rest():
    parts = [Box("base", (0, -1), (3, 0), (6, 2)), Box("block", (0.9, 0), (2.1, 1), (4, 3))]
    scene = dataclasses.replace(
        BLOCK,
        load=(Load("block", body_force=(1.0, -10.0), path=ALWAYS),),
        support=(Support("base.y0", {"x": 0, "y": 0}),),
        contact=(
            Contact("block.y0", against="base.y1", friction_coefficient=0.3, law="incremental"),
        ),
    )
    found = solved(scene, boxes(parts))
    places = along(found, "displacement_top")
    assert np.ptp(places, axis=0).max() < 1e-8 * np.abs(places).max()
    assert along(found, "kinetic_energy").max() < 1e-9 * found.quantities["strain_energy"]


def test_a_block_that_is_given_a_velocity_slides_from_the_first_step():
    """Its momentum falls by μ N alone, as it is pressed by its weight from the start."""
    scene = dataclasses.replace(
        BLOCK,
        load=(Load("body", body_force=(0.0, -10.0), path=ALWAYS),),
        motion=Motion(step=2e-3, end=0.02, start="static", velocity={"body": (1.0, 0.0)}),
    )
    found = solved(scene, box_body((8, 4), (2.0, 1.0)))
    assert along(found, "normal_force") == pytest.approx(20.0, rel=0.05)
    along_floor, _ = found.quantities["impulse"]
    assert found.quantities["momentum"][0] == pytest.approx(2.0 + along_floor, abs=1e-9)
    assert along_floor == pytest.approx(-0.3 * 2e-3 * along(found, "normal_force").sum(), rel=1e-6)


def test_a_pressed_bar_that_is_let_go_leaves_the_wall_when_its_wave_is_back():
    """Its free end moves at 2 F c/(E A) at once (d'Alembert); the wall is pressed until L/c."""
    cells, size = 50, 0.02
    scene = Scene(
        kinematics="plane strain",
        material=Material(100.0, 0.0, density=1.0),  # waves are 10 fast
        discretisation=Discretisation(1),
        load=(Load("bar.x1", traction=(-1.0, 0.0), path=Path((0.0, 1e-6), (1.0, 0.0))),),
        support=(Support("bar", {"y": 0}),),
        contact=(
            Contact("bar.x0", obstacle=Obstacle("plane", position=(0.0, 0.0), normal=(1.0, 0.0))),
        ),
        point=(Point(name="end", at=(1.0, size / 2)),),
        motion=Motion(step=size / 20, end=0.18, start="static"),
    )
    found = solved(scene, boxes([Box("bar", (0.0, 0.0), (1.0, size), (cells, 1))]))
    times, force = 10 * times_of(found), along(found, "normal_force") / size
    assert force[times < 0.8] == pytest.approx(1.0, abs=2e-2)
    assert force[times > 1.2] == pytest.approx(0.0, abs=2e-2)
    end = 100 * along(found, "displacement_end")[:, 0]
    assert end == pytest.approx(times - 1, abs=2e-2)
    energy = 0.5 * size / 100
    assert found.quantities["kinetic_energy"] == pytest.approx(energy, rel=2e-2)
    assert abs(found.quantities["energy_defect"]) < 1e-2 * energy


def test_where_there_is_no_static_answer_it_says_so():
    sliding = dataclasses.replace(BLOCK, load=(Load("body", body_force=(4.0, -10.0), path=ALWAYS),))
    with refused("no_static_start"):
        Run(sliding, body=box_body((4, 2), (2.0, 1.0))).solve()
