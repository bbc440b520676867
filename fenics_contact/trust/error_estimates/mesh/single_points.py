"""Errors of contacts that touch in single points: no piece of the surface between nodes is whole.

How large such a contact is no mesh as coarse can tell, nor how far what touches gives way there: on
this mesh as if the pressure were that of the point's whole share of the surface. Under a pressure p
on a circle of area A a half-space gives way by .96 p √A/E* in the mean (K. L. Johnson, Contact
Mechanics, Cambridge 1985, (3.29)), and beside a strip of width b by about p b/E*. The last load
step is solved again with gaps wider by that: the difference is what is not known.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.solving_again import (
    Measure,
    differences,
    last_step_again,
)


def single_point_errors(load_steps: LoadSteps, measure: Measure) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by such contacts; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        By quantity: absolute, of vectors the length of the difference; 0 without such contacts.
        None where the answer with wider gaps was not found.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    answer = measure(solution)
    pairs = zip(problem.contacts, solution.states, strict=True)
    gives = [(contact, _local_depth(contact, state)) for contact, state in pairs]
    before = [(contact, contact.kinematics.gap, depth) for contact, depth in gives if depth > 0]
    if not before:
        return dict.fromkeys(answer, 0.0)
    time = load_steps.time

    def widen(problem: Problem) -> None:
        problem.set_time(time)
        for contact, gap, depth in before:
            contact.set_gap(gap + depth)

    try:
        return differences(answer, last_step_again(load_steps, measure, widen))
    finally:
        for contact, gap, _ in before:
            contact.set_gap(gap)


def touches_in_points(contact: ContactSurface, state: ContactState) -> bool:
    """Whether it may open and no piece of it touches with all its ends; collective."""
    if not contact.is_one_sided:
        return False
    whole = (state.status != OPEN)[contact.trace.pieces.points].all(axis=1)
    return largest(contact.spaces.comm, whole.astype(float)) == 0


def _local_depth(contact: ContactSurface, state: ContactState) -> float:
    """How far the surface gives way at single points that touch, the largest; collective.

    0 where a piece touches with all its ends, where nothing does, and where gaps cannot open.
    """
    if not touches_in_points(contact, state):
        return 0.0
    trace, spaces = contact.trace, contact.spaces
    closed = state.status != OPEN
    widths = np.sqrt(trace.weights)
    if spaces.components == 2:  # a strip as long as the body is thick; a ring of some width
        lengths = np.abs(trace.surface.factors[trace.numbers])
        if spaces.kinematics == "axisymmetric":  # on the axis a circle
            lengths = np.maximum(lengths, widths)
        widths = trace.weights / lengths
    depths = np.where(closed, state.contact_pressure * widths, 0.0)
    return largest(spaces.comm, depths) / contact.moduli.plane_strain
