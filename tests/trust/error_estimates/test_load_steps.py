"""Estimated errors by load steps, against histories of many more."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run, Steps, run
from fenics_contact.common.errors import StoppedError
from fenics_contact.trust.error_estimates import estimates, load_steps
from fenics_contact.trust.error_estimates.load_steps import _cut, _other_steps, between_turns
from tests.scenes import box_body, with_solver
from tests.solve.load_steps.histories import dragged, shoved, times, two_blocks

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
BODY = box_body((32, 8), (1, 1))
NAMES = ("normal_force", "friction_force", "max_slip", "friction_work")


def solved(steps, errors="all"):
    return run(with_solver(dragged(steps), errors=errors), COMM, BODY)


@pytest.fixture(autouse=True)
def without_those_of_the_mesh(monkeypatch):
    monkeypatch.setattr(estimates, "mesh_errors", lambda *arguments: ({}, None))


@pytest.fixture(scope="module")
def limit():
    return solved(Steps(number=64), "none").quantities


def true_error(result, limit, name):
    return np.linalg.norm(np.subtract(result.quantities[name], limit[name]))


@pytest.mark.parametrize(
    ("steps", "errors"),
    [
        (Steps(number=4), "all"),
        (Steps(number=10), "all"),
        (Steps(number=10), "auto"),
        (Steps(times=(0.1, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 1)), "all"),
        (Steps(times=(0.1, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 1)), "auto"),
        (Steps(times=(0.5, 0.6, 0.7, 0.8, 0.9, 1)), "auto"),
        (Steps(number=8, automatic=True), "auto"),
    ],
    ids=["4", "10", "10 in 4", "listed", "listed in 4", "pressed at once", "automatic"],
)
def test_estimates_hold_and_are_not_far(steps, errors, limit):
    found = solved(steps, errors)
    ratios = [found.errors[n]["step"] / true_error(found, limit, n) for n in NAMES]
    assert min(ratios) > 0.8, ratios
    assert np.median(ratios) < 10, ratios


def test_a_single_step_is_cut(limit):
    """Pressed and dragged at once: nothing of the path is left to be halved."""
    found = run(with_solver(dragged(Steps(number=1)), errors="auto"), COMM, BODY)
    for name in ("normal_force", "friction_force", "max_slip"):
        estimate = found.errors[name]["step"]
        assert 0.7 * true_error(found, limit, name) < estimate, name


@pytest.mark.parametrize("ends", [False, True])
def test_a_path_that_does_not_end_leaves_the_other_one_to_tell(ends, limit, monkeypatch):
    """With more safety; where no path ends there is no bar, and a sentence."""
    again, paths = load_steps.steps_again, []

    def first_alone(*arguments):
        paths.append(arguments)
        return again(*arguments) if ends and len(paths) == 1 else None

    with monkeypatch.context() as patched:
        patched.setattr(load_steps, "steps_again", first_alone)
        found = solved(Steps(number=4))
    assert len(paths) == 2
    row = found.errors["friction_force"]
    if not ends:
        assert row["step"] is None and any("load steps" in note for note in found.error_notes)
        return
    assert row["step"] > true_error(found, limit, "friction_force")
    assert row["step"] < 6 * solved(Steps(number=4)).errors["friction_force"]["step"]


def test_four_times_the_steps_have_a_quarter_of_the_error():
    few, many = (solved(Steps(number=n)).errors["friction_force"]["step"] for n in (2, 8))
    assert many < 0.25 * few  # of first order, or better


def test_no_other_factorisation_is_made():
    prepared = Run(with_solver(dragged(Steps(number=4)), errors="all"), COMM, BODY)
    assert prepared.solve().model["bulk_factorisations"] == 1
    assert prepared.end.budget.quantities["normal_force"]["step"] > 0


def test_bodies_that_slide_far_remember_without_friction():
    """They are paired anew after load steps: where these end matters."""
    scene = shoved(Steps(number=6))
    smooth = dataclasses.replace(
        scene, contact=(dataclasses.replace(scene.contact[0], friction_coefficient=0.0),)
    )
    found = run(with_solver(smooth, errors="all"), COMM, two_blocks())
    assert found.errors["normal_force"]["step"] > 0
    assert found.errors["normal_force"]["regularisation"] == 0


def test_a_resumed_history_is_solved_again_from_its_start(tmp_path_factory):
    from fenics_contact.simulation.state_file import StateFile

    folder = COMM.bcast(tmp_path_factory.mktemp("resumed") if COMM.rank == 0 else None)
    scene = with_solver(dragged(Steps(number=6)), errors="all")
    whole = run(scene, COMM, BODY)
    first = Run(scene, COMM, BODY)
    state = StateFile(folder, first.problem)
    stopped = first.solve(state, stopped=lambda: len(first.steps) == 3)
    assert stopped.interrupted and stopped.errors == {}
    second = Run(scene, COMM, BODY)
    state = StateFile(folder, second.problem)
    resumed = second.solve(state, state.load())
    assert times(resumed) == times(whole)
    for name in NAMES:
        for source in ("penalty", "regularisation", "step"):
            expected = whole.errors[name][source]
            size = np.linalg.norm(whole.quantities[name])
            assert resumed.errors[name][source] == pytest.approx(
                expected, rel=1e-4, abs=1e-9 * size
            )


def test_a_path_that_knows_no_other_times_has_no_step_error():
    def path(time):
        if time not in (0.0, 0.5, 1.0):
            raise ValueError("not measured")
        return time

    found = run(with_solver(dragged(Steps(number=2), path=path), errors="all"), COMM, BODY)
    row = found.errors["normal_force"]
    assert row["step"] is None and row["total"] is None and row["penalty"] > 0
    assert any("error by the load steps" in note for note in found.error_notes)


def test_who_is_stopped_meanwhile_keeps_the_answer(monkeypatch):
    from fenics_contact.trust.error_estimates import load_steps as step_errors

    def stop(*arguments):
        raise StoppedError("interrupted")

    monkeypatch.setattr(step_errors, "steps_again", stop)
    result = solved(Steps(number=6))
    assert result.interrupted and result.quantities["normal_force"] > 0


def test_stepsbetween_turns():
    assert between_turns((0.25, 0.5, 0.75, 1.0), (0.0, 0.5, 1.0)) == [[0.25, 0.5], [0.75, 1.0]]
    assert between_turns((0.4, 0.8, 1.0), (0.5,)) == [[0.4, 0.8], [1.0]]
    assert between_turns((1.0, 2.0), (1.0, 11.0)) == [[1.0], [2.0]]
    assert between_turns((1.0,), (0.0, 1.0)) == [[1.0]]
    assert _cut((1.0, 2.0), 2) == [0.5, 1.0, 1.5, 2.0]


def test_other_steps():
    assert _other_steps([[1.0]]) == [[0.5, 1.0], pytest.approx([1 / 3, 2 / 3, 1.0])]
    assert _other_steps([[1.0, 2.0, 3.0]]) == [[1.0, 3.0], [2.0, 3.0]]
    five = [[1.0, 2.0, 3.0, 4.0, 5.0]]
    assert _other_steps(five) == [[1.0, 3.0, 5.0], [2.0, 4.0, 5.0]]
