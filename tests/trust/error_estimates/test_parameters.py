"""Estimated errors by penalty, regularisation and the solver's rest, against the true ones."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Material,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.solve.coulomb import alternating_loop
from fenics_contact.solve.newton import Newton
from fenics_contact.trust.error_estimates import estimates
from tests.scenes import box_body

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
BODY = box_body((24, 12), (2, 1))
PARABOLA = Obstacle(
    "parabola", radius=2, position=(1, 1), indentation=0.03, displacement=(0.004, 0)
)
# Automatic ones would be about 2e-9 and 4e-8.
EPSILON, PENALTY = 1e-6, 1e-7
NAMES = ("normal_force", "friction_force", "max_contact_pressure", "strain_energy")


def solved(epsilon=EPSILON, penalty=PENALTY, law="static", steps=1, errors="all", **solver):
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "y1",
                obstacle=PARABOLA,
                law=law,
                friction_coefficient=0.3,
                regularisation_parameter=epsilon,
                penalty_parameter=penalty,
            ),
        ),
        steps=Steps(number=steps),
        solver=SolverSettings(errors=errors, **solver),
    )
    return Run(scene, COMM, BODY).solve()


@pytest.fixture(autouse=True)
def without_those_of_the_mesh(monkeypatch):
    monkeypatch.setattr(estimates, "mesh_errors", lambda *arguments: ({}, None))


def true_errors(found, exact):
    return {
        name: np.linalg.norm(np.subtract(found.quantities[name], exact.quantities[name]))
        for name in found.errors
    }


def exact(source, **settings):
    small = {"penalty": 1e-3 * PENALTY} if source == "penalty" else {"epsilon": 1e-3 * EPSILON}
    return solved(errors="none", **small, **settings)


@pytest.mark.parametrize("source", ["penalty", "regularisation"])
@pytest.mark.parametrize(
    "settings",
    [{}, {"solver": "full"}, {"law": "incremental", "steps": 3}],
    ids=["condensed", "full", "history"],
)
def test_estimates_are_the_true_errors(source, settings):
    found = solved(**settings)
    true = true_errors(found, exact(source, **settings))
    for name in NAMES:
        assert found.errors[name][source] == pytest.approx(true[name], rel=0.1), name


def in_space(epsilon=1e-5, penalty=1e-6, errors="auto"):
    """A sphere on a block, by multigrid."""
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        contact=(
            Contact(
                "z1",
                obstacle=Obstacle(
                    "paraboloid",
                    radius=2,
                    position=(0.52, 0.47, 0.5),
                    indentation=0.03,
                    displacement=(0.004, 0, 0),
                ),
                friction_coefficient=0.3,
                regularisation_parameter=epsilon,
                penalty_parameter=penalty,
            ),
        ),
        solver=SolverSettings(solver="iterative", errors=errors),
    )
    return run(scene, COMM, box_body((6, 6, 3), (1, 1, 0.5)))


def test_with_the_iterative_solver_they_are_there_without_being_asked_for():
    found = in_space()
    small = {
        "penalty": in_space(penalty=1e-9, errors="none"),
        "regularisation": in_space(epsilon=1e-8, errors="none"),
    }
    for source, other in small.items():
        true = true_errors(found, other)
        for name in (*NAMES, "reaction"):
            assert found.errors[name][source] == pytest.approx(true[name], rel=0.1), name
            assert true[name] > 1e-6 * np.linalg.norm(found.quantities[name])
            assert found.errors[name]["mesh"] is None and found.errors[name]["total"] is None
            assert found.errors[name]["iteration"] < 1e-3 * true[name]


def test_what_an_epsilon_makes_in_which_nothing_slips_is_seen():
    """Doubling it would tell little: it has all the effect that it can have."""
    huge = 3e-2
    found = solved(epsilon=huge)
    assert found.quantities["slip_area"] == 0
    true = true_errors(found, exact("regularisation"))
    twice = true_errors(found, solved(epsilon=2 * huge, errors="none"))
    for name in ("friction_force", "stick_area"):
        assert found.errors[name]["regularisation"] == pytest.approx(true[name], rel=0.3), name
        assert twice[name] < 0.6 * true[name], name


def test_what_newtons_method_leaves_is_seen():
    loose = solved(tolerance=9e-4, max_outer_iterations=1, strategy="monolithic")
    true = true_errors(loose, solved(errors="none", tolerance=1e-12))
    for name in NAMES:
        assert loose.errors[name]["iteration"] == pytest.approx(true[name], rel=0.05, abs=1e-9)
    assert loose.errors["friction_force"]["iteration"] > 1e-6
    tight = solved()
    assert tight.errors["friction_force"]["iteration"] < 1e-9


def never(*arguments, **others):
    raise NotConvergedError("made to fail", ())


@pytest.mark.parametrize("is_newton_lost", [False, True], ids=["Newton's method", "another pass"])
def test_what_the_loop_on_the_pressure_leaves_is_seen(monkeypatch, is_newton_lost):
    """Without a last solve of all together, its tolerance is what it leaves."""
    finish = alternating_loop.solve_coupled
    monkeypatch.setattr(alternating_loop, "solve_coupled", never)
    good, run_law = Newton.run, []

    def only_with_the_law(newton, *arguments, **others):
        if any(contact.friction_term.follows_pressure for contact in newton.problem.coulomb):
            never()
        run_law.append(newton)
        good(newton, *arguments, **others)

    if is_newton_lost:
        monkeypatch.setattr(Newton, "run", only_with_the_law)
    loose = solved(strategy="lagged", outer_tolerance=9e-3)
    assert bool(run_law) == is_newton_lost
    monkeypatch.setattr(Newton, "run", good)
    monkeypatch.setattr(alternating_loop, "solve_coupled", finish)
    true = true_errors(loose, solved(errors="none"))
    for name in ("normal_force", "friction_force", "friction_work"):
        estimate = loose.errors[name]["iteration"]
        assert true[name] > 1e-7 * np.linalg.norm(loose.quantities[name])
        if is_newton_lost:
            assert 0.5 * true[name] <= estimate <= 5 * true[name], name
        else:
            assert estimate == pytest.approx(true[name], rel=0.01), name


def test_the_strategies_of_a_load_step_help_where_newtons_method_fails(monkeypatch):
    expected = solved().errors
    good, failed = Newton.run, []

    def fails_at_first(newton, *arguments, **others):
        softened = newton.problem.contacts[0].normal.penalty.softness != 1
        if softened and not failed:
            failed.append(newton)
            never()
        good(newton, *arguments, **others)

    monkeypatch.setattr(Newton, "run", fails_at_first)
    found = solved().errors
    assert failed
    for name in NAMES:
        assert found[name]["penalty"] == pytest.approx(expected[name]["penalty"], rel=1e-3)


def test_a_source_that_cannot_be_solved_again_is_left_open(monkeypatch):
    good = Newton.run

    def fails(newton, *arguments, **others):
        if newton.problem.contacts[0].normal.penalty.softness != 1:
            never()
        good(newton, *arguments, **others)

    monkeypatch.setattr(Newton, "run", fails)
    found = solved()
    assert found.errors["normal_force"]["penalty"] is None
    assert found.errors["normal_force"]["total"] is None
    assert found.errors["normal_force"]["regularisation"] > 0
    assert any("error by the penalty was not estimated" in note for note in found.error_notes)
