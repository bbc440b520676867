"""Histories in fewer load steps, and others near by: what they tell of errors."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Path, Run, Steps
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.solver_choice import choose_solver, create_system
from fenics_contact.trust.error_estimates.load_steps import CoarseHistory, _NearPath, _thinned
from fenics_contact.trust.error_estimates.measured import Measured
from fenics_contact.trust.error_estimates.solving_again import steps_again
from tests.scenes import with_solver
from tests.solve.load_steps.histories import block, dragged, shoved, two_blocks

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
TO_AND_FRO = Path(time=(0, 0.2, 0.5, 0.8, 1), factor=(0, 1, 0.4, 1, 0.9))


@pytest.mark.parametrize(
    ("scene", "body"),
    [
        (dragged(Steps(number=6)), block),
        (dragged(Steps(number=5), path=TO_AND_FRO, driven={"force": 5.0}), block),
        (dragged(Steps(number=5), solid=0.499), block),
        (shoved(Steps(number=5)), two_blocks),
    ],
    ids=["obstacle", "force", "nearly incompressible", "bodies that slide"],
)
def test_a_history_that_begins_at_its_own_ends_is_the_same(scene, body):
    """In hardly a step of Newton's method."""
    scene = with_solver(scene, errors="none")
    problem = Problem.on_mesh(scene, body())
    timings = Timings()
    system = create_system(problem, choose_solver(problem), timings)
    load_steps = LoadSteps(Newton(problem, system, timings))
    load_steps.keep_ends()
    load_steps.solve()
    measure = Measured(load_steps)
    answer = measure(load_steps.last.solution)
    times = list(load_steps.ends)
    path, taken = _NearPath(times, load_steps.ends), []

    def near(newton):
        found = path.solve(newton)
        taken.append(found.newton_iterations)
        return found

    again = steps_again(load_steps, measure, times, None, near)
    assert len(taken) == len(times) and max(taken) <= 1
    force = np.abs(answer["normal_force"]).max()
    for key, value in answer.items():
        is_force = any(word in str(key) for word in ("force", "reaction"))
        size = max(np.abs(value).max(), force if is_force else 0.0)
        assert np.abs(np.subtract(again[key], value)).max() <= 1e-6 * size, key
    system.destroy()


def test_errors_by_parameters_are_those_of_all_load_steps():
    """Those by ε are of creep in every step, of which fewer steps have less."""
    scene = dragged(Steps(number=10))
    contact = scene.contact[0]
    large = {"regularisation_parameter": 1e-6, "penalty_parameter": 1e-7}
    found = {}
    for name, changes in (
        ("auto", large),
        ("penalty", large | {"penalty_parameter": 1e-10}),
        ("regularisation", large | {"regularisation_parameter": 1e-9}),
    ):
        changed = dataclasses.replace(scene, contact=(dataclasses.replace(contact, **changes),))
        errors = "auto" if name == "auto" else "none"
        found[name] = Run(with_solver(changed, errors=errors), COMM, block()).solve()
    for source in ("penalty", "regularisation"):
        ratios = {}
        for name in ("normal_force", "friction_force", "strain_energy"):
            true = np.subtract(found["auto"].quantities[name], found[source].quantities[name])
            assert np.linalg.norm(true) > 0
            ratios[name] = found["auto"].errors[name][source] / np.linalg.norm(true)
        assert min(ratios.values()) > 0.7, (source, ratios)
        assert max(ratios.values()) < 6, (source, ratios)
        if source == "penalty":  # that of pressing does not follow the steps
            assert ratios["normal_force"] == pytest.approx(1, rel=0.1)
            assert ratios["strain_energy"] == pytest.approx(1, rel=0.1)


def test_which_load_steps_are_left():
    times = [float(n) for n in range(1, 21)]
    assert _thinned(times[:1]) == [1.0]
    assert _thinned(times[:2]) == [2.0]
    assert _thinned(times[:5]) == [2.0, 5.0]
    assert _thinned(times) == [5.0, 10.0, 15.0, 20.0]
    assert _thinned(times, 0.5) == [2.0, 8.0, 12.0, 20.0]
    assert CoarseHistory.pays([times]) and CoarseHistory.pays([times[:1], times[1:]])
    assert not CoarseHistory.pays([[1.0], [2.0], [3.0, 4.0]])
