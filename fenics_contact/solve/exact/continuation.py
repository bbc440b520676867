"""Follow an answer from problems that are easier, with less or more friction than there is.

Without friction, and where nothing can slip, there is one answer for a positive definite W. Between
these and the problem itself bounds of friction are multiplied by a factor that changes in small
steps, and each answer is the start of the next one.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.newton import NewtonRun

# Shares of the way that a step takes: first, at most, and at least, before it is given up.
_FIRST, _LARGEST, _SMALLEST = 1 / 8, 1 / 4, 1 / 256
# Newton steps of a way at most.
_MOST_STEPS = 200
# How many times as large as they are bounds are at most.
_ADHESIVE = 1e3


def no_friction_first(share: float) -> float:
    """Factor of the bounds on the way from no friction."""
    return share


def adhesion_first(share: float) -> float:
    """Factor of the bounds on the way from adhesion."""
    return 1 / max(share, 1 / _ADHESIVE)


def follow(
    equations: NaturalMap,
    factor: Callable[[float], float],
    newton: Callable[[NaturalMap, Array | None], NewtonRun],
) -> tuple[NewtonRun | None, int]:
    """Follow an answer to that of the problem.

    Args:
        equations: Of the problem.
        factor: Of the bounds, at a share of the way from 0 to 1.
        newton: Solves equations from forces, or from their adhesive start.

    Returns:
        The last try on the problem itself, None if none of that was made; and all Newton steps.
    """
    run = newton(equations.with_bounds_times(factor(0.0)), None)
    steps, share, size, last = run.steps, 0.0, _FIRST, None
    forces = run.state.forces if run.converged else np.zeros(len(equations.free))
    while share < 1.0 and size >= _SMALLEST and steps < _MOST_STEPS:
        ahead = min(share + size, 1.0)
        run = newton(equations.with_bounds_times(factor(ahead)), forces)
        steps += run.steps
        last = run if ahead == 1.0 else last
        if run.converged:
            share, forces, size = ahead, run.state.forces, min(2 * size, _LARGEST)
        else:
            size /= 2
    return last, steps
