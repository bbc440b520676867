"""Masses at the points of couplings: modes and weights by formulas."""

import math

import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from fenics_contact import (
    Coupling,
    Damping,
    Load,
    Material,
    Modes,
    Rotation,
    Scene,
    SolverSettings,
    Spring,
    Study,
    Support,
    run,
)
from fenics_contact.common.errors import SceneError
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
E, LENGTH, SIDE, DENSITY = 1000.0, 4.0, 0.5, 0.03
BODY, MASS = DENSITY * LENGTH * SIDE, 1.2
STIFFNESS = E * SIDE / LENGTH
KINDS = ["rigid", "distributing"]


def bar(kind="rigid", mass=MASS, number=1, spring=(), **more):
    """A bar along x in the plane, without lateral contraction, clamped at its left end."""
    given = {
        "kinematics": "plane strain",
        "material": Material(E, 0.0, density=DENSITY),
        "support": (Support("x0", {"x": 0, "y": 0}),),
        "coupling": (Coupling("x1", kind=kind, name="tip", mass=mass, **more.pop("tip", {})),),
        "spring": spring,
        "modes": Modes(number) if number else None,
        "solver": SolverSettings(errors="none"),
    }
    return Scene(**given | more)


def body(comm=COMM):
    return box_body((12, 2), (LENGTH, SIDE), comm=comm)


def frequency(scene, comm=COMM):
    found = run(scene, body=body(comm), comm=comm)
    assert found.passed, found.verdict
    return found.modes[0].natural_frequency


ALONG = {"tip": {"displacement": {"y": 0}, "rotation": {"z": 0}}}


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_at_the_end_of_a_bar(kind):
    """β tan β = ρ A L/m with ω = β √(E/ρ)/L; a third of the light bar's own mass goes with it."""
    found = frequency(bar(kind, **ALONG))
    beta = brentq(lambda x: x * math.tan(x) - BODY / MASS, 1e-3, 1.5)
    exact = beta / LENGTH * math.sqrt(E / DENSITY) / (2 * math.pi)
    assert found == pytest.approx(exact, rel=1e-5)
    third = math.sqrt(STIFFNESS / (MASS + BODY / 3)) / (2 * math.pi)
    assert found == pytest.approx(third, rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_on_a_spring_beside_the_bar(kind):
    """Springs are part of the stiffness: √((E A/L + k)/(m + ρ A L/3))."""
    spring = Spring(between=("tip", "ground"), stiffness={"x": 40.0})
    third = math.sqrt((STIFFNESS + 40.0) / (MASS + BODY / 3)) / (2 * math.pi)
    assert frequency(bar(kind, spring=(spring,), **ALONG)) == pytest.approx(third, rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_at_the_tip_of_a_beam(kind):
    """By Rayleigh, 33/140 of the beam's mass goes with it; its stiffness is that of a static run.

    Its end is free to turn.
    """
    pushed = bar(kind, number=0, tip={"force": (0, 1.0)})
    stiffness = 1 / run(pushed, body=body()).couplings[0].displacement[1]
    third = math.sqrt(stiffness / (MASS + 33 / 140 * BODY)) / (2 * math.pi)
    assert frequency(bar(kind)) == pytest.approx(third, rel=1e-3)


def test_without_a_mass_a_rigid_end_moves_with_the_bar():
    """A free bar's end that stays plane: the quarter wave, c/4L, above one that bends."""
    modes = run(bar(mass=None, number=4, **ALONG), body=body()).modes
    expected = math.sqrt(E / DENSITY) / (4 * LENGTH)
    assert min(abs(mode.natural_frequency / expected - 1) for mode in modes) < 1e-4


def test_any_number_of_ranks_has_the_same_modes():
    one, found = (frequency(bar("distributing"), comm) for comm in (MPI.COMM_SELF, COMM))
    assert found == pytest.approx(one, rel=1e-8)


@pytest.mark.parametrize("kind", KINDS)
def test_its_weight_pulls_at_the_point(kind):
    """u = (m + ρ A L/2) g L/(E A), and the foot bears all of it."""
    pull = 3.0
    load = (Load("body", acceleration=(pull, 0)),)
    found = run(bar(kind, number=0, load=load), body=body())
    assert found.passed, found.verdict
    (tip,) = found.couplings
    assert tip.displacement[0] == pytest.approx((MASS + BODY / 2) * pull / STIFFNESS, rel=1e-9)
    assert tip.force[0] == pytest.approx(MASS * pull, rel=1e-9)
    assert found.quantities["reaction"][0] == pytest.approx(-(MASS + BODY) * pull, rel=1e-9)
    energy = found.quantities["strain_energy"]
    assert found.quantities["external_work"] == pytest.approx(2 * energy, rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_rotation_pulls_it_outwards(kind):
    """By m ω² r at the place of the point, here beyond the end of the bar."""
    turn = Rotation(at=(-1.0, SIDE / 2), speed=0.7)
    tip = {"at": (LENGTH + 2, SIDE / 2)}
    load = (Load("body", rotation=turn),)
    found = run(bar(kind, number=0, load=load, tip=tip), body=body())
    assert found.couplings[0].force[0] == pytest.approx(MASS * 0.7**2 * (LENGTH + 3), rel=1e-9)


def test_it_weighs_where_its_own_part_does():
    """A load that acts on another part leaves it alone."""
    two = boxes([Box("a", (0, 0), (1, 1), (1, 1)), Box("b", (2, 0), (3, 1), (1, 1))])
    made = bar(
        number=0,
        support=tuple(Support(on, {"x": 0, "y": 0}) for on in ("a.x0", "b.x0")),
        coupling=(Coupling("a.x1", mass=MASS),),
        load=(Load("b", acceleration=(2.0, 0)),),
    )
    assert run(made, COMM, two).couplings[0].force == pytest.approx([0, 0], abs=1e-12)


def test_derivatives_by_the_acceleration_have_its_weight():
    made = bar(number=0, load=(Load("body", acceleration=(3.0, 0)),))
    of, key = ["strain_energy", "tip.reaction_x"], "load.0.acceleration.0"
    study = Study(made, body=body())
    slopes, answer = study.derivatives(of, [key]), study.solve({})
    energy, force = answer.quantities["strain_energy"], answer.couplings[0].force[0]
    assert slopes["strain_energy"][key] == pytest.approx(2 * energy / 3, rel=1e-9)
    assert slopes["tip.reaction_x"][key] == pytest.approx(force / 3, rel=1e-9)


def test_driven_modes_are_refused():
    with refused("damping_of_a_coupling", SceneError):
        bar(damping=Damping(amplitudes=(0.1,)))


def test_its_mass_is_positive():
    with refused("coupling_without_mass", SceneError):
        Coupling("x1", mass=0.0)
