"""Answer of the exact solver: forces, gaps, statuses, and how it was found."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array, Words
from fenics_contact.contact.state import OPEN, SLIP, STICK
from fenics_contact.solve.exact.local_problem import LocalProblem
from fenics_contact.solve.exact.natural_map import NaturalMap, PointState


@dataclass(frozen=True, eq=False)
class ExactAnswer:
    """Forces and gaps that satisfy the laws of all points, or come as near as was found.

    Attributes:
        problem: That it answers.
        equations: Of the problem, in scaled units.
        state: Of the points, in scaled units.
        steps: Newton steps, with those of tries that failed.
        sweeps: Of Gauss-Seidel.
        converged: Whether all laws are satisfied to rounding.
        way: How it was found, in words.
    """

    problem: LocalProblem
    equations: NaturalMap
    state: PointState
    steps: int
    sweeps: int
    converged: bool
    way: str

    @cached_property
    def forces(self) -> Array:
        """Forces r, (rows,) (force); values of the scalars in their rows."""
        return self.problem.scaling.forces(self.equations.whole(self.state.forces))

    @cached_property
    def gaps(self) -> Array:
        """Gaps and slips v = W r + q that are left, (rows,) (length)."""
        return np.asarray(self.problem.compliance @ self.forces + self.problem.free)

    @cached_property
    def statuses(self) -> Words:
        """OPEN, STICK or SLIP, (points,); points without friction slip where they touch."""
        equations, state = self.equations, self.state
        sticks = state.sticks | equations.bonded
        return np.where(state.closed, np.where(sticks, STICK, SLIP), OPEN)

    @property
    def residual(self) -> float:
        """Largest violation of the laws, over the largest force; 0 where nothing touches.

        A violation is r − Π(r − v), with gaps and slips made forces by the compliance of each point
        (``natural_map``).
        """
        scale = self.equations.scale(self.state)
        return self.state.error / scale if scale > 0 else self.state.error
