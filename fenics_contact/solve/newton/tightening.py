"""Preloads brought to bear before their equations are solved.

Where nothing touches yet, a bolt that is tightened to a force is a mechanism: no shortening of it
finds a force to balance, and the tangent is singular. So shortenings are held and increased first,
until the parts between the bolt's ends push back. A shortening that would give the force between
fixed ends is never too much; where nothing pushes back it is doubled.
"""

from __future__ import annotations

import logging

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution

logger = logging.getLogger(__name__)

# Of the force asked for, from which something pushes back.
_BEARS = 1e-3
# Solves with held shortenings; each at least doubles those of bolts that are still loose.
_MOST = 30
# Of what releases a bolt between fixed ends, to see how the others follow.
_TRIED = 0.1
# Of the largest force of a bolt so far, below which it has none.
_NONE = 1e-9


def tighten(newton: Newton, last: Solution | None) -> None:
    """Take up the slack of preloads that had no force in the last load step; collective.

    One that is asked for no force, and has none, stays where it is.

    Args:
        newton: At the beginning of a load step.
        last: Of the load step before, if there was one.
    """
    problem, system = newton.problem, newton.system
    before = [0.0] * len(problem.preloads) if last is None else [s.force for s in last.preloads]
    largest = max([system.earlier_forces, *(abs(p.force) for p in problem.preloads)], default=0.0)
    for preload in problem.preloads:
        preload.keep(None)
    free = [number for number, preload in enumerate(problem.preloads) if not preload.is_locked]
    had_none = {number for number in free if abs(before[number]) <= _NONE * largest}
    idle = {number for number in free if problem.preloads[number].force == 0}
    present = problem.of_preloads(system.scalar_values(system.state))
    for number in had_none | idle:
        problem.preloads[number].keep(float(present[number]))
    start = newton.save()
    for chosen, way in ((sorted(had_none - idle), _take_up), (sorted(idle - had_none), _release)):
        if not chosen:
            continue
        try:
            way(newton, chosen)
        except NotConvergedError as error:
            logger.debug("  taking up the slack of preloads: %s", error)
            newton.restore(start)
            for number in chosen:
                problem.preloads[number].keep(None)
    for number in had_none - idle:
        problem.preloads[number].keep(None)


def let_go(newton: Newton, found: Solution) -> bool:
    """Have the equation of a preload solved that was held for no force, and has one.

    Args:
        newton: After a solve.
        found: What it found.

    Returns:
        Whether there is one.
    """
    if not newton.problem.preloads:  # nothing to ask the body for
        return False
    limit = max(found.imbalance_limit, found.bulk_round_off)
    again = False
    for preload, state in zip(newton.problem.preloads, found.preloads, strict=True):
        kept = preload.held is not None and not preload.is_locked
        if kept and abs(state.force - preload.force) > limit:
            preload.keep(None)
            again = True
    return again


def _take_up(newton: Newton, numbers: list[int]) -> None:
    """Increase shortenings until something pushes back; collective."""
    bolts = [newton.problem.preloads[number] for number in numbers]
    asked = np.array([bolt.force for bolt in bolts])
    steps = asked / [bolt.bulk.stiffness for bolt in bolts]
    for _ in range(_MOST):
        bears = _forces_after(newton, numbers, steps) / asked >= _BEARS
        if bears.all():
            return
        steps = np.where(bears, 0.0, 2 * steps)


def _release(newton: Newton, numbers: list[int]) -> None:
    """Reduce shortenings until no force is left, by secants; collective.

    Bolts of one joint unload each other: too long a step of one would leave gaps where the parts
    are to touch.

    Raises:
        NotConvergedError: It does not come to that.
    """
    bolts = [newton.problem.preloads[number] for number in numbers]
    steps = np.zeros(len(bolts))
    forces = _forces_after(newton, numbers, steps)
    largest = np.abs(forces).max()
    stiffness = np.diag([bolt.bulk.stiffness for bolt in bolts])
    if len(bolts) > 1 and largest > 0:
        forces, stiffness = _stiffnesses(newton, numbers, forces, np.diag(stiffness))
    for _ in range(_MOST):
        if np.abs(forces).max() <= newton.problem.scene.solver.tolerance * largest:
            return
        steps = np.linalg.solve(stiffness, -forces)
        before, forces = forces, _forces_after(newton, numbers, steps)
        if not steps.any():
            continue
        missed = forces - before - stiffness @ steps  # C. G. Broyden, 1965
        better = stiffness + np.outer(missed, steps) / (steps @ steps)
        if np.linalg.eigvalsh(better + better.T).min() > 0:
            stiffness = better
    raise NotConvergedError("a preload is not released")


def _stiffnesses(
    newton: Newton, numbers: list[int], forces: Array, own: Array
) -> tuple[Array, Array]:
    """Forces after a small release of each bolt in turn, and their derivatives; collective.

    Args:
        newton: With these bolts held.
        numbers: Of the bolts.
        forces: That they have.
        own: Stiffness of each between fixed ends (force/length).
    """
    columns = []
    for place in range(len(numbers)):
        steps = np.zeros(len(numbers))
        steps[place] = -_TRIED * (forces[place] or np.abs(forces).max()) / own[place]
        before, forces = forces, _forces_after(newton, numbers, steps)
        columns.append((forces - before) / steps[place])
    found = np.array(columns).T
    is_stable = np.linalg.eigvalsh(found + found.T).min() > 0
    return forces, found if is_stable else np.diag(own)


def _forces_after(newton: Newton, numbers: list[int], steps: Array) -> Array:
    """Forces of held bolts after steps of their shortenings; collective."""
    for number, step in zip(numbers, steps, strict=True):
        bolt = newton.problem.preloads[number]
        bolt.keep((bolt.held or 0.0) + float(step))
    newton.system.follow_supports()
    newton.run()
    return newton.system.along_parts[numbers]
