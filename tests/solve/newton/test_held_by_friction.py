"""What only friction holds: it does not drift off before there is friction, and is soon found."""

import functools
import logging
from contextlib import contextmanager

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Path,
    Preload,
    Run,
    Scene,
    Steps,
    Support,
)
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.timings import Timings
from fenics_contact.scene.settings import SolverSettings
from fenics_contact.solve import snes_solve
from fenics_contact.solve.condensed.tangent import ContactTangent
from fenics_contact.solve.coulomb import strategies
from fenics_contact.solve.load_steps import step_tries
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.snes_solve import SnesSolve
from fenics_contact.solve.systems.full_system import FullSystem
from fenics_contact.verification.boxes import Box, boxes

COMM = MPI.COMM_WORLD

# Logged where tightening ends without an answer.
FAILED = "taking up the slack"
FORCE, SHARE, COEFFICIENT = 40.0, 0.3, 0.2


def clamp(strategy="auto", cell="quadrilateral", steps=2):
    """A plate between a base and the head of a bolt beside it, pulled out of there.

    The pull is a share of what friction holds. It grows with the force of the bolt.
    """
    parts = (
        Box("base", (0, -1), (3, 0), (6, 2)),
        Box("shank", (2, 0), (3, 1), (2, 2)),
        Box("head", (1, 1), (3, 1.5), (4, 1)),
        Box("plate", (0, 0), (1.9, 1), (7, 4)),
    )
    grows = Path(time=(0, 1), factor=(0, 1))
    held = {"law": "incremental", "friction_coefficient": COEFFICIENT}
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e5, 0.3),
        discretisation=Discretisation(2),
        support=(Support("base.y0", {"x": 0, "y": 0}),),
        preload=(Preload("shank", (0, 1), FORCE, grows),),
        load=(Load("plate.x0", traction=(-SHARE * COEFFICIENT * FORCE, 0), path=grows),),
        contact=(
            Contact("plate.y0", name="base", against="base.y1", **held),
            Contact("plate.y1", name="head", against="head.y0", **held),
        ),
        steps=Steps(steps),
        solver=SolverSettings(solver="condensed", errors="none", strategy=strategy),
    )
    return Run(scene, COMM, boxes(parts, cell, welded=[("base", "shank", "head")]))


def largest(prepared, displacement):
    """Largest displacement of the plate (length)."""
    spaces = prepared.problem.spaces
    mine = spaces.parts.of_node == spaces.parts.names.index("plate")
    own = np.abs(displacement[mine]).max(initial=0.0)
    return float(COMM.allreduce(own, op=max))


def moved_by_tightening(monkeypatch, prepared):
    """Displacement of the plate when slack is taken up, that of the answer, and the result."""
    found, usual = [], step_tries.take_up_slack

    def take_up(newton, last):
        usual(newton, last)
        found.append(largest(prepared, newton.system.finish()().displacement))

    monkeypatch.setattr(step_tries, "take_up_slack", take_up)
    result = prepared.solve()
    return found[0], largest(prepared, prepared.solution.displacement), result


def test_tightening_moves_nothing_that_friction_is_to_hold(monkeypatch, caplog):
    with caplog.at_level(logging.DEBUG, "fenics_contact"):
        tightened, answer, result = moved_by_tightening(monkeypatch, clamp(steps=1))
    assert result.passed, result.verdict
    assert 0 < tightened < answer
    assert FAILED not in caplog.text


def test_without_glue_the_plate_slides_off_and_nothing_is_tightened(monkeypatch, caplog):
    @contextmanager
    def loose(problem):
        yield False

    monkeypatch.setattr(strategies, "glued_where_it_slides", loose)
    with caplog.at_level(logging.DEBUG, "fenics_contact"):
        moved_by_tightening(monkeypatch, clamp(steps=1))
    assert COMM.rank > 0 or FAILED in caplog.text


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
def test_friction_carries_the_pull(cell):
    prepared = clamp(cell=cell)
    result = prepared.solve()
    assert result.passed, result.verdict
    forces = [contact.quantities["friction_force"][0] for contact in result.contacts]
    assert sum(forces) == pytest.approx(SHARE * COEFFICIENT * FORCE, rel=1e-6)


