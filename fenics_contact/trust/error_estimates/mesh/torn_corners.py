"""Errors of what does converge where prescribed displacements jump: that is of first order.

Where an obstacle ends at a support and asks a node of both for another displacement than the
support does, the node follows the support. So what should be a jump there rises along the first
cell of the contact: it is known to a cell where it lies. The last load step is solved again with
that node at the obstacle, so that the rise is along the support's first cell instead. Of two
supports, the node follows the other one; beside a step of a support's function, what it is past it.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.convergence.support_steps import past_steps
from fenics_contact.trust.error_estimates.solving_again import Measure, differences, last_step_again

# Over the largest displacement: what is less is no jump.
_NONE = 1e-6
# For what is not the leading order.
_SAFETY = 1.25


def torn_errors(load_steps: LoadSteps, measure: Measure) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by jumps; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the answer with
        those nodes moved was not found.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    answer = measure(solution)
    missed = _missed(problem, solution.displacement, load_steps.time)
    scale = largest(problem.comm, np.abs(solution.displacement).ravel())
    if largest(problem.comm, np.abs(missed).ravel()) <= _NONE * scale:
        return dict.fromkeys(answer, 0.0)

    def follow_others(problem: Problem) -> None:
        problem.prescribed = problem.prescribed + missed.reshape(-1)[problem.constrained]

    return differences(answer, last_step_again(load_steps, measure, follow_others), _SAFETY)


def _missed(problem: Problem, displacement: Array, time: float) -> Array:
    """Return how far held nodes are from where others want them (length); collective."""
    missed = np.zeros_like(displacement)
    for contact in problem.contacts:
        if contact.has_penalty and not contact.kinematics.faces_body:
            missed += _to_obstacle(contact, displacement)
    missed[problem.free] = 0.0
    flat, present = missed.reshape(-1), displacement.reshape(-1)
    for support in problem.supports.applied:
        away = support.values * support.path(time) - present[support.dofs]
        flat[support.dofs] = np.where(away != 0, away, flat[support.dofs])
    return missed + past_steps(problem, time)


def _to_obstacle(contact: ContactSurface, displacement: Array) -> Array:
    """From where nodes are to where an obstacle lets them be, at the body's nodes; collective."""
    kinematics, nodes, trace = contact.kinematics, contact.nodes, contact.trace
    motion = kinematics.indentation * kinematics.direction + kinematics.displacement
    away = motion - displacement[nodes]
    gap = kinematics.whole_gap()[: len(nodes)]
    away[~np.isfinite(gap)] = 0.0
    if contact.is_one_sided:
        normals = trace.normals[: len(nodes)]
        entered = -np.where(np.isfinite(gap), gap, 0.0) - np.einsum("ni,ni->n", normals, away)
        away = -np.maximum(entered, 0.0)[:, None] * normals
    whole = np.zeros((len(trace.all_nodes), trace.normals.shape[1]))
    whole[trace.numbers] = away
    return trace.surface.on_body(whole)
