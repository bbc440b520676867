"""Damping of motions: against the oscillator's decay, and waves that a boundary lets out."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Motion,
    Path,
    Rayleigh,
    Run,
    Scene,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.impacts import (
    along,
    bar_on_wall,
    force_of_wave,
    times_of,
    worst_defect,
)
from fenics_contact.verification.published.sliding import oscillator
from tests.messages import refused
from tests.scenes import box_body


def solved(scene, body):
    found = Run(scene, body=body).solve()
    assert found.passed, found.verdict
    return found


def with_motion(scene, **changes):
    return dataclasses.replace(scene, motion=dataclasses.replace(scene.motion, **changes))


@pytest.mark.parametrize(("mass", "stiffness"), [(1.0, 0.0), (0.0, 0.01), (0.4, 0.004)])
def test_an_oscillator_decays_by_its_damping_ratio(mass, stiffness):
    """Envelope exp(−ζ ω t) with ζ = ½ (mass/ω + stiffness ω), ω = 10."""
    scene, body = oscillator(200, 1.6, first_turn=None)
    found = solved(with_motion(scene, rayleigh=Rayleigh(mass, stiffness)), body)
    ratio = 0.5 * (mass / 10 + stiffness * 10)
    speed = along(found, "momentum")[:, 0]  # 0 where it turns
    places = along(found, "displacement_mass")[:, 0]
    turns = np.flatnonzero(speed[1:] * speed[:-1] < 0)
    sizes = np.abs(places[turns])
    fall = (sizes[-1] / sizes[0]) ** (1 / (len(sizes) - 1))
    assert fall == pytest.approx(np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2)), rel=1e-3)
    energies = found.quantities
    left = energies["kinetic_energy"] + energies["strain_energy"]
    assert energies["damping_work"] > 0.5 * left
    assert worst_defect(found) < 1e-9


def test_what_flies_is_slowed_by_damping_of_its_mass_alone():
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e4, 0.3, density=2.0),
        discretisation=Discretisation(1),
        motion=Motion(
            step=0.01, end=0.5, velocity={"body": (3.0, 0.0)}, rayleigh=Rayleigh(2.0, 0.05)
        ),
    )
    found = solved(scene, box_body((3, 2), (2.0, 1.0)))
    assert found.quantities["momentum"][0] == pytest.approx(2 * 2 * 3 * np.exp(-1.0), rel=1e-4)
    assert found.checks["momentum_balance"].value < 1e-11


def test_a_bar_with_damping_presses_a_wall_by_the_same_plateau():
    """Damping of the stiffness rounds off the front of the wave, and takes energy."""
    scene, body = bar_on_wall(40, 0.5)
    found = solved(with_motion(scene, rayleigh=Rayleigh(stiffness=2e-4)), body)
    times, force = 10 * times_of(found), along(found, "normal_force") / force_of_wave(40)
    assert np.abs(force[(times > 0.6) & (times < 1.4)] - 1).max() < 1e-2
    assert worst_defect(found) < 2e-3
    free = solved(scene, body)
    assert found.quantities["kinetic_energy"] < 0.99 * free.quantities["kinetic_energy"]


@pytest.mark.parametrize("absorbs", [True, False])
def test_a_boundary_that_absorbs_takes_up_a_wave(absorbs):
    """A smooth pulse runs along a bar of no Poisson's ratio: c = 10, ρ c = 10."""
    size = 0.02
    pulse = Path(tuple(np.linspace(0, 0.04, 21)), tuple(np.sin(np.linspace(0, np.pi, 21)) ** 2))
    scene = Scene(
        kinematics="plane strain",
        material=Material(100.0, 0.0, density=1.0),
        discretisation=Discretisation(1),
        support=(Support("bar", {"y": 0}),),
        load=(Load("bar.x0", traction=(1.0, 0.0), path=pulse),),
        motion=Motion(step=1e-3, end=0.15, absorbing=("bar.x1",) if absorbs else ()),
    )
    found = solved(scene, boxes([Box("bar", (0.0, 0.0), (1.0, size), (50, 1))]))
    energies = along(found, "kinetic_energy") + along(found, "strain_energy")
    left = energies[-1] / energies.max()
    assert left < 1e-3 if absorbs else left == pytest.approx(1.0, abs=1e-6)
    if absorbs:
        assert found.quantities["damping_work"] == pytest.approx(energies.max(), rel=1e-3)
    assert abs(found.quantities["energy_defect"]) < 1e-9 * energies.max()


def test_a_boundary_that_absorbs_lets_a_body_in_touch_drift():
    """A dashpot of ρ c_p and ρ c_s on its faces resists a rigid motion by their areas."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e4, 0.25, density=1.0),
        discretisation=Discretisation(2),
        load=(Load("body", body_force=(1.0, 0.0), path=Path((0.0,), (1.0,))),),
        support=(Support("body", {"y": 0}),),
        motion=Motion(step=5e-3, end=1.0, absorbing=("y0",)),
    )
    found = solved(scene, box_body((4, 2), (2.0, 1.0)))
    impedance = np.sqrt(1e4 / 2.5)
    speed = found.quantities["momentum"][0] / 2
    assert speed == pytest.approx(2 / (2 * impedance), rel=2e-2)


def test_two_blocks_with_all_kinds_of_damping_keep_the_balances():
    parts = [Box("base", (0, -1), (3, 0), (6, 2)), Box("block", (0.9, 0.01), (2.1, 1), (4, 3))]
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e3, 0.3, density=1.0),
        discretisation=Discretisation(1),
        contact=(
            Contact("block.y0", against="base.y1", friction_coefficient=0.3, law="incremental"),
        ),
        motion=Motion(
            step=2e-3,
            end=0.05,
            velocity={"block": (1.0, -1.0)},
            rayleigh=Rayleigh(1.0, 1e-3),
            absorbing=("base.y0", "base.x0"),
        ),
    )
    found = solved(scene, boxes(parts))
    assert found.quantities["normal_force"] >= 0
    assert found.checks["momentum_balance"].value < 1e-9
    assert found.quantities["damping_work"] > 0.01


def test_a_boundary_that_absorbs_must_be_one():
    scene = dataclasses.replace(bar_on_wall(10, 1.0)[0])
    with refused("no_absorbing_group"):
        Run(with_motion(scene, absorbing=("nothing",)), body=bar_on_wall(10, 1.0)[1])
