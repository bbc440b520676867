"""Semismooth Newton on the laws of the points, with full steps from the adhesive start.

Two rules keep it from cycling between statuses. A point that slips does not turn round within a
step: it sticks first. And where all statuses have been there before, one point alone changes its
status: the one that violates its law most, of those that lead to new statuses.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.solve.exact.active_system import (
    adhesive_rows,
    friction_rows,
    linearised,
)
from fenics_contact.solve.exact.natural_map import NaturalMap, PointState

# Residual over the largest force at which an answer is found.
TOLERANCE = 1e-11
# Of gaps without forces: residuals below are of rounding, where forces are much smaller than these.
_ROUNDING = 1e-15
# Steps of one try. Cycles are noticed earlier.
_MOST_STEPS = 30
# Arrays of a state that say what a step linearises.
_OF_STATUS = ("across", "along", "length", "force", "bound", "slope", "closed", "sticks")


@dataclass(frozen=True, eq=False)
class NewtonRun:
    """One try of Newton's method.

    Attributes:
        state: The last one.
        steps: Factorisations.
        converged: Whether the residual is below the tolerance.
        is_singular: Whether it ended at a singular matrix.
    """

    state: PointState
    steps: int
    converged: bool
    is_singular: bool = False


def newton(equations: NaturalMap, start: Array | None = None, most: int = _MOST_STEPS) -> NewtonRun:
    """Solve the equations of the points.

    Args:
        equations: Of the problem.
        start: Forces to begin with, (rows,), in scaled units; None: what is in the obstacle without
            forces sticks, and with scalars all points.
        most: Steps at most.
    """
    state = equations.at(np.zeros(len(equations.free)) if start is None else start)
    before, known, steps = None, set[bytes](), 0
    has_scalars = len(equations.free) > equations.count
    while True:
        if steps and is_answer(equations, state):
            return NewtonRun(state, steps, True)
        if steps == most:
            return NewtonRun(state, steps, False)
        chosen = _without_known(equations, before, state, known)
        if chosen is None:
            return NewtonRun(state, steps, False)
        is_adhesive = start is None and steps == 0
        friction = adhesive_rows(equations) if is_adhesive else friction_rows(equations, chosen)
        # Scalars, such as the position of an obstacle, decide what is in the obstacle.
        closed = chosen.closed | (is_adhesive and has_scalars)
        system = linearised(equations, closed, friction)
        if system is None:
            return NewtonRun(state, steps, False, is_singular=True)
        forces = np.zeros(len(equations.free))
        forces[system.rows] = system.solve(system.right)
        before, state, steps = chosen, equations.at(forces), steps + 1


def is_answer(equations: NaturalMap, state: PointState) -> bool:
    """Whether residuals are below the tolerance."""
    closed = np.repeat(state.closed, equations.dimension)
    free = np.abs(equations.free[: equations.count][closed]).max(initial=0.0)
    return bool(state.error <= TOLERANCE * equations.scale(state) + _ROUNDING * free)


def _without_known(
    equations: NaturalMap, before: PointState | None, state: PointState, known: set[bytes]
) -> PointState | None:
    """The state to linearise at, with statuses that no step has had; None where there is none.

    Args:
        equations: Of the problem.
        before: That of the step before, None in the first.
        state: At the present forces.
        known: Statuses of all steps before; those chosen are added.
    """
    if before is None:
        return state
    state = _without_reversals(equations, before, state)
    if equations.dimension > 2:
        return state  # directions of slip differ between steps, so that statuses may repeat
    words = statuses(equations, state)
    if words.tobytes() not in known:
        known.add(words.tobytes())
        return state
    old = statuses(equations, before)
    for point in _by_violation(equations, state, words != old):
        words = old.copy()
        words[point] = statuses(equations, state)[point]
        if words.tobytes() not in known:
            known.add(words.tobytes())
            return _with_change(before, state, point)
    return None


def statuses(equations: NaturalMap, state: PointState) -> Integers:
    """0 open, 1 sticks, 2 slips, 3 slips the other way (in the plane), (points,)."""
    ways = 2 + (state.along[:, 0] < 0) if equations.dimension == 2 else 2
    found: Integers = np.where(state.closed, np.where(state.sticks, 1, ways), 0)
    return found


def _without_reversals(equations: NaturalMap, before: PointState, state: PointState) -> PointState:
    """Let points stick that slipped and would now slip in the opposite direction."""
    slips = before.closed & ~before.sticks & state.closed & ~state.sticks & equations.rubs
    turned = slips & (np.einsum("ij,ij->i", before.along, state.along) < 0)
    return replace(state, sticks=state.sticks | turned) if turned.any() else state


def _by_violation(equations: NaturalMap, state: PointState, changed: Flags) -> Integers:
    """Numbers of the points that change, those first that violate their laws most."""
    residual = np.abs(state.residual[: equations.count]).reshape(equations.points, -1)
    numbers = np.flatnonzero(changed)
    return numbers[np.argsort(-residual.max(axis=1)[numbers], kind="stable")]


def _with_change(before: PointState, state: PointState, point: int) -> PointState:
    """The state before, but for the status of one point."""
    arrays = {}
    for name in _OF_STATUS:
        arrays[name] = getattr(before, name).copy()
        arrays[name][point] = getattr(state, name)[point]
    return replace(state, **arrays)
