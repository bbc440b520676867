"""Newton's method by PETSc's SNES (paper, Section 4), and other ways where it gets nowhere."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError, StoppedError
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.at_points.exact_step import ExactSolver
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.finite.finite_system import FiniteSystem
from fenics_contact.solve.finite.nested_solver import NestedSolver
from fenics_contact.solve.globalisation import (
    ENERGY_SEARCH,
    ON_THE_WAY,
    THOROUGH_SEARCH,
    PenaltyPath,
    SpringControl,
)
from fenics_contact.solve.initial_guess import Beginning
from fenics_contact.solve.newton_failure import lost_in_roundoff, runaway
from fenics_contact.solve.snes_solve import IN_FULL, IN_FULL_AT_LAST_STEP, SnesSolve
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.solve.systems.system import System

logger = logging.getLogger(__name__)

# Imbalance that is left of a rough solve under springs, over that which would be without them.
_SPRUNG = 0.1


class Newton(SnesSolve):
    """Solves of a problem, each from where the last ended; other ways are tried where one fails.

    Attributes:
        begin: Where the next solve begins.
        softened: Whether the last solve took softer penalties first: its start is a bad one.
        exact: Solves the laws of contacts exactly, where the scene asks for that.
        nested: Solves load steps in finite strains; None of small strains.

    Args:
        problem: The problem.
        system: Its unknowns and their balance.
        timings: Seconds so far.
        stopped: Whether this rank was asked to stop; asked before every Newton step.
    """

    def __init__(
        self,
        problem: Problem,
        system: System,
        timings: Timings,
        stopped: Callable[[], bool] | None = None,
    ) -> None:
        super().__init__(problem, system, timings, stopped)
        self.softened = self._is_held = False
        self.begin = Beginning(problem, system, timings)
        self.nested = system.nested if isinstance(system, FiniteSystem) else None
        self.exact: ExactSolver | None = None
        acts = any(contact.forces.terms for contact in problem.contacts)
        if acts and problem.scene.is_exact and isinstance(system, CondensedSystem):
            self.exact = ExactSolver(problem, system)

    def run(
        self,
        search_energy: bool | None = None,
        tolerance: float | None = None,
        hopeless: Callable[[int], int] | None = None,
        is_held: bool = False,
    ) -> None:
        """Solve from the present state, with the modes that the contacts' terms have.

        Args:
            search_energy: Search along the steps for the least energy, or take full ones; by
                default search where a contact is one-sided.
            tolerance: Imbalance over the forces to accept; by default the scene's.
            hopeless: Asked before every step, by the number of those so far, for PETSc's reason to
                give the solve up, 0 to go on; collective.
            is_held: Whether friction or glue holds what contact does not: full steps are cut where
                the imbalance would grow, and springs come only where steps run far.

        Raises:
            NotConvergedError: In words, with the history of the force imbalance.
        """
        self._hopeless, self._is_held, self._cuts_growth = hopeless, is_held, is_held
        self._in_full = IN_FULL_AT_LAST_STEP if self.begin.continues else IN_FULL
        self._tolerance = tolerance or self.problem.scene.solver.tolerance
        self._searches = self._one_sided if search_energy is None else search_energy
        self._search = ENERGY_SEARCH
        self.softened = False
        try:
            self._solve_patiently()
        finally:
            self._hopeless = None  # it may know who asks, and that knows this: a circle
            self._cuts_growth = False
        if self._one_sided:
            left, forces = self.imbalances[-1], self.system.forces
            words = runaway(self.problem, self.system)
            if words is None and left > self._tolerance * forces:  # round-off, as it was taken
                words = lost_in_roundoff(self.problem, left, forces)
            if words is not None:
                raise NotConvergedError(words, tuple(self.imbalances))

    def _solve_patiently(self) -> None:
        """Once; where a search along the steps ends nowhere, once more in another way."""
        start = self.save()
        try:
            self._solve_with_short_steps(start)
        except NotConvergedError:
            if not self._searches:
                raise
            if self._is_nearly_balanced:
                self._searches = False  # so near, a search only follows round-off
            else:
                self._search = THOROUGH_SEARCH
                self._soften(start)
            self._solve()
        springs, tolerated = self._springs, self._tolerance * self.system.forces
        if springs is not None and (springs.held_back or self.imbalances[-1] > tolerated):
            self._take_a_step_without(springs)

    def _solve_with_short_steps(self, start: Array) -> None:
        """With springs where it searches, else where steps run far without them; collective."""
        self._springs, self._ran_far = None, False
        if self._is_held or not (self._searches and self.system.is_sprung):
            try:
                self._solve()
                return
            except NotConvergedError as error:
                if not self._ran_far:
                    raise
                logger.info("%s; next: with springs that keep steps short", error)
                self.restore(start)
                self.problem.stick_all()
        self._springs = SpringControl()
        # Under springs the last step of a rough solve is less exact than one of Newton's own.
        self._tolerance = max(self.problem.scene.solver.tolerance, _SPRUNG * self._tolerance)
        self._solve()

    def _take_a_step_without(self, springs: SpringControl) -> None:
        """One more step, for an answer as exact as one of Newton's own; collective.

        Forces that are balanced leave pressures on small cells, or under a soft penalty, off by
        more; so do forces that the round-off of the way there let pass. Where the step leads away,
        the answer stays as it was found.
        """
        found, imbalances, limit = self.save(), list(self.imbalances), self.limit
        searches, self._searches = self._searches, False
        springs.release()
        self.imbalances.pop()  # it goes on from the same state
        self._fewest = 1
        try:
            self._solve()
        except NotConvergedError:
            self.restore(found)
            self.imbalances[:], self.limit = imbalances, limit
        finally:
            self._searches, self._fewest = searches, 0

    def _soften(self, start: Array) -> None:
        """Go back to the start; find what closes under softer penalties first; collective."""
        self.restore(start)
        self.problem.stick_all()
        path = PenaltyPath(self.problem)
        if self.problem.scene.solver.max_iterations < ON_THE_WAY or not path.exists:
            return
        self.softened, self._most = True, ON_THE_WAY
        try:
            path.follow(self._solve_a_little)
        finally:
            self._most = None
        self.system.take(self.system.state)

    def solve_nested(self, nested: NestedSolver) -> Solution:
        """Solve a load step in finite strains from the present displacement; collective.

        Args:
            nested: Of this problem.

        Raises:
            NotConvergedError: It finds no answer.
        """
        with self.timings.phase("solve"):
            answer = nested.solve(self.require_going_on)
        self.steps += len(answer.history)
        self.imbalances.extend(answer.history)
        self.limit = answer.limit
        found = self.solution(0, answer.way)
        return replace(found, unstable_motions=answer.unstable_motions)

    def solve_exactly(self, exact: ExactSolver, start: Array | None = None) -> Solution:
        """Solve the laws of all contacts exactly, at the present loads; collective.

        Args:
            exact: Of this problem.
            start: Forces to begin with, as of ``ExactSolver.solve``.

        Raises:
            NotConvergedError: It finds no answer.
        """
        with self.timings.phase("solve"):
            answer = exact.solve(start)
        self.steps += answer.steps
        self.imbalances.append(answer.imbalance)
        self.limit = answer.limit
        if not answer.is_found:
            raise NotConvergedError(
                "contact and friction without penalty and smoothing: what is left of their laws is "
                f"{answer.residual:.1e} of the forces after {self.steps} steps, and the force "
                f"imbalance {answer.imbalance:.1e} of {self.system.forces:.3g}",
                tuple(self.imbalances),
            )
        return self.solution(0, answer.way)

    def take_steps(self, most: int) -> None:
        """Take at most so many full steps from the present state; collective.

        They are cut where the imbalance would grow. Whether an answer is found does not matter.
        """
        self._searches, self._springs, self._cuts_growth = False, None, True
        self._in_full = IN_FULL_AT_LAST_STEP if self.begin.continues else IN_FULL
        self._tolerance, self._most = self.problem.scene.solver.tolerance, most
        try:
            self._solve_a_little()
        finally:
            self._cuts_growth, self._most = False, None

    def _solve_a_little(self) -> None:
        """As many steps as are allowed; back to the start where they end nowhere; collective."""
        before = self.save()
        with suppress(NotConvergedError):
            self._solve()
        if not np.isfinite(self.imbalances[-1]):
            self.restore(before)

    def require_going_on(self) -> None:
        """Stop where any rank was asked to; collective.

        Raises:
            StoppedError: On every rank.
        """
        if self._ask_to_stop():
            raise StoppedError("interrupted")

    def save(self) -> Array:
        """The state of this rank, to go back to."""
        return np.array(self.system.state.array_r)

    def restore(self, saved: Array) -> None:
        """Go back to a saved state; collective."""
        with self.system.state as array:
            array[:] = saved
        self.system.take(self.system.state)

    def forget(self) -> None:
        """Reset the count of steps and the imbalances, for another load step."""
        self.imbalances.clear()
        self.steps = 0

    def solution(self, outer_iterations: int = 0, strategy: str = "") -> Solution:
        """The present state as a solution; collective.

        Args:
            outer_iterations: Passes of a loop on the pressure.
            strategy: Which way to Coulomb friction it was.
        """
        problem, system = self.problem, self.system
        with self.timings.phase("solve"):
            find_body = system.finish()
        for contact in problem.contacts:
            contact.touch()
        return Solution(
            find_body=find_body,
            normal_force=[c.forces.of(c.normal_term)[c.trace.numbers] for c in problem.contacts],
            friction_force=[
                c.forces.of(c.friction_term)[c.trace.numbers] for c in problem.contacts
            ],
            friction_bound=[contact.friction.bound.copy() for contact in problem.contacts],
            states=[contact.state() for contact in problem.contacts],
            residual_history=tuple(self.imbalances),
            newton_iterations=self.steps,
            outer_iterations=outer_iterations,
            strategy=strategy,
            imbalance_limit=self.limit,
            factorisations=system.factorisations,
            scalars=system.scalar_states(find_body),
        )
