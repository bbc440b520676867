"""The body's scalars under forces are brought to bear before their equations are solved.

Where nothing touches yet, a bolt that is tightened to a force is a mechanism: no value of its
scalar, its shortening, finds a force to balance, and the tangent is singular. So scalars are held
and increased first, until the body pushes back. A value that would give the force between fixed
ends is never too much; where nothing pushes back it is doubled.
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
# Solves with held scalars; each at least doubles the steps of those that are still loose.
_MOST = 30
# Of what releases a scalar between fixed ends, to see how the others follow.
_TRIED = 0.1
# Of the largest force on a scalar so far, below which it has none.
_NONE = 1e-9


def take_up_slack(newton: Newton, last: Solution | None) -> None:
    """Take up the slack of scalars that had no force in the last load step; collective.

    One that is asked for no force, and has none, stays where it is.

    Args:
        newton: At the beginning of a load step.
        last: Of the load step before, if there was one.
    """
    problem, system = newton.problem, newton.system
    scalars = problem.body_scalars
    before = [0.0] * len(scalars) if last is None else [state.force for state in last.scalars]
    largest = max([system.earlier_forces, *(abs(one.force) for one in scalars)], default=0.0)
    for one in scalars:
        one.keep(None)
    free = [number for number, one in enumerate(scalars) if not one.is_locked]
    had_none = {number for number in free if abs(before[number]) <= _NONE * largest}
    idle = {number for number in free if scalars[number].force == 0}
    present = problem.of_body_scalars(system.scalar_values(system.state))
    for number in had_none | idle:
        scalars[number].keep(float(present[number]))
    start = newton.save()
    for chosen, way in ((sorted(had_none - idle), _take_up), (sorted(idle - had_none), _release)):
        if not chosen:
            continue
        try:
            way(newton, chosen)
        except NotConvergedError as error:
            logger.debug("  taking up the slack: %s", error)
            newton.restore(start)
            for number in chosen:
                scalars[number].keep(None)
    for number in had_none - idle:
        scalars[number].keep(None)


def release_held(newton: Newton, found: Solution) -> bool:
    """Have the equation of a scalar solved that was held for no force, and has one.

    Args:
        newton: After a solve.
        found: What it found.

    Returns:
        Whether there is one.
    """
    if not newton.problem.body_scalars:  # nothing to ask the body for
        return False
    limit = max(found.imbalance_limit, found.bulk_round_off)
    again = False
    for scalar, state in zip(newton.problem.body_scalars, found.scalars, strict=True):
        kept = scalar.held is not None and not scalar.is_locked
        if kept and abs(state.force - scalar.force) > limit:
            scalar.keep(None)
            again = True
    return again


def _take_up(newton: Newton, numbers: list[int]) -> None:
    """Increase scalars until something pushes back; collective."""
    chosen = [newton.problem.body_scalars[number] for number in numbers]
    asked = np.array([one.force for one in chosen])
    steps = asked / [one.forces_on_body.stiffness for one in chosen]
    for _ in range(_MOST):
        bears = _forces_after(newton, numbers, steps) / asked >= _BEARS
        if bears.all():
            return
        steps = np.where(bears, 0.0, 2 * steps)


def _release(newton: Newton, numbers: list[int]) -> None:
    """Reduce scalars until no force is left, by secants; collective.

    Those of one joint unload each other: too long a step of one bolt would leave gaps where the
    parts are to touch.

    Raises:
        NotConvergedError: It does not come to that.
    """
    chosen = [newton.problem.body_scalars[number] for number in numbers]
    steps = np.zeros(len(chosen))
    forces = _forces_after(newton, numbers, steps)
    largest = np.abs(forces).max()
    stiffness = np.diag([one.forces_on_body.stiffness for one in chosen])
    if len(chosen) > 1 and largest > 0:
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
    """Forces after a small release of each scalar in turn, and their derivatives; collective.

    Args:
        newton: With these scalars held.
        numbers: Numbers of the scalars.
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
    """Forces on held scalars after steps of their values; collective."""
    for number, step in zip(numbers, steps, strict=True):
        scalar = newton.problem.body_scalars[number]
        scalar.keep((scalar.held or 0.0) + float(step))
    newton.system.follow_supports()
    newton.run()
    return newton.system.scalar_forces[numbers]
