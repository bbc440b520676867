"""How a run takes its load steps, and keeps their state for another run to go on from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from time import monotonic
from typing import Any

from fenics_contact.common.parallel import from_root
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.state_file import SavedRun, StateFile
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.solve.load_steps.accepted_step import AuxiliaryState, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.budget import ErrorBudget, error_budget


class StateKeeper(StepListener):
    """Writes the state of load steps to a file, from which another run can go on.

    Args:
        load_steps: Those that are taken.
        history: Theirs.
        timings: To which what it takes is counted.
        state: The file; None where nothing is kept.
    """

    def __init__(
        self,
        load_steps: LoadSteps,
        history: StepHistory[Any],
        timings: Timings,
        state: StateFile | None,
    ) -> None:
        self._load_steps, self._history, self._timings = load_steps, history, timings
        self._state = state
        self._kept_at, self._unkept = -inf, False

    def completed(self) -> None:
        """Write the state of the last load step, where it is time to; collective."""
        load_steps = self._load_steps
        if self._state is None:
            return
        is_last = load_steps.pace.next(load_steps.time) is None
        now = from_root(load_steps.problem.comm, monotonic())
        self._unkept = not is_last and now < self._kept_at + load_steps.seconds_unkept
        if not self._unkept:
            self.keep(load_steps.auxiliary)
            self._kept_at = now

    def make_up(self) -> None:
        """Write the state of the last load step, if it was not time to before; collective."""
        if self._unkept:
            self.keep(self._load_steps.auxiliary)

    def keep(self, auxiliary: AuxiliaryState) -> None:
        """Write the state of the last load step; collective.

        Args:
            auxiliary: What another run needs besides it.
        """
        if self._state is None:
            return
        with self._timings.phase("output"):
            self._state.save(self._load_steps, self._history.steps, self._history.sums, auxiliary)


class StepDriver:
    """Takes the load steps of a run one after the other; an analysis may have a way of its own.

    Attributes:
        takes_all: Whether every load step of the scene is solved, once, so that what follows the
            last one, such as error bars, may solve it again.
    """

    takes_all = True

    def modelled(self, scene: Scene) -> Scene:
        """The scene whose load steps are solved.

        Args:
            scene: Of the run.
        """
        return scene

    def history(
        self, problem: Problem, timings: Timings, forces_of: Callable[[Solution], Any]
    ) -> StepHistory[Any]:
        """Make the history of the load steps; its arguments are those of ``StepHistory``."""
        return StepHistory(problem, timings, forces_of)

    def resume(self, load_steps: LoadSteps, saved: SavedRun) -> Solution:
        """Take up the load steps of another run; collective.

        Args:
            load_steps: Of this run.
            saved: The other one.

        Returns:
            The solution of its last load step.
        """
        return load_steps.resume(saved.last, saved.pace, saved.forces, saved.auxiliary)

    def drive(
        self,
        load_steps: LoadSteps,
        recorder: StepListener,
        keeper: StateKeeper,
        counted: Callable[[], None],
    ) -> None:
        """Take load steps to the last one; collective.

        Args:
            load_steps: Of the run.
            recorder: Adds each load step to the history, and tells of it.
            keeper: Keeps their state.
            counted: Called when something was added to the history in another way.

        Raises:
            NotConvergedError: A load step has no answer.
            StoppedError: Somebody asked to stop.
        """
        load_steps.solve(recorder, keeper)

    def budget(self, load_steps: LoadSteps, steps: Sequence[StepRecord]) -> ErrorBudget:
        """Estimated errors of the quantities of the last load step; collective.

        Args:
            load_steps: At their end.
            steps: Their records.
        """
        return error_budget(load_steps, steps)
