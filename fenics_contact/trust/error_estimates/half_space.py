"""Errors by the piece of a half-space that is meshed: what its boundary leaves out.

The outer boundary moves as under the resultants of the contacts' forces. Here it moves as under
the forces where they act: with their moments, also those of friction that has no resultant. That
is the half-space's displacement but for what the change itself does to the forces, which is
smaller by as much again.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import gather_rows
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.error_estimates.solving_again import Measure, differences, last_step_again


def domain_errors(load_steps: LoadSteps, measure: Measure) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by the truncation; collective.

    Args:
        load_steps: Of a scene with a half-space, at its end; it is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the answer with
        the other boundary was not found.
    """
    assert load_steps.last is not None
    answer = measure(load_steps.last.solution)
    beyond = _left_out(load_steps.problem, load_steps.last.solution)
    time = load_steps.time

    def move_boundary(problem: Problem) -> None:
        assert problem.far_field is not None
        problem.far_field.beyond[:] = beyond
        problem.set_time(time)

    return differences(answer, last_step_again(load_steps, measure, move_boundary))


def _left_out(problem: Problem, solution: Solution) -> Array:
    """Displacement of the outer boundary that the resultants leave out, (dofs,); collective."""
    far_field = problem.far_field
    assert far_field is not None
    found = np.zeros(len(far_field.dofs))
    components = problem.spaces.components
    pairs = zip(problem.contacts, solution.contact_force, strict=True)
    for number, (contact, force) in enumerate(pairs):
        rows = np.zeros((len(contact.nodes), 6))
        rows[:, :3] = problem.spaces.coordinates[contact.nodes]
        rows[:, 3 : 3 + components] = force
        rows = gather_rows(problem.comm, rows[contact.owned_nodes & force.any(axis=1)])
        found += far_field.left_out(number, rows[:, :3], rows[:, 3:])
    return found
