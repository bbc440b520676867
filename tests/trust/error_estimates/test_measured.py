"""Quantities of an answer by the rows of a condensed body, without what is inside it."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from fenics_contact.problem.loads.disturbance import Disturbance
from fenics_contact.solve.load_steps.load_stepper import stepping
from fenics_contact.trust.error_estimates import measured as module
from fenics_contact.trust.error_estimates.measured import Measured
from fenics_contact.trust.error_estimates.solving_again import last_step_again
from tests.scenes import with_solver
from tests.simulation.studies.cases import CASES

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD


def both(name):
    """Quantities of an answer and of one beside it, by rows and by what is inside."""
    scene, make, _ = CASES[name]
    scene = with_solver(scene, solver="condensed", errors="none")
    problem = Run(scene, COMM, make()).problem
    found = []

    def measure(load_steps):
        carried = Measured(load_steps)(load_steps.last.solution)["strain_energy"]
        waves = 1e-2 * carried * np.sin(1e3 * problem.spaces.coordinates)
        size = problem.spaces.components

        def disturb(problem):
            problem.disturbance = Disturbance.growing(waves[:, :size], 1.0)
            problem.set_time(load_steps.time)

        load_steps.newton.system.precompute_loads([waves[:, :size]])
        for most in (10_000, -1):
            with pytest.MonkeyPatch.context() as patched:
                patched.setattr(module, "_MOST_ROWS", most)
                measured = Measured(load_steps)
                answer = measured(load_steps.last.solution)
                changed = last_step_again(load_steps, measured, disturb)
            found.append((answer, changed))

    with stepping(problem) as load_steps:
        load_steps.solve()
        measure(load_steps)
    return found


@pytest.mark.parametrize("name", ["corners", "half-space", "in space", "two bodies"])
def test_rows_tell_what_the_inside_of_the_body_tells(name):
    by_rows, by_fields = both(name)
    sizes = {key: np.linalg.norm(value) for key, value in by_fields[0].items()}
    round_off = 1e-11 * max(sizes.values())
    for one, other in zip(by_rows, by_fields, strict=True):
        assert one.keys() == other.keys()
        for key, value in other.items():
            assert one[key] == pytest.approx(value, abs=1e-8 * sizes[key] + round_off), key
    assert by_rows[0]["strain_energy"] != pytest.approx(by_rows[1]["strain_energy"], rel=1e-6)
