"""Solve a local problem: Newton from the adhesive start, and what helps where that fails."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact.answer import ExactAnswer
from fenics_contact.solve.exact.local_problem import LocalProblem
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.newton import NewtonRun, newton
from fenics_contact.solve.exact.singular import newton_on_singular
from fenics_contact.solve.exact.sweeps import Sweeps

# Sweeps of Gauss-Seidel before each further try of Newton's method.
_SWEEPS = (3, 10, 40, 200, 1000)


def solve(problem: LocalProblem, start: Array | None = None) -> ExactAnswer:
    """Find forces that satisfy the laws of all points.

    Newton's method from the given start, else from the adhesive one; where it fails, sweeps of
    Gauss-Seidel before each further try. It ends in an answer, or in the state with the smallest
    residual of all that were tried; then ``converged`` is False.

    Args:
        problem: W, q and the laws.
        start: Forces to begin with, such as those of an answer nearby, (rows,) (force); values of
            the scalars in their rows.

    >>> import numpy as np
    >>> compliance = np.linalg.inv([[2.0, 1.0], [1.0, 1.0]])
    >>> loads = np.array([0.5, 0.6])
    >>> laws = PointLaws(np.array([0.5]))
    >>> answer = solve(LocalProblem(compliance, -compliance @ loads, laws))
    """
    tries = _Tries(problem)
    begin = None if start is None else tries.scaled_start(start)
    if begin is not None and tries.newton(begin, "from the given start"):
        return tries.answer()
    if tries.newton(None, "from the adhesive start"):
        return tries.answer()
    sweeps, forces = Sweeps(tries.equations), tries.forces
    for number in _SWEEPS:
        forces = sweeps.run(forces, number)
        tries.sweeps += number
        if tries.newton(forces, f"after {tries.sweeps} sweeps of Gauss-Seidel"):
            break
    return tries.answer()


class _Tries:
    """Tries of Newton's method on a problem, and the best of them."""

    def __init__(self, problem: LocalProblem) -> None:
        self.problem, self.equations = problem, NaturalMap(problem)
        self.best: NewtonRun | None = None
        self.sweeps = self._steps = 0
        self._way, self._least = "", np.inf

    def scaled_start(self, start: Array) -> Array:
        """Forces to begin with, in scaled units, without those that are given."""
        equations = self.equations
        found = self.problem.scaling.scaled_forces(start)
        found[: equations.count : equations.dimension][equations.given] = 0.0
        return found

    @property
    def forces(self) -> Array:
        """Forces of the best try, in scaled units."""
        assert self.best is not None
        return self.best.state.forces

    def newton(self, start: Array | None, way: str) -> bool:
        """Try once; whether it converged."""
        scaling = self.problem.scaling
        if not scaling.is_singular:
            run = newton(self.equations, start)
            self._keep(run, way)
            if not run.is_singular:
                return run.converged
        run = newton_on_singular(self.equations, start)
        scaling.is_singular |= run.converged
        self._keep(run, f"{way}, with the least forces of several")
        return run.converged

    def _keep(self, run: NewtonRun, way: str) -> None:
        self._steps += run.steps
        error = 0.0 if run.converged else run.state.error
        if self.best is None or error < self._least:
            self.best, self._way, self._least = run, way, error

    def answer(self) -> ExactAnswer:
        """Return the best of the tries."""
        run = self.best
        assert run is not None
        counts = (self._steps, self.sweeps, run.converged)
        return ExactAnswer(self.problem, self.equations, run.state, *counts, self._way)
