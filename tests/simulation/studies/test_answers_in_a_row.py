"""Answers of which each takes the values of a scene into the problem of the one before."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Steps, Study
from fenics_contact.problem import problem
from fenics_contact.solve.condensed.schur import CondensedBulk
from tests.messages import refused
from tests.scenes import box_body, with_solver
from tests.simulation.studies.cases import (
    BALL,
    CASES,
    DEPTH,
    FORCE,
    MU,
    ON_A_FLOOR,
    PAD,
    PRESCRIBED,
    of_contact,
    square,
)
from tests.simulation.studies.test_study import require_same_answer
from tests.solve.load_steps.histories import block, dragged

COMM = MPI.COMM_WORLD
ALONG = "contact.0.obstacle.displacement.0"


def exactly(scene):
    return with_solver(scene, strategy="exact")


DRAGGED = dragged(Steps(number=2))
WORN = with_solver(of_contact(DRAGGED, wear={"coefficient": 1e-3}), tolerance=1e-12)
# Scene, its body, and values, of which each is an answer.
ROWS = {
    "prescribed": (PRESCRIBED, square, [{MU: 0.5}, {"contact.0.pressure": 40}]),
    "on a floor": (ON_A_FLOOR, square, [{MU: 0.2}, {"load.0.traction.0": -1}]),
    "dragged": (DRAGGED, block, [{MU: 0.2}, {ALONG: 0.001, DEPTH: 0.015}]),
    "worn": (WORN, block, [{MU: 0.2}, {DEPTH: 0.015}]),
    "pad": (PAD, lambda: box_body((3, 3, 2)), [{FORCE: 11}, {"load.0.traction": (0, 1, 0)}]),
    "exact on a floor": (exactly(ON_A_FLOOR), square, [{MU: 0.2}, {"load.0.traction.0": -1}]),
    "exact ball": (exactly(BALL), square, [{DEPTH: 0.03}, {MU: 0.1}]),
    "exactly dragged": (exactly(DRAGGED), block, [{MU: 0.2}, {ALONG: -0.001, DEPTH: 0.015}]),
    "exact pad": (exactly(PAD), lambda: box_body((3, 3, 2)), [{FORCE: 11}, {MU: 0.3}]),
}


@pytest.mark.parametrize("name", ROWS)
def test_answers_in_a_row_are_those_of_separate_runs(name, monkeypatch):
    """Forth and back, with one problem for all of them."""
    scene, make, every = ROWS[name]
    body = make()
    study, apart, made = Study(scene, COMM, body), Study(scene, COMM, body), []
    begin = problem.Problem.__init__
    for changes in [{}, *every, every[0], {}]:
        with monkeypatch.context() as patched:
            patched.setattr(
                problem.Problem,
                "__init__",
                lambda self, *given, **named: made.append(begin(self, *given, **named)),
            )
            found = study.quantities(changes)
        require_same_answer(found, apart.solve(changes))
    assert len(made) == 1


@pytest.mark.parametrize(("strategy", "given"), [("auto", 1e-6), ("exact", "auto")])
def test_nothing_is_found_inside_a_nearly_incompressible_body(strategy, given, monkeypatch):
    """Its mean stress is an unknown inside of it, and contacts and supports tell all numbers."""
    scene, make, every = CASES["nearly incompressible"]
    scene = of_contact(scene, law="incremental", regularisation_parameter=given)
    scene = with_solver(dataclasses.replace(scene, steps=Steps(number=3)), strategy=strategy)
    study = Study(scene, COMM, make())
    study.quantities()
    with monkeypatch.context() as patched:
        patched.delattr(CondensedBulk, "expand")
        found = study.quantities(every[0])
    assert found.converged
    whole = Study(scene, COMM, make())
    require_same_answer(found, whole.solve(every[0]))
    assert whole.run is not None
    apart = whole.run.solution.displacement
    assert study.displacement() == pytest.approx(apart, abs=1e-9 * np.abs(apart).max())


def test_a_row_goes_on_after_an_answer_that_there_is_not():
    """A value that is refused while it is taken: the next answer is that of its own run."""
    study, apart = (Study(exactly(PAD), COMM, box_body((3, 3, 2))) for _ in range(2))
    study.quantities()
    with refused("coefficient_below_nothing"):
        study.quantities({FORCE: 12, MU: lambda x: -x[0]})
    require_same_answer(study.quantities({FORCE: 11}), apart.solve({FORCE: 11}))


def test_a_run_in_between_does_no_harm():
    """It uses the same body, which a problem that is kept has to notice."""
    study, apart = (Study(exactly(ON_A_FLOOR), COMM, square()) for _ in range(2))
    study.quantities()
    study.solve({"support.0.displacement.y": -0.001, "load.0.traction.0": 0.5})
    require_same_answer(study.quantities({MU: 0.2}), apart.solve({MU: 0.2}))


def test_what_is_made_of_a_key_is_made_anew():
    """Another shape of an obstacle, and a contact that has no friction any more."""
    study, apart = (Study(exactly(BALL), COMM, square()) for _ in range(2))
    for changes in ({}, {"contact.0.obstacle.radius": 5}, {MU: 0}):
        scene = study.changed(changes)
        assert dataclasses.replace(scene) == apart.changed(changes)
        require_same_answer(study.quantities(changes), apart.solve(changes))
