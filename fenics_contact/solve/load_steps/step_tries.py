"""Tries of one load step: from where it is thought to end, or else from where it begins."""

from __future__ import annotations

import logging
from collections.abc import Callable

import numpy as np

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.scene.loading.load_paths import knots
from fenics_contact.solve.coulomb.strategies import solve_step
from fenics_contact.solve.load_steps.accepted_step import Unknowns
from fenics_contact.solve.load_steps.step_rollback import StepRollback
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.slack import release_held
from fenics_contact.solve.newton.solution import Solution

logger = logging.getLogger(__name__)

# Solves a load step from that of another answer; None where that tells nothing of it.
Warm = Callable[[Newton], Solution | None]


class StepTries(StepRollback):
    """A problem between load steps, which tries the next one.

    Attributes:
        warm_steps: How many steps were solved from those of another answer.

    Args:
        newton: Made for the problem, not started.
    """

    def __init__(self, newton: Newton) -> None:
        super().__init__(newton)
        self._knots = knots(self.problem.scene)
        self._guess: Unknowns | None = None
        self._warm: Warm | None = None
        self.warm_steps = 0

    def begin_near(self, guess: Unknowns | None = None, warm: Warm | None = None) -> None:
        """Say where load steps are thought to end; else each begins at the end of the last one.

        Args:
            guess: Of the first one.
            warm: Solves a step from that of another answer of the same body, or gives None where
                that tells nothing of it; collective. It is left where it did not get there.
        """
        self._guess, self._warm = guess, warm

    def _try(self, time: float) -> Solution:
        """Solve a step, from where it is thought to end or else from where it begins."""
        newton = self.newton
        found = None if self._warm is None else self._from_another_answer(time, self._warm)
        if found is not None:
            return found
        predicted = self._prediction(time)
        newton.forget()
        self._begin(time, predicted)
        try:
            return self._solve()
        except NotConvergedError as error:
            if predicted is None:
                raise
            logger.debug("  %s; next: from the last load step, or from the start", error)
        self.go_back()
        self._begin(time, None)
        return self._solve()

    def _from_another_answer(self, time: float, warm: Warm) -> Solution | None:
        """A step as ``warm`` solves it; None, and back at its start, where it does not."""
        problem = self.problem
        if self.last is not None:
            self._move_on(self.last)
        first = np.zeros(len(problem.unknowns))
        problem.reach(first if self.last is None else self.last.unknowns.scalars)
        problem.set_time(time)
        self.newton.forget()
        try:
            found = warm(self.newton)
        except NotConvergedError as error:
            logger.debug("  from another answer: %s; next: from the start", error)
            found = None
        if found is None:
            self._warm = None
            self.go_back()
        else:
            self.warm_steps += 1
        return found

    def _solve(self) -> Solution:
        """A step from its beginning; once more where a scalar that was held has a force."""
        found = solve_step(self.newton)
        return solve_step(self.newton) if release_held(self.newton, found) else found

    def _prediction(self, time: float) -> Unknowns | None:
        """Where the last two steps lead to, if no load path turns on the way.

        Not with the static law: its answers do not go on in straight lines, and a step begins
        nearer to its end without it.
        """
        if self.last is None:
            return self._guess
        if not all(contact.friction.follows_path for contact in self.problem.coulomb):
            return None
        if self.last.before is None:
            return None
        before = self.last.before
        close = 1e-9 * (time - before.time)
        if any(before.time + close < knot < time - close for knot in self._knots):
            return None
        return before.towards(self.last.unknowns, time)
