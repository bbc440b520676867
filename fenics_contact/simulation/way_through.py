"""A run's way through its load steps: what is counted, kept and told at each, and at their end."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf
from time import monotonic
from typing import Any

from fenics_contact.common.errors import NotConvergedError, StoppedError
from fenics_contact.common.failures import attempt, silently
from fenics_contact.common.parallel import from_root
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.results.load_history import Announce, step_line
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Check
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.names import UnitNames
from fenics_contact.scene.units.table import names_of
from fenics_contact.simulation.restart.state_file import SavedRun, StateFile
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.simulation.worn.cycle_history import CycleHistory
from fenics_contact.simulation.worn.cycles_of_run import CyclesOfRun
from fenics_contact.solve.load_steps.accepted_step import Unknowns
from fenics_contact.solve.load_steps.beside import Beside
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.load_steps.solve import solve
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.solver_choice import Condense, SolverChoice
from fenics_contact.trust.error_estimates.budget import ErrorBudget, error_budget, unknown_budget
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors
from fenics_contact.trust.error_estimates.solving_again import restore
from fenics_contact.trust.resolution.unseen_depth import judged_by_depth
from fenics_contact.trust.uniqueness.other_answers import OtherAnswers, look_around

logger = logging.getLogger(__name__)

AtEnd = Callable[[LoadSteps, LocalErrors | None], None]
_Judge = Callable[[LoadSteps, Sequence[StepRecord]], ErrorBudget]


@dataclass
class EndOfRun:
    """What is known once the last load step is solved.

    Attributes:
        last: What a further step would start from.
        others: Of other answers of that step.
        budget: Estimated errors of its quantities.
        checks: Of the physics.
        notes: Sentences on what could not be found beside the answer.
        interrupted: Whether somebody asked to stop before all of it was found.
    """

    last: Unknowns | None = None
    others: OtherAnswers = field(default_factory=OtherAnswers)
    budget: ErrorBudget = field(default_factory=ErrorBudget)
    checks: dict[str, Check] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    interrupted: bool = False


@dataclass(frozen=True)
class Onlookers:
    """Who is told on the way, and who may end it.

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


