"""Other answers of contacts that conduct the better, the more they are pressed.

A body that expands by heat may press on the one that it gets it from, or stand apart and stay
cold; between both there is then a third answer, which nothing real stays in (J. R. Barber,
J. Dundurs and M. Comninou, J. Appl. Mech. 47 (1980) 871-874, for a rod between walls).
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator

import numpy as np

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution

logger = logging.getLogger(__name__)

# Of the largest conductance: where a solution has those of a known answer to this, it has nearly
# the temperatures of that answer from the next solve on, and leads there.
_NEAR = 1e-2
# Of the highest pressure: where the search for the turning pressure begins; and how long it goes.
_LOWEST, _HALVINGS = 1e-6, 16


def other_temperatures(load_steps: LoadSteps) -> Iterator[tuple[str, Solution | None]]:
    """Solve a single load step from other temperatures; collective.

    From those of contacts that are pressed as much as any of their conductances says; and where the
    scene asks for other answers, and one was found, from the pressure between that neither falls
    nor rises.

    Args:
        load_steps: At their end; all is there again when all starts have been tried.

    Yields:
        The start in words and the solution, as ``trust.branches.other_solutions`` does.
    """
    problem, last = load_steps.problem, load_steps.last
    conduction = problem.conduction
    assert conduction is not None and last is not None
    known, high = [last.solution], conduction.highest_pressure

    def leads_to_known(found: Solution) -> bool:
        return any(conduction.change(one.states, found.states) < _NEAR for one in known)

    try:
        for place, pressure in enumerate((high, None)):
            asked = _turning_pressure(load_steps, last.time, high) if pressure is None else pressure
            start = f"contacts pressed by {asked:.3g}"
            found = _solved(load_steps, last.time, asked, leads_to_known)
            if found is None or not leads_to_known(found):
                known += [] if found is None else [found]
                yield start, found
            if not problem.scene.solver.branches or len(known) == place + 1:
                return
    finally:
        load_steps.go_back_to(last)


def _turning_pressure(load_steps: LoadSteps, time: float, high: float) -> float:
    """The pressure below which contacts come apart, and above which they press harder; collective.

    Args:
        load_steps: Of a single step.
        time: Of that.
        high: A pressure above it.
    """
    low = _LOWEST * high
    for _ in range(_HALVINGS):
        middle = float(np.sqrt(low * high))
        try:
            found = load_steps.try_first_step(time, middle, lambda _: True)
        except NotConvergedError:
            return middle
        low, high = (low, middle) if _mean_pressure(load_steps, found) > middle else (middle, high)
    return float(np.sqrt(low * high))


def _mean_pressure(load_steps: LoadSteps, found: Solution) -> float:
    """Mean pressure of contacts that conduct; collective (stress)."""
    conduction = load_steps.problem.conduction
    assert conduction is not None
    rows = [
        [one.contact.trace.integral(state.contact_pressure), one.contact.trace.area]
        for one, state in zip(conduction.contacts, conduction.states_of(found.states), strict=True)
    ]
    force, area = np.sum(rows, axis=0)
    return float(force / area)


def _solved(
    load_steps: LoadSteps, time: float, pressure: float, ends: Callable[[Solution], bool]
) -> Solution | None:
    try:
        found = load_steps.try_first_step(time, pressure, ends)
    except NotConvergedError as error:
        logger.debug("  from contacts pressed by %.3g: %s", pressure, error)
        return None
    found.find_body()
    return found
