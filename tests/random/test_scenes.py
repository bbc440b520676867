"""Scenes at random: each is answered, all checks passed, or ends with a typed error.

``benchmarks/random_scenes.py`` solves as many as one likes, on more kinds of cells.
"""

import dataclasses
import faulthandler
import functools
import sys

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import SolverSettings, run
from tests.problem.existence.variational_inequality import normal_force
from tests.random.outcomes import ANSWERED, outcome_of
from tests.random.scenes import RandomScene, draw

COMM = MPI.COMM_WORLD
SEED, NUMBER = 9, 50
FEW = 20  # of them say already how many slip and stick at once, and how many fail
TYPED = (2, 3, 5)  # input, not converged, machine
SECONDS = 120  # after which one hangs, and the run ends with where it does
# Of a share, what the penalty may change: the program says .1 %.
BIAS = 1e-3


def draw_here(number: int, seed: int = SEED, **choices: bool) -> RandomScene:
    """The same on every rank."""
    return COMM.bcast(draw(seed, number, few_forms=True, **choices))


@pytest.fixture(scope="module")
def solved():
    """Outcomes by number; those that other tests have asked for are there already."""

    def outcome(number):
        faulthandler.dump_traceback_later(SECONDS, exit=True, file=sys.__stderr__)  # each anew
        return outcome_of(draw_here(number))

    return functools.cache(outcome)


@pytest.fixture(autouse=True)
def no_hang():
    faulthandler.dump_traceback_later(SECONDS, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()


@pytest.mark.parametrize("number", range(NUMBER))
def test_it_is_answered_or_refused(number, solved):
    random, outcome = draw_here(number), solved(number)
    assert outcome.code in (ANSWERED, *TYPED), f"{outcome.words}\n{random!r}"
    assert outcome.finite, f"{outcome.words}\n{random!r}"
    assert outcome.words


def test_they_are_many_kinds(solved, capsys):
    scenes = [draw_here(number).scene for number in range(NUMBER)]
    outcomes = [solved(number) for number in range(FEW)]
    mixed = sum(outcome.mixed for outcome in outcomes)
    in_space = sum(scene.kinematics == "3D" for scene in scenes)
    codes = [outcome.code for outcome in outcomes]
    counts = {code: codes.count(code) for code in sorted(set(codes))}
    with capsys.disabled():
        if COMM.rank == 0:
            print(
                f"\n{NUMBER} scenes at random: {in_space} in space; of {FEW}, {mixed} slip and "
                f"stick at once; exit codes {counts}"
            )
    assert 3 * in_space >= NUMBER
    assert 2 * mixed >= FEW
    assert codes.count(3) <= 0.1 * FEW


def test_the_same_number_is_the_same_scene():
    first, again = draw(SEED, 7), draw(SEED, 7)
    assert first == again
    assert first != draw(SEED, 8)


def test_a_scene_that_is_printed_can_be_read_again():
    names = {}
    for module in ("fenics_contact", "fenics_contact.verification.boxes", "tests.random.bodies"):
        names |= vars(__import__(module, fromlist=["x"]))
    for number in range(12):
        random = draw_here(number)
        assert eval(repr(random), {**names, "RandomScene": RandomScene}) == random


def test_the_full_solver_finds_the_same(solved):
    """All displacements as unknowns: another system, another factorisation, another path."""
    compared = 0
    for number in range(NUMBER):
        ours = solved(number)
        if ours.mixed and ours.code == ANSWERED:
            require_same(draw_here(number), ours.result)
            compared += 1
        if compared == 6:
            return
    raise AssertionError(f"only {compared} to compare")


def require_same(random, ours):
    """As another solver of the program finds it."""
    other = "condensed" if ours.model["solver"] == "full" else "full"
    scene = dataclasses.replace(random.scene, solver=SolverSettings(solver=other))
    theirs = run(scene, COMM, random.body())
    assert theirs.passed, f"{theirs.verdict}\n{random!r}"
    for one, other in zip(ours.contacts, theirs.contacts, strict=True):
        forces, expected = one["quantities"], other["quantities"]
        for key in ("pressure_integral", "contact_force", "friction_force"):
            difference = np.abs(np.subtract(forces[key], expected[key])).max()
            assert difference <= 1e-6 * expected["pressure_integral"], f"{key}\n{random!r}"
    for key in ("max_contact_pressure", "strain_energy"):
        found, other = (result.quantities[key] for result in (ours, theirs))
        assert abs(found - other) <= 1e-6 * other, f"{key}\n{random!r}"


@pytest.mark.parametrize("number", range(5))
def test_without_friction_it_is_the_variational_inequality(number):
    """Forces are those without penalty, but for a bias of first order in ε₁."""
    random = draw_here(number, seed=11, frictionless=True)
    body = random.body()
    expected = normal_force(random, body)
    outcome = outcome_of(random)
    assert outcome.code == ANSWERED, outcome.words
    error = relative(outcome.result, expected)
    assert error <= BIAS
    softer = penalty_of(outcome.result)
    stiff = with_penalty(random, 0.1 * softer)
    less = relative(run(stiff.scene, COMM, stiff.body()), expected)
    assert less == pytest.approx(0.1 * error, rel=0.05, abs=1e-8)


def test_the_variational_inequality_tells_an_answer_that_is_off():
    random = draw_here(1, seed=11, frictionless=True)
    expected = normal_force(random, random.body())
    obstacle = random.scene.contact[0].obstacle
    deeper = dataclasses.replace(obstacle, indentation=1.01 * obstacle.indentation)
    contact = dataclasses.replace(random.scene.contact[0], obstacle=deeper)
    scene = dataclasses.replace(random.scene, contact=(contact,))
    assert relative(run(scene, COMM, random.body()), expected) > 5 * BIAS


def relative(result, expected):
    return abs(result.quantities["normal_force"] / expected - 1)


def penalty_of(result):
    return result.contacts[0]["parameters"]["penalty_parameter"]


def with_penalty(random, penalty):
    contact = dataclasses.replace(random.scene.contact[0], penalty_parameter=penalty)
    scene = dataclasses.replace(random.scene, contact=(contact,))
    return dataclasses.replace(random, scene=scene)
