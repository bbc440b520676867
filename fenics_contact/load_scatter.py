"""How quantities scatter about smooth functions of the load, as edges move through elements."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.contact_area import contact_area, cut_areas, stick_area
from fenics_contact.load_steps import History
from fenics_contact.problem import Problem
from fenics_contact.solution import Solution
from fenics_contact.solving_again import Change, Measure, Quantities, last_step_again

# Share of the last load step that is looked at: Hertz's edge then moves by a tenth of its radius.
_SPAN = 0.3
_LOADS = 8
# Pieces of the surface that an edge is to pass through in that span, at the most: where cells are
# small at the edge alone, those further off have no part in the error.
_PIECES = 8.0
# Of the polynomial in pseudo-time: t^1.5, Hertz's force, differs by 1e-6 from one over the span.
_DEGREE = 3


def load_scatter(
    history: History, measure: Measure, answer: Quantities
) -> dict[Hashable, float] | None:
    """Standard deviation of quantities about polynomials in pseudo-time; collective.

    Args:
        history: At its end; it is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.
        answer: Those at the end.

    Returns:
        By key, of vectors the length over their components; 0 where no edge can move. None where
        too few of the solves converge.
    """
    problem = history.problem
    if not any(contact.is_one_sided or contact.friction for contact in problem.contacts):
        return dict.fromkeys(answer, 0.0)
    assert history.last is not None
    last, before = history.time, history.last.before
    share_of_step = min(_SPAN, _PIECES * _piece_share(problem, history.last.solution))
    span = share_of_step * (last - (before.time if before else 0.0))
    times, rows = [0.0], [answer]
    for share in np.arange(1, _LOADS + 1) / _LOADS:
        found = last_step_again(history, measure, _at(last - span * share))
        if found is not None:
            times.append(-share)
            rows.append(found)
    spare = len(times) - _DEGREE - 1
    if spare < 2:
        return None
    powers = np.vander(np.array(times), _DEGREE + 1)
    smooth = powers @ np.linalg.pinv(powers)
    scatter = {}
    for key in answer:
        values = np.array([np.atleast_1d(row[key]) for row in rows])
        left = values - smooth @ values
        scatter[key] = float(np.sqrt((left**2).sum() / spare))
    return scatter


def _piece_share(problem: Problem, solution: Solution) -> float:
    """What an edge's passing of a piece changes of the area in contact, or that sticks; collective.

    The larger of both, of all contacts.
    """
    shares = [0.0]
    for contact, state in zip(problem.contacts, solution.states, strict=True):
        whole = (contact_area(contact, state), stick_area(contact, state))
        for area, cut in zip(whole, cut_areas(contact, state), strict=True):
            shares.append(cut / area if area > 0 else 0.0)
    return max(shares) or 1.0


def _at(time: float) -> Change:
    def change(problem: Problem) -> None:
        problem.set_time(time)

    return change
