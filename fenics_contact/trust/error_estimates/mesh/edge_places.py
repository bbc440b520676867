"""Change of an answer by where the edge of contact lies inside a piece of the surface.

The mesh tells the place of an edge to a piece of the surface. Where answers beside this one are
found by Newton's method, their forces scatter as the edge moves (``load_scatter``). By tangents
alone no point opens or closes. There gaps are widened at the last points that touch, by a part of
the gap at the first ones that do not.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.solving_again import Again

# Part of the gap behind an edge: what covers the forces below parabolas on coarse meshes.
_PART = 0.3
# Of the gap, what is made of it; and of the depths that penalties leave, at the most.
_SHARE, _CLOSED = 1e-6, 0.1


def edge_place_errors(load_steps: LoadSteps, again: Again) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by the places of edges; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        again: How the answer to the last one is found with something changed.

    Returns:
        By quantity: absolute, of vectors the length of the difference; 0 without edges inside
        cells. None where the answer with wider gaps was not found.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    pairs = zip(problem.contacts, solution.states, strict=True)
    wider = [(contact, contact.kinematics.gap, _behind(contact, state)) for contact, state in pairs]
    widest = max((largest(problem.comm, behind) for _, _, behind in wider), default=0.0)
    if widest == 0:
        return dict.fromkeys(again.answer, 0.0)
    again = replace(again, share=_SHARE)

    def widen(share: float, problem: Problem) -> None:
        for contact, gap, behind in wider:
            contact.set_gap(gap + share * behind)

    try:
        return again.effects(widen, factor=_PART)
    finally:
        for contact, gap, _ in wider:
            contact.set_gap(gap)


def _behind(contact: ContactSurface, state: ContactState) -> Array:
    """The gap behind the edge, at the last points that touch before it, (points,) (length)."""
    found = np.zeros(len(state.status))
    if not contact.is_one_sided:
        return found
    points = contact.trace.pieces.points
    closed, gaps = state.status != OPEN, np.where(np.isfinite(state.gap), state.gap, 0.0)
    widest = np.where(closed, 0.0, np.maximum(gaps, 0.0))[points].max(axis=1, initial=0.0)
    np.maximum.at(found, points.ravel(), np.repeat(widest, points.shape[1]))
    # No more than leaves a point closed where that share of it is made.
    depths = _CLOSED * contact.penalty_parameter * np.maximum(state.contact_pressure, 0.0)
    return np.where(closed, np.minimum(found, depths / _SHARE), 0.0)
