"""Bolts of bodies that move: tightened in time, locked, and shaken until their joint opens."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from fenics_contact import (
    Contact,
    Load,
    Material,
    Motion,
    Path,
    Point,
    Preload,
    Rayleigh,
    Run,
    Scene,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.impacts import along, times_of
from tests.messages import refused

ALWAYS = Path(time=(0.0,), factor=(1.0,))
FORCE, LENGTH, STIFFNESS, MASS = 3.0, 10.0, 100.0, 2.0
LIGHT = 1e-6  # density of springs


def weighed_bar():
    """A light bar that is tightened within 1 and locked, with a mass at its end."""
    scene = Scene(
        kinematics="plane strain",
        material=(
            Material(STIFFNESS * LENGTH, 0.0, on="bar", density=LIGHT),
            Material(1e6, 0.0, on="mass", density=MASS),
        ),
        support=(
            Support("bar.x0", {"x": 0}),
            Support("bar.y0", {"y": 0}),
            Support("mass.y0", {"y": 0}),
        ),
        preload=(
            Preload(
                "bar", (1, 0), FORCE, Path(time=(0.0, 1.0), factor=(0.0, 1.0)), locked_from=1.0
            ),
        ),
        motion=Motion(step=0.01, end=2.0),
        point=(Point(name="mass", at=(LENGTH + 0.5, 0.5)),),
    )
    parts = (
        Box("bar", (0, 0), (LENGTH, 1), (5, 1)),
        Box("mass", (LENGTH, 0), (LENGTH + 1, 1), (1, 1)),
    )
    return scene, boxes(parts, welded=(("bar", "mass"),))


def place_of_mass(times):
    """m x'' = −F t/T as it is tightened; then it swings about where the locked bar rests."""
    tightened = -FORCE * times**3 / (6 * MASS)
    at, speed = -FORCE / (6 * MASS), -FORCE / (2 * MASS)
    rest, w = at - FORCE / STIFFNESS, np.sqrt(STIFFNESS / MASS)
    later = times - 1
    swings = rest + (at - rest) * np.cos(w * later) + speed / w * np.sin(w * later)
    return np.where(times <= 1, tightened, swings)


def test_a_bar_that_is_tightened_and_locked_pulls_a_mass():
    scene, body = weighed_bar()
    found = Run(scene, body=body).solve()
    assert found.passed, found.verdict
    times = times_of(found)
    places = along(found, "displacement_mass")[:, 0]
    swing = np.ptp(place_of_mass(times[times > 1]))
    assert np.abs(places - place_of_mass(times)).max() < 5e-3 * swing
    forces = np.array([step.preloads["bar"].force for step in found.steps])
    tightening = times < 1 + 1e-9
    assert forces[tightening] == pytest.approx(FORCE * times[tightening], rel=1e-9)
    pulled = FORCE + STIFFNESS * (places - places[tightening][-1])
    assert forces[~tightening] == pytest.approx(pulled[~tightening], abs=1e-3 * FORCE)
    energies = found.quantities["kinetic_energy"] + found.quantities["strain_energy"]
    assert np.abs(along(found, "energy_defect")).max() < 1e-8 * energies


# Of a joint: bolt and sleeve between the ground and a heavy head, all as high.
BOLT, SLEEVE, HEAD, TALL = 200.0, 600.0, 4.0, 5.0


def joint(pull, end=0.5, step=1e-3):
    """It is tightened when the motion begins, and pulled from then on."""
    scene = Scene(
        kinematics="plane strain",
        material=(
            Material(BOLT * TALL, 0.0, on="bolt", density=LIGHT),
            Material(SLEEVE * TALL, 0.0, on="sleeve", density=LIGHT),
            Material(1e8, 0.0, on="head", density=HEAD / 3.0),
        ),
        support=(
            *(Support(f"{name}.y0", {"x": 0, "y": 0}) for name in ("bolt", "sleeve")),
            *(
                Support(f"{name}.x{side}", {"x": 0})
                for name in ("bolt", "sleeve", "head")
                for side in (0, 1)
            ),
        ),
        preload=(Preload("bolt", (0, 1), 6.0, ALWAYS, locked_from=step),),
        contact=(Contact("sleeve.y1", against="head.y0"),),
        load=(
            Load(
                "head.y1",
                traction=(0.0, pull / 3.0),
                path=Path(time=(0.0, step), factor=(0.0, 1.0)),
            ),
        ),
        point=(Point(name="head", at=(1.5, TALL + 1)),),
        motion=Motion(step=step, end=end, start="static"),
    )
    return scene


def joint_body(comm=MPI.COMM_WORLD):
    parts = (
        Box("bolt", (0, 0), (1, TALL), (2, 5)),
        Box("sleeve", (2, 0), (3, TALL), (2, 5)),
        Box("head", (0, TALL), (3, TALL + 1), (6, 1)),
    )
    return boxes(parts, comm=comm, welded=(("bolt", "head"),))


def highest(pull):
    """Where the work of a sudden pull is that of the joint; beyond 6/SLEEVE the sleeve is free."""
    opens = 6.0 / SLEEVE

    def left(x):
        held = min(x, opens)
        return (
            pull * x - 0.5 * BOLT * x**2 - 0.5 * SLEEVE * held**2 - (x > opens) * 6.0 * (x - opens)
        )

    return brentq(left, 1e-9, 1.0)


def test_a_tightened_joint_that_nothing_shakes_rests():
    found = Run(joint(0.0, end=0.02), body=joint_body()).solve()
    assert found.passed, found.verdict
    forces = [step.preloads["bolt"].force for step in found.steps]
    assert forces == pytest.approx([6.0] * len(forces), rel=1e-9)
    assert along(found, "normal_force") == pytest.approx(6.0, rel=1e-7)
    assert along(found, "kinetic_energy").max() < 1e-12 * found.quantities["strain_energy"]


@pytest.mark.parametrize("pull", [3.0, 6.0])
def test_a_sudden_pull_lifts_the_head_of_a_joint_twice_as_far(pull):
    """And farther where the joint opens (6): then the bolt alone holds it."""
    found = Run(joint(pull, end=0.3, step=2e-3), body=joint_body()).solve()
    assert found.passed, found.verdict
    lifted = along(found, "displacement_head")[:, 1]
    rests = -6.0 / SLEEVE  # from where the tightened joint rests
    assert lifted.max() - rests == pytest.approx(highest(pull), rel=1e-2)
    opened = (along(found, "normal_force") <= 1e-9).any()
    assert opened == (highest(pull) > 6.0 / SLEEVE)
    forces = np.array([step.preloads["bolt"].force for step in found.steps])
    assert forces.max() == pytest.approx(6.0 + BOLT * highest(pull), rel=2e-2)


def test_what_bolts_cannot_have_in_motion_is_refused():
    scene, _ = weighed_bar()
    damped = dataclasses.replace(scene.motion, rayleigh=Rayleigh(stiffness=1e-3))
    with refused("rayleigh_stiffness_beside_preload"):
        dataclasses.replace(scene, motion=damped)
    (bolt,) = scene.preload
    for_steps = dataclasses.replace(bolt, path=Preload("bar", (1, 0), FORCE).path)
    dataclasses.replace(scene, preload=(for_steps,))  # once it is locked, a ramp is over
    with refused("motion_without_path_of_preload"):
        dataclasses.replace(scene, preload=(dataclasses.replace(for_steps, locked_from=None),))
