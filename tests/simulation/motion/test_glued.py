"""Bodies that are glued together move as one: waves cross the glue."""

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
    SolverSettings,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.impacts import along, times_of

# A bar of length 10, fixed at one end, with waves of speed 10, pulled at the other from time 0 on.
LENGTH, YOUNG, PULL = 10.0, 100.0, 1.0
NAMES = ("left", "right")
ALWAYS = Path(time=(0.0,), factor=(1.0,))


def pulled_bar(degree, glued=True):
    """In two pieces whose meshes do not match, or in one."""
    sides = [f"{name}.y{side}" for name in NAMES for side in (0, 1)]
    scene = Scene(
        kinematics="plane strain",
        material=Material(YOUNG, 0.0, density=1.0),
        discretisation=Discretisation(degree),
        support=(Support("left.x0", {"x": 0}), *(Support(side, {"y": 0}) for side in sides)),
        load=(Load("right.x1", traction=(PULL, 0.0), path=ALWAYS),),
        contact=(Contact("right.x0", against="left.x1", contact="bonded"),) if glued else (),
        point=(Point(name="end", at=(LENGTH, 0.5)),),
        motion=Motion(step=0.02, end=4.0),
    )
    parts = (
        Box("left", (0, 0), (4, 1), (8, 2)),
        Box("right", (4, 0), (LENGTH, 1), (12, 3 if glued else 2)),
    )
    return scene, boxes(parts, welded=() if glued else (NAMES,))


@pytest.mark.parametrize("degree", [1, 2])
def test_waves_cross_the_glue_as_if_it_were_not_there(degree):
    """The end goes out and back between 0 and twice its static place, in 4 L/c.

    It turns when the wave is back, which is smeared over a cell or so of .5. In the first steps
    next to nothing has reached the left piece: that is no fault in its balance of momenta.
    """
    found, whole = (
        Run(scene, body=body).solve()
        for scene, body in (pulled_bar(degree, glued) for glued in (True, False))
    )
    assert found.passed and whole.passed, (found.verdict, whole.verdict)
    times = times_of(found)
    place = PULL * LENGTH / YOUNG * np.where(times < 2, times, 4 - times)
    largest = 2 * PULL * LENGTH / YOUNG
    off, without = (
        np.abs(along(run, "displacement_end")[:, 0] - place).max() / largest
        for run in (found, whole)
    )
    assert off < 0.5 / LENGTH and off < without + 1e-3
    assert along(found, "normal_force").min() < -0.9 * PULL  # the glue is pulled
    work = np.abs(along(found, "external_work")).max()
    assert np.abs(along(found, "energy_defect")).max() < 1e-9 * work


def test_a_glued_bar_rests_under_what_acts_at_the_start():
    scene, body = pulled_bar(1)
    still = dataclasses.replace(
        scene,
        motion=Motion(step=0.02, end=0.2, start="static"),
        solver=SolverSettings(errors="none"),
    )
    found = Run(still, body=body).solve()
    assert found.passed, found.verdict
    assert along(found, "normal_force") == pytest.approx(-PULL, rel=1e-8)
    assert along(found, "kinetic_energy").max() < 1e-12 * found.quantities["strain_energy"]


@pytest.mark.parametrize("way", ["across", "along"])
def test_what_is_glued_to_a_plane_is_taken_along(way):
    """It begins to move at once: the free end rests for L/c, then goes twice as fast for 2 L/c.

    Pulled across the glue by pressure waves, along it by shear waves.
    """
    speed, height = 0.01, 5.0
    move, free = ((0.0, 1.0), "x") if way == "across" else ((1.0, 0.0), "y")
    velocity_of_waves = np.sqrt(YOUNG if way == "across" else YOUNG / 2)
    end = 2.5 * height / velocity_of_waves
    plane = Obstacle(
        "plane",
        position=(0.0, 0.0),
        normal=(0.0, 1.0),
        displacement=tuple(-speed * end * part for part in move),
        displacement_path=Path(time=(0.0, end), factor=(0.0, 1.0)),
    )
    scene = Scene(
        kinematics="plane strain",
        material=Material(YOUNG, 0.0, density=1.0),
        discretisation=Discretisation(1),
        support=(Support("bar", {free: 0}),),
        contact=(Contact("bar.y0", contact="bonded", obstacle=plane),),
        point=(Point(name="end", at=(0.5, height)),),
        motion=Motion(step=0.25 * height / 20 / velocity_of_waves, end=end),
    )
    body = boxes((Box("bar", (0, 0), (1, height), (1, 20)),))
    found = Run(scene, body=body).solve()
    assert found.passed, found.verdict
    passed = times_of(found) * velocity_of_waves / height
    axis = ("along", "across").index(way)
    gone = along(found, "displacement_end")[:, axis] * -velocity_of_waves / (speed * height)
    assert np.abs(gone - 2 * np.maximum(passed - 1, 0)).max() < 0.1
    assert gone[-1] == pytest.approx(3.0, rel=0.03)
