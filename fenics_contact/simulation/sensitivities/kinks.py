"""Whether an answer has a kink: points that just touch, or that just begin to slip."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.newton.solution import Solution

# Of the largest depth, and of ε: nearer to the edge than this is on it.
_NEAR = 1e-8


def has_kink(problem: Problem, solution: Solution) -> bool:
    """Whether derivatives of an answer are one-sided; collective.

    Args:
        problem: In the state of the answer.
        solution: The answer.
    """
    found = [
        _just_touches(contact, state) or _just_slips(contact, state)
        for contact, state in zip(problem.contacts, solution.states, strict=True)
    ]
    return bool(total(problem.comm, sum(found)) > 0)


def _just_touches(contact: ContactSurface, state: ContactState) -> bool:
    """Whether a point that carries nothing is as near as those that do; collective."""
    deepest = largest(contact.spaces.comm, np.maximum(-state.gap, 0.0))
    if not contact.is_one_sided or deepest == 0:
        return False
    return bool((np.abs(state.gap) <= _NEAR * deepest).any())


def _just_slips(contact: ContactSurface, state: ContactState) -> bool:
    """Whether the slip of a point that friction holds is as long as sticking allows."""
    longest = contact.regularisation_parameter
    if not contact.friction.has_friction or not longest:
        return False
    slip = np.linalg.norm(contact.friction.scaled_slip(state.slip), axis=1)
    held = (state.status != OPEN) & (contact.friction_bound > 0)
    return bool((held & (np.abs(slip - longest) <= _NEAR * longest)).any())
