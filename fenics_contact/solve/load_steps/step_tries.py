"""Tries of one load step: from where it is thought to end, or else from where it begins."""

from __future__ import annotations

import logging
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.loading.load_paths import cycles_of, knots
from fenics_contact.solve.coulomb.monolithic import is_held_by_friction
from fenics_contact.solve.coulomb.strategies import release_held, solve_step, take_up_slack
from fenics_contact.solve.coulomb.without_friction import follow_pressure
from fenics_contact.solve.load_steps.accepted_step import (
    AcceptedStep,
    ContactMemory,
    Unknowns,
    recall,
    recall_pairing,
    remember,
)
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution

logger = logging.getLogger(__name__)

# Of pseudo-times that are the same.
_SAME = 1e-9
# Strategies that have Newton's method on contact and friction together.
_BY_TURNS = ("auto", "monolithic")


class StepRollback:
    """A problem between load steps: begins one, and goes back where it was.

    That slip counts no more, and that two bodies are paired where they stand now, comes before the
    next try: so whoever goes back, in this run or in another one, goes back to the same.

    Attributes:
        newton: Newton's method on the problem.
        problem: The problem.
        last: The last accepted step, None before there is one.

    Args:
        newton: Made for the problem, not started.
    """

    def __init__(self, newton: Newton) -> None:
        self.newton = newton
        self.problem = newton.problem
        self.last: AcceptedStep | None = None
        self._untouched = [remember(contact) for contact in self.problem.contacts]
        self._begins = _begins_of_cycles(self.problem)
        self._has_moved_on = False

    @property
    def time(self) -> float:
        """Pseudo-time of the last accepted step."""
        return self.last.unknowns.time if self.last else 0.0

    def _begin(self, time: float, predicted: Unknowns | None) -> None:
        """Bring all to a pseudo-time; collective."""
        newton, problem = self.newton, self.problem
        if self.last is None:
            problem.reach(np.zeros(len(problem.unknowns)))
            problem.set_time(time)
            newton.begin.anew()
            if predicted is not None:
                self._place(predicted)
                newton.begin.from_last_step()
            take_up_slack(newton, None)
            return
        self._move_on(self.last)
        problem.reach(self.last.unknowns.scalars)
        problem.set_time(time)
        if predicted is not None:
            self._place(predicted)
            if newton.begin.is_out_of_touch():  # an obstacle that turns leaves the straight line
                self._place(self.last.unknowns)
        newton.begin.from_last_step()
        take_up_slack(newton, self.last.solution)

    def _move_on(self, last: AcceptedStep) -> None:
        """From the last step as it was solved to the beginning of the next one; collective."""
        if self._has_moved_on:
            return
        for contact in self.problem.contacts:
            contact.accept()
            if self._begins_cycle(last.unknowns.time):
                contact.last_step.begin_cycle()
            # A guess of what the next step needs.
            follow_pressure(contact, last.solution.imbalance_limit)
        self.newton.begin.update_pairing(last.solution)
        self._has_moved_on = True

    def _begins_cycle(self, time: float) -> bool:
        return bool(np.any(np.abs(self._begins - time) <= _SAME * self._begins))

    def go_back(self) -> None:
        """To the last accepted step as it was solved, or to none; collective."""
        conduction = self.problem.conduction
        if conduction is not None:
            conduction.recall(None if self.last is None else self.last.heat)
        if conduction is not None or self.last is not None:
            self._follow_temperature(self.time)
        self._go_back()

    def _go_back(self) -> None:
        """The same at the temperatures that there are; collective."""
        problem = self.problem
        self._has_moved_on = False
        if self.last is None:
            self._recall(self._untouched)
            return
        unknowns = self.last.unknowns
        problem.reach(unknowns.scalars)
        problem.set_time(unknowns.time)
        self._recall(self.last.contacts)
        self._place(unknowns)
        problem.displacement.x.array[:] = unknowns.displacement.reshape(-1)
        for contact in problem.contacts:  # also of those that exert no forces
            contact.kinematics.move(contact.kinematics.relative(unknowns.displacement))

    def _follow_temperature(self, time: float) -> None:
        """Take the body at present temperatures, with what follows from them; collective.

        Args:
            time: Pseudo-time of those that are given.
        """
        if not self.problem.follows_temperature:
            return
        system = self.newton.system
        if self.problem.follow_temperature(time):
            logger.debug("  moduli follow the temperature: the body is factorised anew")
            system.follow_bulk()
        elif self.problem.conduction is not None:
            system.follow_scalar_forces()

    def go_back_to(self, step: AcceptedStep) -> None:
        """To a load step that was accepted, from a later one; collective."""
        self.last = step
        self.go_back()

    def _recall(self, memories: list[ContactMemory]) -> None:
        """Take the contacts back to what is kept of them, and their pairing; collective."""
        pairs = list(zip(self.problem.contacts, memories, strict=True))
        if any([recall_pairing(contact, memory) for contact, memory in pairs]):
            self.newton.begin.follow_pairing()
        for contact, memory in pairs:
            recall(contact, memory)

    def _place(self, unknowns: Unknowns) -> None:
        mixed = self.problem.elastic.mixed
        if mixed is not None:
            mixed.mean_stress.x.array[:] = unknowns.mean_stress
        self.newton.begin.at(unknowns.position_in(self.newton.system), unknowns.scalars)


