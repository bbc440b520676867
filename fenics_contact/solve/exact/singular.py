"""Problems in which W is singular at the points in contact: there are more points than dofs.

Contact acts there at points that are no nodes, such as on quadratic triangles, and gaps do not say
how the forces are divided among the points. As ε₁ falls, forces of a penalty, v_n + ε₁ r_n/A = 0,
approach those with the least Σ r²/A. W + δ diag(1/A) is regular. Its answers lead there without any
ε₁: with forces s of the round before, (W + δ diag(1/A)) r + q − δ diag(1/A) s takes the place of
v. Rounds from s = 0 keep diag(1/A) r in the range of W, by which the limit is determined.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.newton import NewtonRun, is_answer, newton

# δ over the compliance of points. The error falls by δ over the least eigenvalue that is not 0 in a
# round, and rounding is magnified by 1/δ.
_ADDED = 1e-5
_MOST_ROUNDS = 40


def added_compliance(equations: NaturalMap) -> Array:
    """δ diag(1/A) in scaled units, (rows,); 0 for scalars."""
    problem, found = equations.problem, np.zeros(len(equations.free))
    weights = np.ones(equations.points) if problem.weights is None else problem.weights
    added = problem.scaling.of_points**2 / weights
    found[: equations.count] = np.repeat(_ADDED * added / added.mean(), equations.dimension)
    return found


def newton_on_singular(equations: NaturalMap, start: Array | None = None) -> NewtonRun:
    """Newton's method on W + δ diag(1/A), in rounds until the laws of W are satisfied.

    Args:
        equations: Of the problem.
        start: Forces to begin with, (rows,), in scaled units; None: as ``newton`` begins.
    """
    added = added_compliance(equations)
    compliance = equations.compliance + np.diag(added)
    run = newton(equations.with_compliance(compliance, equations.free), start)
    steps = run.steps
    for _ in range(_MOST_ROUNDS):
        state = equations.at(run.state.forces)
        done = run.converged and is_answer(equations, state)
        if done or not run.converged:
            break
        free = equations.free - added * state.forces
        run = newton(equations.with_compliance(compliance, free), state.forces)
        steps += run.steps
    return replace(run, state=state, steps=steps, converged=done)
