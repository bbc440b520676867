"""The load steps of a scene, one after the other; a step that is rejected leaves no trace."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError, StoppedError
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.scene.scene import Steps
from fenics_contact.solve.load_steps.accepted_step import (
    AcceptedStep,
    AuxiliaryState,
    ContactMemory,
    StepEnd,
    StepListener,
    Unknowns,
    contact_change,
    remember,
)
from fenics_contact.solve.load_steps.cycle_watch import CycleWatch
from fenics_contact.solve.load_steps.step_control import FixedPace, Pace, PaceOfCycles, pace_of
from fenics_contact.solve.load_steps.step_tries import StepTries, Warm
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution

logger = logging.getLogger(__name__)

# Force imbalances that differ by less than this share, and would be chance otherwise, are the same.
_SAME_END = 1e-4


# Names of what is kept of temperatures.
_RISE, _OF_HEAT = "temperature_rise", "pressure_of_heat"


class LoadSteps(StepTries):
    """All load steps of a problem.

    Attributes:
        pace: Which step comes next.
        tried: Pseudo-time of the step that was tried last.
        spent: Newton steps of tries since the last accepted step, which were all rejected.
        ends: Pseudo-time → where that step ended; None where they are not kept.
        seconds_unkept: For so long the state need not be written; 0: that of every step is.

    Args:
        newton: Made for the problem, not started.
        finds_body: Whether the displacement inside the body is found at the end; else when it is
            asked for.
    """

    seconds_unkept: ClassVar[float] = 0.0

    def __init__(self, newton: Newton, finds_body: bool = True) -> None:
        super().__init__(newton)
        scene = self.problem.scene
        self.pace: Pace | PaceOfCycles = pace_of(scene, self._knots)
        cycles = cycles_of(scene)
        self._cycles = None if cycles is None else CycleWatch(self.problem, cycles)
        self._listeners: tuple[StepListener, ...] = ()
        self._first: list[ContactMemory] = []
        self._failed_with: float | None = None
        self.tried = 0.0
        self.spent = 0
        self._finds_body = finds_body
        self.ends: dict[float, StepEnd] | None = None

    def keep_ends(self) -> None:
        """Keep where each load step ends."""
        self.ends = {}

    def solve(self, *listeners: StepListener) -> Solution:
        """Take the steps that are left; collective.

        Args:
            *listeners: Are told of each of them.

        Returns:
            The solution of the last one.

        Raises:
            NotConvergedError: A step, and the smallest one where they are automatic. The
                problem is as after the last accepted step.
            StoppedError: Likewise.
        """
        self._listeners = listeners
        try:
            while (time := self.pace.next(self.time)) is not None:
                self.newton.require_going_on()
                self.tried = time
                last = self.problem.scene.load_steps.last
                logger.debug("  time %g of %g", time, last, extra={"share": self.time / last})
                self._take(time)
        except (NotConvergedError, StoppedError):
            self.go_back()
            raise
        finally:
            self._listeners = ()  # they may refer to these: a circle
        assert self.last is not None  # there is a step, or one was resumed
        if self._finds_body:  # whoever reads it later may no longer have the solver
            self.last.solution.find_body()
        return self.last.solution

    def count_tried_from(self, time: float) -> None:
        """Count the pseudo-time of the step that was tried last from this one on."""
        self.tried += time

    @property
    def auxiliary(self) -> AuxiliaryState:
        """State that another run needs besides the last step to go on: its temperatures."""
        heat = None if self.last is None else self.last.heat
        conduction = self.problem.conduction
        if heat is None or conduction is None:
            return AuxiliaryState()
        return AuxiliaryState(
            at_points=[{_OF_HEAT: one} for one in conduction.of_all_contacts(heat)],
            nodal={_RISE: np.repeat(heat.rise[:, None], self.problem.spaces.components, axis=1)},
        )

    def resume(
        self, last: AcceptedStep, pace: Sequence[float], forces: float, auxiliary: AuxiliaryState
    ) -> Solution:
        """Take up the load steps that another run began; collective.

        Args:
            last: Its last step. Of the solution, only what it says of the way there counts.
            pace: The state of its pace.
            forces: Largest of its steps so far (force).
            auxiliary: What it kept besides.

        Returns:
            The solution of that step.
        """
        conduction = self.problem.conduction
        if conduction is not None:
            heat = conduction.memory_of(auxiliary.nodal[_RISE][:, 0], auxiliary.values(_OF_HEAT))
            last = dataclasses.replace(last, heat=heat)
        self.last = last
        self.pace.resume(pace)
        if self._cycles is not None:
            self._cycles.resume()
        self.newton.system.earlier_forces = forces
        self.go_back()
        said, newton = last.solution, self.newton
        solution = dataclasses.replace(
            newton.solution(said.outer_iterations, said.strategy),
            residual_history=said.residual_history,
            newton_iterations=said.newton_iterations,
            imbalance_limit=said.imbalance_limit,
        )
        self.last = dataclasses.replace(last, solution=solution)
        self.go_back()
        return solution

    def go_on_from(
        self,
        step: AcceptedStep,
        time: float,
        worn: Sequence[Array] = (),
        steps: Steps | None = None,
    ) -> None:
        """Go on from a load step as at another pseudo-time, and worn otherwise; collective.

        Args:
            step: That was accepted.
            time: At which loads are about the same.
            worn: Depths of each contact, (points,) (length); by default what they are.
            steps: Those that follow, listed; by default as they would have followed.
        """
        if steps is not None:
            self.pace = FixedPace(steps)
        self.go_back_to(step)
        self._move_on(step)
        for contact, depth in zip(self.problem.contacts, worn, strict=bool(worn)):
            contact.wear.recall({"worn_depth": depth})
        self.last = AcceptedStep(
            unknowns=dataclasses.replace(step.unknowns, time=time),
            contacts=[remember(contact) for contact in self.problem.contacts],
            solution=step.solution,
            before=None,
        )

    def go_to_and_fro(self, step: AcceptedStep, cycles: Cycles, increments: int) -> None:
        """Next, go on from a load step through cycles of the problem's ``drive``; collective.

        Args:
            step: That was accepted, at which all else rests.
            cycles: That end as soon as their loop is closed; what comes before the first begins at
                the step.
            increments: Load steps of a cycle, which turns in the middle and at its end.
        """
        rest, repetition = step.unknowns.time, cycles.repetition
        self.go_on_from(step, rest)
        size = repetition.period / increments
        count = round((cycles.begin - rest) / size) + cycles.number * increments
        self._knots = [
            cycles.begin + 0.5 * half * repetition.period for half in range(2 * cycles.number)
        ]
        self._cycles = CycleWatch(self.problem, cycles)
        steps = Steps(times=tuple(rest + size * (number + 1) for number in range(count)))
        self.pace = PaceOfCycles(FixedPace(steps), cycles)
        self._failed_with, self.spent = None, 0

    def afresh(
        self,
        times: Sequence[float],
        warm: Warm | None = None,
        ends: dict[float, StepEnd] | None = None,
    ) -> LoadSteps:
        """Other load steps over the same system, from the start; collective.

        Args:
            times: Pseudo-times of its steps, increasing.
            warm: As of ``begin_near``.
            ends: To which is added where each of them ends.

        Returns:
            Those load steps, with the first step's ε to begin with, where this one took that step.
            This one is to be gone back to before it is used again.
        """
        assert self.last is not None
        if self.problem.conduction is not None:
            self.problem.conduction.recall(None)
        self._recall(self._untouched)
        for contact, memory in zip(self.problem.contacts, self._first, strict=False):
            scale = memory.regularisation_parameter, memory.is_scaled
            contact.friction.regularisation.recall(*scale)
        other = LoadSteps(self.newton)
        other.pace = FixedPace(Steps(times=tuple(times)))
        other._cycles, other._warm, other.ends = None, warm, ends
        return other

    def _take(self, time: float) -> None:
        """Try a step, and accept it or cut it; collective."""
        try:
            found = self._try(time)
        except NotConvergedError as error:
            self.spent += self.newton.steps
            if not self._fails_again(error) and self.pace.cut():
                logger.info("time %g: %s; a smaller step", time, error)
                self.go_back()
                return
            by_turns = self._try_by_turns(time)
            if by_turns is None:
                raise
            found = by_turns
        change = contact_change(self.problem, self.last, found)
        if self.pace.exceeds(change) and self.pace.cut():
            logger.info("time %g: contact changes by %.0f %%; a smaller step", time, 100 * change)
            self.spent += found.newton_iterations
            self.go_back()
            return
        every = found.newton_iterations + self.spent
        cycle = None if self._cycles is None else self._cycles.step(time, found)
        if cycle is not None and cycle.is_closed and isinstance(self.pace, PaceOfCycles):
            self.pace.closed()
        self._accept(time, dataclasses.replace(found, newton_iterations=every, cycle=cycle))
        self.pace.went(found.newton_iterations, change)
        for listener in self._listeners:
            listener.completed()

    def _fails_again(self, error: NotConvergedError) -> bool:
        """Whether a smaller step failed with the same force imbalance: its size is not the cause.

        So it is where loads rest meanwhile.
        """
        before = self._failed_with
        self._failed_with = error.residual_history[-1] if error.residual_history else None
        if before is None or self._failed_with is None:
            return False
        return abs(self._failed_with - before) <= _SAME_END * before

    def _accept(self, time: float, found: Solution) -> None:
        problem, system = self.problem, self.newton.system
        self.last = AcceptedStep(
            unknowns=Unknowns(
                time,
                lambda: found.displacement,
                system.scalar_values(system.state),
                lambda: found.mean_stress,
                system.position(),
            ),
            contacts=[remember(contact) for contact in problem.contacts],
            solution=found,
            before=self.last.unknowns if self.last else None,
            heat=None if problem.conduction is None else problem.conduction.memory,
        )
        self._first = self._first or (self.last.contacts if self.last.before is None else [])
        system.earlier_forces = max(system.earlier_forces, system.present_forces)
        if self.ends is not None:
            self.ends[time] = StepEnd.of(self.newton)
        self._has_moved_on = False
        self._failed_with = None
        self.spent = 0
        for listener in self._listeners:
            listener.accepted(self.last)
