"""Solve a local problem: Newton from the adhesive start, and what helps where that fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact.answer import ExactAnswer
from fenics_contact.solve.exact.continuation import adhesion_first, follow, no_friction_first
from fenics_contact.solve.exact.local_problem import LocalProblem
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.newton import NewtonRun, newton
from fenics_contact.solve.exact.singular import newton_on_singular
from fenics_contact.solve.exact.sweeps import Sweeps

# Sweeps of Gauss-Seidel before each further try of Newton's method.
_SWEEPS = (3, 10, 40, 200, 1000)


def solve(
    problem: LocalProblem, start: Array | None = None, is_patient: bool = True
) -> ExactAnswer:
    """Find forces that satisfy the laws of all points.

    Newton's method begins at the given start, then at the adhesive one. Where it fails, it begins
    again after some sweeps of Gauss-Seidel, then follows answers from other coefficients of
    friction, then begins after more and more sweeps. The result is an answer, or the state with the
    smallest residual of all that were tried; then ``converged`` is False.

    Args:
        problem: W, q and the laws.
        start: Forces to begin with, such as those of an answer nearby, (rows,) (force); values of
            the scalars in their rows.
        is_patient: Whether to begin after more and more sweeps. Who can take a smaller load step in
            place of it is done sooner without.

    >>> import numpy as np
    >>> from fenics_contact.solve.exact import LocalProblem, PointLaws
    >>> compliance = np.linalg.inv([[2.0, 1.0], [1.0, 1.0]])
    >>> loads = np.array([0.5, 0.6])
    >>> laws = PointLaws(np.array([0.5]))
    >>> answer = solve(LocalProblem(compliance, -compliance @ loads, laws))
    >>> answer.converged, str(answer.statuses[0])
    (True, 'OPEN')
    """
    tries = _Tries(problem)
    begin = None if start is None else tries.scaled_start(start)
    if begin is not None and tries.newton(begin, "from the given start"):
        return tries.answer()
    if tries.newton(None, "from the adhesive start"):
        return tries.answer()
    sweeps = Sweeps(tries.equations)
    if tries.sweep(sweeps, _SWEEPS[0]) or tries.follow():
        return tries.answer()
    for number in _SWEEPS[1:] if is_patient else ():
        if tries.sweep(sweeps, number):
            break
    return tries.answer()


class _Tries:
    """Tries of Newton's method on a problem, and the best of them."""

    def __init__(self, problem: LocalProblem) -> None:
        self.problem, self.equations = problem, NaturalMap(problem)
        self.best: NewtonRun | None = None
        self.sweeps = self._steps = 0
        self._swept: Array | None = None
        self._way, self._least = "", np.inf

    def scaled_start(self, start: Array) -> Array:
        """Forces to begin with, in scaled units, without those that are given."""
        equations = self.equations
        found = self.problem.scaling.scaled_forces(start)
        found[: equations.count : equations.dimension][equations.given] = 0.0
        return found

    def newton(self, start: Array | None, way: str) -> bool:
        """Try once; whether it converged."""
        return self._keep(self._try(self.equations, start), way)

    def sweep(self, sweeps: Sweeps, number: int) -> bool:
        """Sweep from where the sweeps before have ended, and try again; whether it converged."""
        if self._swept is None:
            assert self.best is not None
            self._swept = self.best.state.forces
        self._swept = sweeps.run(self._swept, number)
        self.sweeps += number
        return self.newton(self._swept, f"after {self.sweeps} sweeps of Gauss-Seidel")

    def follow(self) -> bool:
        """Follow answers from no friction, then from adhesion; whether one led to an answer."""
        ways = ((no_friction_first, "from no friction"), (adhesion_first, "from adhesion"))
        for factor, words in ways:
            run, steps = follow(self.equations, factor, self._try)
            self._steps += steps - (run.steps if run is not None else 0)
            if run is not None and self._keep(run, f"by continuation {words}"):
                return True
        return False

    def _try(self, equations: NaturalMap, start: Array | None) -> NewtonRun:
        """Newton's method; where W is singular at the points in contact, with the least forces."""
        scaling, before = self.problem.scaling, 0
        if not scaling.is_singular:
            run = newton(equations, start)
            if not run.is_singular:
                return run
            before = run.steps
        run = newton_on_singular(equations, start)
        scaling.is_singular |= run.converged
        return replace(run, steps=run.steps + before)

    def _keep(self, run: NewtonRun, way: str) -> bool:
        """Count a try, and keep it if it is the best so far; whether it converged."""
        self._steps += run.steps
        error = 0.0 if run.converged else run.state.error
        if self.best is None or error < self._least:
            self.best, self._way, self._least = run, way, error
        return run.converged

    def answer(self) -> ExactAnswer:
        """Return the best of the tries."""
        run = self.best
        assert run is not None
        counts = (self._steps, self.sweeps, run.converged)
        return ExactAnswer(self.problem, self.equations, run.state, *counts, self._way)