def _begins_of_cycles(problem: Problem) -> Array:
    """Pseudo-times at which cycles of loads begin, but for the start."""
    cycles = cycles_of(problem.scene)
    starts = () if cycles is None else cycles.repetition.starts
    return np.array([time for time in starts if time > 0])


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
        self._near: Unknowns | None = None  # of the same step, at other temperatures
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
        """Solve a step; again where its pressures change temperatures; collective."""
        *_, found = self._solutions(time)
        return found

    def _solutions(self, time: float) -> Generator[Solution]:
        """Solve a step at one temperature after the other, until these have settled; collective."""
        conduction, steps = self.problem.conduction, 0
        if conduction is not None:
            conduction.set_time(time)
            conduction.begin()
        self._follow_temperature(time)
        try:
            while True:
                found = self._try_at_temperatures(time)
                steps += found.newton_iterations
                yield replace(found, newton_iterations=steps)
                if conduction is None or not conduction.follow(found.states):
                    return
                logger.debug("  time %g: temperatures follow the contact pressures", time)
                self._near = self._present(time)
                self._go_back()
                self._follow_temperature(time)
        finally:
            self._near = None

    def settled(self, solve: Callable[[], Solution], share: float = 1.0) -> Solution:
        """Solve the present load step with temperatures that follow its pressures; collective.

        Args:
            solve: Solves it at temperatures that are held, from where the problem is.
            share: Of the change of conductances that counts as none, what is to be left of it.

        Raises:
            NotConvergedError: ``solve`` does, or temperatures have changed for too long.
        """
        conduction = self.problem.conduction
        if conduction is None:
            return solve()
        conduction.begin()
        while True:
            self._follow_temperature(self.time)
            self.newton.system.follow_supports()
            found = solve()
            if not conduction.follow(found.states, share):
                return found

    def try_first_step(
        self, time: float, pressure: float, ends: Callable[[Solution], bool]
    ) -> Solution:
        """Solve the first load step from other temperatures; collective.

        Whoever asks goes back to a step that was accepted afterwards.

        Args:
            time: Its pseudo-time.
            pressure: With which contacts conduct at first, at all of their points (stress).
            ends: Whether a solution says enough, also where temperatures have not settled;
                collective.

        Raises:
            NotConvergedError: From there, it leads to no answer.
        """
        assert self.problem.conduction is not None
        self.last = None
        self.problem.conduction.recall(None)
        self.problem.conduction.start_from(pressure)
        self._go_back()
        with closing(self._solutions(time)) as solutions:
            for found in solutions:
                if ends(found):
                    break
        return found

    def _present(self, time: float) -> Unknowns:
        """Unknowns as a step has just found them; collective."""
        system, mean_stress = self.newton.system, self.problem.present_mean_stress()
        return Unknowns(
            time,
            lambda: self.problem.displacement.x.array.reshape(self.problem.load.shape),
            system.scalar_values(system.state),
            lambda: mean_stress,
            system.position(),
        )

    def _try_at_temperatures(self, time: float) -> Solution:
        """Solve a step; again where the contact dofs turn out to be too few; collective."""
        system = self.newton.system
        while True:
            try:
                found = self._try_once(time)
            except NotConvergedError:
                if not system.take_in_all():
                    raise
            else:
                if not system.take_in_closed():
                    return found
            self._go_back()

    def _try_by_turns(self, time: float) -> Solution | None:
        """Solve a step that no other way solves, with points that close by turns; collective.

        Where friction alone holds bodies. The steps that follow begin so, too; where one of them
        fails, points close at once again.

        Args:
            time: Pseudo-time of the step.

        Returns:
            The step; None where this is no way, or leads nowhere either.
        """
        newton, problem = self.newton, self.problem
        self.go_back()
        goes = problem.scene.solver.strategy in _BY_TURNS and bool(problem.coulomb)
        goes = goes and newton.exact is None
        if not (goes and is_held_by_friction(problem)):
            return None
        logger.info("time %g: next: with points that close by turns", time)
        newton.closes_by_turns = not newton.closes_by_turns
        try:
            return self._try(time)
        except NotConvergedError as error:
            logger.debug("  %s", error)
            newton.closes_by_turns = not newton.closes_by_turns
            return None

    def _try_once(self, time: float) -> Solution:
        """Solve a step, from where it is thought to end or else from where it begins."""
        newton = self.newton
        found = None if self._warm is None else self._from_another_answer(time, self._warm)
        if found is not None:
            return found
        newton.forget()
        predicted = self._prediction(time)
        self._begin(time, predicted)
        try:
            return self._solve()
        except NotConvergedError as error:
            if predicted is None:
                raise
            logger.debug("  %s; next: from the last load step, or from the start", error)
        self._go_back()
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
            self._go_back()
        else:
            self.warm_steps += 1
        return found

    def _solve(self) -> Solution:
        """A step from its beginning; once more where a scalar that was held has a force."""
        found = solve_step(self.newton)
        return solve_step(self.newton) if release_held(self.newton, found) else found

    def _prediction(self, time: float) -> Unknowns | None:
        """Where the last two steps lead to, if no load path turns on the way.

        Where friction alone holds bodies, where the last statuses lead to.

        Not with the static law: its answers do not go on in straight lines, and a step begins
        nearer to its end without it.
        """
        if self._near is not None:
            return self._near
        if self.newton.exact is not None or self.newton.nested is not None:
            return None
        if self.last is None:
            return self._guess
        if not all(contact.friction.follows_path for contact in self.problem.coulomb):
            return None
        if is_held_by_friction(self.problem):
            return self._step_ahead(self.last.unknowns.time, time)
        if self.last.before is None:
            return None
        before = self.last.before
        close = 1e-9 * (time - before.time)
        if any(before.time + close < knot < time - close for knot in self._knots):
            return None
        return before.towards(self.last.unknowns, time)

    def _step_ahead(self, last: float, time: float) -> Unknowns | None:
        """Where one Newton step leads to that the last load step would have had next; collective.

        Slip still counts from where it did, so that what slipped slips on, and what stuck sticks.
        None where a load path turns at the last load step or after it.
        """
        close = _SAME * (time - last)
        turns = any(last - close < knot < time - close for knot in self._knots)
        if turns or self._has_moved_on:
            return None
        newton, problem = self.newton, self.problem
        problem.set_time(time)
        newton.system.follow_supports()
        for contact in problem.coulomb:
            contact.friction_term.tangent_state.stick_all()
            contact.friction_term.follow_pressure()
        newton.take_steps(1)
        found = self._present(time)
        self._go_back()
        return found