class WayThrough:
    """Takes a model through its load steps, once; collective.

    Args:
        scene: What is solved; where cycles are passed over, its model is of one of them.
        history: To which they are added.
        timings: To which what it takes is counted.
        onlookers: Who is told.
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
        timings: Timings,
        onlookers: Onlookers,
        state: StateFile | None = None,
        saved: SavedRun | None = None,
        guess: Unknowns | None = None,
    ) -> None:
        self._scene, self._history, self._timings = scene, history, timings
        self._onlookers = onlookers
        self._state, self._saved, self._guess = state, saved, guess
        self._cycles: CyclesOfRun | None = None
        self._end = EndOfRun()
        self.tried, self.spent = 0.0, 0
        self._kept_at, self._unkept = -inf, False

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
        drive: Callable[[LoadSteps], Solution] = LoadSteps.solve
        if isinstance(self._history, CycleHistory):
            self._cycles = CyclesOfRun(self._scene, self._history, self._tell, self._keep)
            drive = self._cycles.drive
        drive = partial(self._kept_where_it_stops, drive)
        # Not this object's own: load steps refer to it, and would not be freed at once.
        begun: list[LoadSteps] = []

        def begin(load_steps: LoadSteps) -> None:
            begun.append(load_steps)
            self._begin(load_steps)

        stopped = self._onlookers.stopped
        calls = (begin, self._keep, stopped, self._finish, condense)
        try:
            solve(problem, self._timings, self._record, choice, *calls, drive)
        finally:
            if begun:
                self.tried, self.spent = begun[0].tried, begun[0].spent

    def _begin(self, load_steps: LoadSteps) -> None:
        """Before the first step, which may be one to resume from."""
        repeats = load_steps.newton.system.repeats_cheaply and self._cycles is None
        if self._scene.solver.errors != "none" and repeats:
            load_steps.ends = {}
        load_steps.guess = self._guess
        saved = self._saved
        if saved is None:
            return
        if self._cycles is not None:
            solution = self._cycles.resume(load_steps, saved)
        else:
            solution = load_steps.resume(saved.last, saved.pace, saved.forces, saved.beside)
        self._history.resume(solution, saved.energy)

    def _record(self, time: float, solution: Solution) -> None:
        """Of a load step that was accepted."""
        self._history.add(time, solution)
        self._tell()

    def _tell(self) -> None:
        steps = self._history.steps
        self._onlookers.announce(len(steps), steps[-1])
        if self._onlookers.accepted is not None:
            self._onlookers.accepted()

    def _keep(self, load_steps: LoadSteps, beside: Beside | None = None) -> None:
        """The state of a load step that can be gone back to, where it is time to; collective."""
        if self._state is None:
            return
        is_last = load_steps.pace.next(load_steps.time) is None
        now = from_root(load_steps.problem.comm, monotonic())
        self._unkept = not is_last and now < self._kept_at + load_steps.seconds_unkept
        if not self._unkept:
            self._write(self._state, load_steps, beside or load_steps.beside)
            self._kept_at = now

    def _write(self, state: StateFile, load_steps: LoadSteps, beside: Beside) -> None:
        with self._timings.phase("output"):
            state.save(load_steps, self._history.steps, self._history.sums, beside)

    def _kept_where_it_stops(
        self, drive: Callable[[LoadSteps], Solution], load_steps: LoadSteps
    ) -> Solution:
        """Take load steps; those who do not reach the end can go on from where they are."""
        try:
            return drive(load_steps)
        except (NotConvergedError, StoppedError):
            if self._unkept and self._state is not None:
                self._write(self._state, load_steps, load_steps.beside)
            raise

    def _finish(self, load_steps: LoadSteps) -> None:
        """After the last step, while the system can still be solved."""
        end, history = self._end, self._history
        end.last = None if load_steps.last is None else load_steps.last.unknowns
        end.checks = history.checks()  # before other answers move the contacts about
        end.budget = unknown_budget(self._scene, history.steps[-1])
        if self._onlookers.answered is not None:
            self._onlookers.answered()
        try:
            with silently():
                self._judge(load_steps)
        except StoppedError:  # of estimates: the answer is there
            end.interrupted = True
            restore(load_steps)

    def _judge(self, load_steps: LoadSteps) -> None:
        """What is to be known of the answer beside it; collective."""
        end, comm, steps = self._end, load_steps.problem.comm, self._history.steps
        if self._cycles is None:
            with self._timings.phase("output"):
                missing = "How far what sinks in between points governs the answer was not found"
                depth = partial(judged_by_depth, load_steps, end.checks)
                end.checks = attempt(comm, missing, depth, end.checks, end.notes)
        look = partial(look_around, load_steps)
        with self._timings.phase("output"):
            missing = "It was not found whether the answer is the only one"
            end.others = attempt(comm, missing, look, OtherAnswers(), end.notes)
            if end.notes:
                restore(load_steps)
        with self._timings.phase("errors"):
            judge: _Judge = error_budget if self._cycles is None else self._cycles.budget
            estimate = partial(judge, load_steps, steps)
            notes: list[str] = []
            found = attempt(comm, "Errors were not estimated", estimate, end.budget, notes)
            end.budget = replace(found, notes=[*found.notes, *notes])
            if notes:
                restore(load_steps)
            at_end = self._onlookers.at_end
            if at_end is not None:
                tell = partial(at_end, load_steps, end.budget.local)
                attempt(comm, "Cells were not weighed for the accuracy", tell, None, end.notes)


def by_default(scene: Scene) -> Announce:
    """What says that a load step is done: a line in the log; of a run of one its result says all.

    Args:
        scene: That is solved.
    """
    return partial(_log_step, names_of(scene)) if scene.load_steps.several else _say_nothing


def _log_step(units: UnitNames | None, number: int, step: StepRecord) -> None:
    logger.info(step_line(number, step, units))


def _say_nothing(number: int, step: StepRecord) -> None:
    """Of a run of a single step, its result says it all."""
