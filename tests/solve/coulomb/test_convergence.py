"""What is said of loops that do not come nearer: contraction, points that chatter, cycles."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Scene, SolverSettings, Support, run
from fenics_contact.problem.problem import Problem
from fenics_contact.solve import newton_failure as chatter
from fenics_contact.solve.coulomb import at_points
from fenics_contact.solve.coulomb.alternating_loop import OuterMonitor
from fenics_contact.solve.newton_failure import Chatter
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
OPEN, STICK, SLIP = 0, 1, 2


def block(coefficient=0.5, moved=(0.05, -0.01), **solver):
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": moved[0], "y": moved[1]}),),
        contact=(Contact("y0", friction_coefficient=coefficient),),
        solver=SolverSettings(**solver),
    )


@pytest.fixture
def contact():
    return Problem.on_mesh(block(), box_body((8, 4), (2, 1))).contacts[0]


def chattering(contact, monkeypatch, statuses, count):
    """A Chatter that has seen points between x = .5 and 1 go through statuses, the others stick."""
    x = contact.trace.coordinates[:, 0]
    restless = (x > 0.45) & (x < 1.05)
    found = Chatter([contact], COMM)
    for number in range(count):
        status = np.where(restless, statuses[number % len(statuses)], STICK).astype(np.int8)
        sign = 1.0 if number % 2 else -1.0
        direction = np.zeros((len(x), 2))
        direction[status == SLIP, 0] = sign
        pressure = np.where(restless, 3.0, 1.0)
        seen = chatter._Iterate(status, direction, pressure)
        monkeypatch.setattr(chatter, "_present", lambda contact, seen=seen: seen)
        found.note()
    return found


@pytest.mark.parametrize(
    ("statuses", "words", "period"),
    [
        ((OPEN, STICK), "open and stick, again and again after 2 passes", 2),
        ((OPEN, STICK, STICK), "open and stick, again and again after 3 passes", 3),
        ((SLIP,), "slip to and fro, again and again after 2 passes", 2),
    ],
)
def test_points_that_chatter_are_named_with_their_share(
    contact, monkeypatch, statuses, words, period
):
    """5 of 17 points of degree 2, under pressure 3 where the others have 1."""
    found = chattering(contact, monkeypatch, statuses, 12)
    assert found.period() == period
    said = found.words("passes")
    assert "; 5 of 17 points of 'y0' keep changing between " + words in said
    assert "the most restless at (0.5, 0)" in said
    # Weights h/6 (1, 4, 1) with h = .25: both ends of the five points share with other cells.
    mine = 0.25 / 6 * (2 + 4 + 2 + 4 + 2)
    share = 3 * mine / (3 * mine + (2 - mine))
    assert f"they carry {100 * share:.0f} % of its pressure" in said


def test_points_that_settle_do_not_chatter(contact, monkeypatch):
    found = chattering(contact, monkeypatch, (OPEN, STICK, *(STICK,) * 20), 12)
    assert found.words("passes") == ""
    assert found.period() is None
    found.clear()
    assert found.words("passes") == ""


@pytest.mark.parametrize("factor", [0.5, 0.9, 1.3])
def test_contraction_of_a_linear_map_is_its_factor(contact, factor):
    monitor = OuterMonitor(Chatter([], COMM), COMM)
    fixed = np.array([4.0, 2.0])
    pressures = np.array([1.0, 5.0])
    assert monitor.contraction is None
    for _ in range(20):
        image = fixed + factor * (pressures - fixed)
        monitor.see([pressures], [image])
        pressures = 0.5 * (pressures + image)  # as if accelerated: the map's factor still shows
    assert monitor.contraction == pytest.approx(factor, rel=1e-6)
    assert monitor.is_stalled == (factor > 1)
    assert ("no progress in 8 passes" in monitor.words()) == (factor > 1)


def test_contraction_of_a_run_is_in_its_steps():
    """The loop needs more passes where a pass shrinks differences less."""
    results = [
        run(block(mu, strategy="lagged"), COMM, box_body((16, 8), (2, 1))) for mu in (0.2, 2.0)
    ]
    weak, strong = (result.steps[0] for result in results)
    assert 0 < weak["outer_contraction"] < strong["outer_contraction"] < 1
    assert weak["outer_iterations"] < strong["outer_iterations"]
    assert weak["attempts"] == []


def test_loop_that_does_not_contract_is_said():
    """At μ = 4 a pass makes differences larger, though the run finds its answer."""
    result = run(block(4.0, (0.04, -0.002)), COMM, box_body((16, 8), (2, 1)))
    assert result.converged
    contraction = result.steps[0]["outer_contraction"]
    assert contraction > 1
    assert f"multiplies differences by {contraction:.2g}" in result.verdict
    calm = run(block(0.3), COMM, box_body((16, 8), (2, 1)))
    assert "multiplies differences" not in calm.verdict


def test_run_that_fails_says_which_points_chatter_and_what_was_tried(monkeypatch):
    """(μ, dx, dy) = (2, .5, −.0005): solved by no strategy but at the points.

    It stands on one corner, whose cells are turned inside out.
    """
    scene = block(2.0, (0.5, -0.0005))
    at_points_alone = run(scene, COMM, box_body((16, 8), (2, 1)))
    assert at_points_alone.exit_code == 4
    assert len(at_points_alone.steps[-1]["attempts"]) == 1
    monkeypatch.setattr(at_points, "_FEW", 0)
    result = run(scene, COMM, box_body((16, 8), (2, 1)))
    assert result.exit_code == 3
    assert "points of 'y0' keep changing between" in result.verdict
    attempts = result.steps[-1]["attempts"]
    assert len(attempts) == 4
    assert attempts[-1] in result.verdict and "tries other ways" not in result.verdict
    only = dataclasses.replace(scene, solver=SolverSettings(strategy="lagged"))
    alone = run(only, COMM, box_body((16, 8), (2, 1)))
    assert len(alone.steps[-1]["attempts"]) == 1
    assert 'solver.strategy = "auto" tries other ways too' in alone.verdict
