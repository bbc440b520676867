"""Semismooth Newton with full steps and nothing that keeps it from cycling, to compare with."""

from __future__ import annotations

import numpy as np

from fenics_contact.solve.exact import LocalProblem
from fenics_contact.solve.exact.active_system import adhesive_rows, friction_rows, linearised
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.newton import TOLERANCE


def plain_newton(problem: LocalProblem, most: int = 30) -> tuple[int, float, bool]:
    """Newton's method from the adhesive start.

    Args:
        problem: W, q and the laws.
        most: Steps at most.

    Returns:
        Steps, the residual over the largest force, and whether it converged.
    """
    equations = NaturalMap(problem)
    state = equations.at(np.zeros(len(problem.free)))
    closed, friction, residual = state.closed, adhesive_rows(equations), np.inf
    if problem.scalars:
        closed = np.ones_like(closed)
    for step in range(1, most + 1):
        system = linearised(equations, closed, friction)
        if system is None:
            return step, residual, False
        forces = np.zeros(len(problem.free))
        forces[system.rows] = system.solve(system.right)
        state = equations.at(forces)
        scale = equations.scale(state)
        residual = state.error / scale if scale > 0 else state.error
        if residual <= TOLERANCE:
            return step, residual, True
        closed, friction = state.closed, friction_rows(equations, state)
    return most, residual, False
