"""The load steps of a run: what is recorded, kept and told at each of them, and at their end."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from fenics_contact.common.errors import NotConvergedError, StoppedError
from fenics_contact.common.failures import silently
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.results.load_history import Announce, step_line
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import UnitNames
from fenics_contact.simulation.analysis_tasks import AnalysisTasks
from fenics_contact.simulation.end_of_run import AtEnd, EndOfRun
from fenics_contact.simulation.state_file import SavedRun, StateFile
from fenics_contact.simulation.step_driver import StateKeeper
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, StepListener, Unknowns
from fenics_contact.solve.load_steps.load_stepper import stepping
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.solver_choice import Condense, SolverChoice

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class RunListeners:
    """Functions that a run calls while it takes load steps, and one that may end it.

    Attributes:
        announce: Called with number and record of every accepted step.
        accepted: Called when a load step has been added to the history; collective.
        stopped: Whether this rank was asked to stop; then the last accepted step counts.
        answered: Called when the last load step is solved and checked, before all that an answer
            stands without; collective.
        at_end: Called with the load steps at their end, and with the errors of cells where these
            were estimated; collective.
    """

    announce: Announce
    accepted: Callable[[], None] | None = None
    stopped: Callable[[], bool] | None = None
    answered: Callable[[], None] | None = None
    at_end: AtEnd | None = None


class StepsOfRun(StepListener):
    """Takes a model through its load steps, once, and records them; collective.

    Args:
        scene: What is solved.
        history: To which they are added.
        tasks: Analyses that follow them.
        timings: To which what it takes is counted.
        listeners: Who is told.
        state: Where to keep the state of every accepted load step.
        saved: The state of another run, to go on from.
        guess: Where the first load step is thought to end.

    Attributes:
        tried: Pseudo-time of the load step that was begun last.
        spent: Iterations spent on it.
    """

    def __init__(
        self,
        scene: Scene,
        history: StepHistory[Any],
        tasks: AnalysisTasks,
        timings: Timings,
        listeners: RunListeners,
        state: StateFile | None = None,
        saved: SavedRun | None = None,
        guess: Unknowns | None = None,
    ) -> None:
        self._scene, self._history, self._timings = scene, history, timings
        self._tasks = tasks
        self._listeners = listeners
        self._state, self._saved, self._guess = state, saved, guess
        self._driver = tasks.driver
        self._end = EndOfRun()
        self.tried, self.spent = 0.0, 0

    def take(
        self, problem: Problem, choice: SolverChoice, condense: Condense | None, end: EndOfRun
    ) -> None:
        """Solve step by step.

        Args:
            problem: The model.
            choice: How it is solved.
            condense: Gives the system of a body that is kept.
            end: To which all is written that is known at the end.

        Raises:
            NotConvergedError: A load step has no answer.
            StoppedError: Somebody asked to stop.
        """
        self._end = end
        finds_body = self._driver.takes_all
        parts = (self._timings, choice, condense, self._listeners.stopped, finds_body)
        with stepping(problem, *parts) as load_steps:
            try:
                self._begin(load_steps)
                self._drive(load_steps)
            finally:
                self.tried, self.spent = load_steps.tried, load_steps.spent
            self._finish(load_steps)

    def _drive(self, load_steps: LoadSteps) -> None:
        """Take load steps; those who do not reach the end can go on from where they are."""
        keeper = StateKeeper(load_steps, self._history, self._timings, self._state)
        try:
            self._driver.drive(load_steps, self, keeper, self._tell)
        except (NotConvergedError, StoppedError):
            keeper.make_up()
            raise

    def _begin(self, load_steps: LoadSteps) -> None:
        """Before the first step, which may be one to resume from."""
        repeats = load_steps.newton.system.repeats_cheaply and self._driver.takes_all
        if self._scene.solver.errors != "none" and repeats:
            load_steps.keep_ends()
        load_steps.begin_near(self._guess)
        saved = self._saved
        if saved is None:
            return
        self._history.resume(self._driver.resume(load_steps, saved), saved.energy)
        self._tasks.resumed()

    def accepted(self, step: AcceptedStep) -> None:
        """Record a load step, and tell of it; collective."""
        self._history.add(step.time, step.solution)
        with self._timings.phase("output"):
            self._tasks.accepted(step.time, step.solution)
        self._tell()

    def _tell(self) -> None:
        steps = self._history.steps
        self._listeners.announce(len(steps), steps[-1])
        if self._listeners.accepted is not None:
            self._listeners.accepted()

    def _finish(self, load_steps: LoadSteps) -> None:
        """After the last step, while the system can still be solved."""
        self._end.reach(self._scene, load_steps, self._history)
        if self._listeners.answered is not None:
            self._listeners.answered()
        try:
            with silently():
                self._judge(load_steps)
        except StoppedError:
            self._end.interrupt(load_steps)

    def _judge(self, load_steps: LoadSteps) -> None:
        """Judge the answer: checks, other answers and error bars; collective."""
        driver, at_end = self._driver, self._listeners.at_end
        self._end.look_beside(load_steps, self._timings, weighs_depth=driver.takes_all)
        if driver.takes_all:
            self._end.measure_bias(load_steps, self._timings)
            self._end.look_ahead(load_steps, self._timings, self._scene.solver)
        with self._timings.phase("errors"):
            self._end.estimate_errors(load_steps, self._history.steps, driver.budget, at_end)


def by_default(scene: Scene) -> Announce:
    """Return the default announcement: a line in the log for each of several load steps.

    Args:
        scene: That is solved.
    """
    return partial(_log_step, scene.unit_names) if scene.load_steps.several else _say_nothing


def _log_step(units: UnitNames | None, number: int, step: StepRecord) -> None:
    logger.info(step_line(number, step, units))


def _say_nothing(number: int, step: StepRecord) -> None:
    """Say nothing: the result of a run of one step says it all."""