def test_it_takes_few_newton_steps():
    prepared = clamp()
    prepared.solve()
    first, second = (step.newton_iterations for step in prepared.steps)
    assert first <= 25
    assert second <= 12


def test_steps_on_the_way_are_not_put_into_words(monkeypatch):
    """What a few steps on the way end in is asked of nobody; what a solve ends in is."""
    words, on_the_way = [], []
    usual = SnesSolve._words
    monkeypatch.setattr(snes_solve, "not_converged", lambda *of: words.append(of) or "")
    monkeypatch.setattr(
        SnesSolve, "_words", lambda own, reason: on_the_way.append(own._most) or usual(own, reason)
    )
    assert clamp().solve().converged
    assert any(most is not None for most in on_the_way)
    assert len(words) == on_the_way.count(None)


@functools.cache
def answer(strategy):
    prepared = clamp(strategy)
    result = prepared.solve()
    return result.passed, largest(prepared, prepared.solution.displacement)


@pytest.mark.parametrize("strategy", ["lagged", "monolithic"])
def test_a_bound_that_is_held_ends_at_the_same_answer(strategy):
    passed, moved = answer(strategy)
    assert passed
    assert moved == pytest.approx(answer("auto")[1], rel=1e-5)


def test_round_off_of_linear_solves_changes_nothing(monkeypatch):
    usual, rng = ContactTangent.solve, np.random.default_rng(1)
    plain = clamp()
    plain.solve()

    def noisy(self, *given, **accuracy):
        found = usual(self, *given, **accuracy)
        return found * (1 + 1e-9 * rng.uniform(-1, 1, len(found)))

    monkeypatch.setattr(ContactTangent, "solve", noisy)
    disturbed = clamp()
    assert disturbed.solve().passed
    steps, others = ([step.newton_iterations for step in one.steps] for one in (plain, disturbed))
    assert np.abs(np.subtract(steps, others)).max() <= 1
    moved = [largest(one, one.solution.displacement) for one in (plain, disturbed)]
    assert moved[0] == pytest.approx(moved[1], rel=1e-6)


def test_rough_solves_stay_rough_under_springs(monkeypatch):
    """Others are as exact under springs as without them."""
    problem = clamp().problem
    newton, tolerances = Newton(problem, FullSystem(problem, Timings()), Timings()), []

    def solve(own):
        tolerances.append(own._tolerance)
        own.imbalances.append(0.0)
        if own._springs is None:
            own._ran_far = True
            raise NotConvergedError("", ())

    monkeypatch.setattr(SnesSolve, "_solve", solve)
    monkeypatch.setattr("fenics_contact.solve.newton.runaway", lambda *of: None)
    newton.run(tolerance=0.1, is_held=True)
    newton.run(is_held=True)
    exact = problem.scene.solver.tolerance
    # Without springs, with them, and a last step without those that held something back.
    assert tolerances == pytest.approx([0.1, 0.01, 0.01, exact, exact, exact])


def test_steps_that_are_cut_to_next_to_nothing_are_followed_by_full_ones(monkeypatch):
    """Where each step would end at the next point that closes, two of them tell."""
    problem = clamp().problem
    newton = SnesSolve(problem, FullSystem(problem, Timings()), Timings())
    newton._in_full, newton.imbalances, taken = 0, [], []
    monkeypatch.setattr(SnesSolve, "_imbalance_after", lambda *of: np.inf)
    monkeypatch.setattr(SnesSolve, "_damp", lambda *of: taken.append("full"))
    shares = iter([0.01, 0.5, 0.01, 0.02, 0.9])

    def cut(*of):
        share = next(shares)
        taken.append(share)
        return share

    monkeypatch.setattr(SnesSolve, "_cut", cut)
    for _ in range(5 + snes_solve.IN_FULL):
        newton.imbalances.append(1.0)
        newton._damp_or_cut(None, None)
    assert taken == [0.01, 0.5, 0.01, 0.02, *["full"] * snes_solve.IN_FULL, 0.9]
