"""Cycles that wear in a run: they take the place of its load steps, and are written as tables."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.analyses.wear_cycles.rates import Progress, Rates
from fenics_contact.analyses.wear_cycles.record import WornCycleEnd
from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle, WornFiles, one_cycle
from fenics_contact.analyses.wear_cycles.wear_cycles import WearCycles, with_depths
from fenics_contact.common.arrays import Array
from fenics_contact.common.timings import Timings
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import EXTERNAL_WORK
from fenics_contact.results.records.steps import CycleEnd, StepRecord
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.analysis_tasks import AnalysisTask
from fenics_contact.simulation.state_file import SavedRun
from fenics_contact.simulation.step_driver import StateKeeper, StepDriver
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, AuxiliaryState, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.budget import ErrorBudget


class WearCyclesTask(AnalysisTask):
    """Takes the load steps of a run through its cycles, and writes ``wear.csv`` meanwhile."""

    missing = "Cycles that wear were not followed"

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self._driver = CyclesOfRun(scene)
        self._files: WornFiles | None = None

    def driver(self) -> CyclesOfRun:
        """Return the driver of the load steps of the run."""
        return self._driver

    def begin_files(self, comm: MPI.Comm, folder: Path, resumed: float | None) -> None:
        """Make ready to write the tables, of which those of earlier cycles are kept."""
        self._files = WornFiles(comm, folder, self._last_cycle(resumed))

    def add_to_files(self) -> None:
        """Append the last cycle to the tables."""
        if self._files is not None and self._driver.last is not None:
            self._files.add(self._driver.last)

    def _last_cycle(self, time: float | None) -> int:
        """Number of the cycle that ends at a pseudo-time; 0 before any.

        Args:
            time: Of its load steps; None before any.
        """
        cycles = self.scene.cycles
        if time is None or cycles is None:
            return 0
        return round((time - cycles.begin) / cycles.repetition.period)


TASK = WearCyclesTask


_NOT_ESTIMATED = (
    "Errors by mesh, penalty, regularisation and load steps are not estimated where cycles are "
    "passed over, as all would be computed again: compare with a run on another mesh or with other "
    "settings. Those of passing over stand beside each cycle."
)
_NUMBERS = ("size", "passed_over", "pressure_change", "errors")


class CycleHistory(StepHistory[BulkForces]):
    """The cycles that were computed; friction work is that of all, what else works is not known.

    Attributes:
        cycle: The last one; None before there is one.
    """

    cycle: WearCycle | None = None

    def add_cycle(self, time: float, solution: Solution, cycle: WearCycle) -> None:
        """Keep what came out of a cycle, in whose end all is; collective.

        Args:
            time: Pseudo-time of its end.
            solution: Of its last load step, with what is worn then.
            cycle: The cycle.
        """
        self.cycle = cycle
        names = [contact.label for contact in self._problem.contacts]
        end = CycleEnd(
            number=cycle.number,
            change=None,
            advance=None,
            kind="",
            is_kept_changing=True,
            worn=WornCycleEnd(
                passed_over=cycle.passed_over,
                pressure_change=cycle.pressure_change,
                depth_over_width=cycle.depth_over_width,
                stick_areas=dict(zip(names, cycle.stick_areas, strict=True)),
                losses=dict(zip(names, cycle.losses, strict=True)),
                errors=dict(cycle.errors),
            ),
        )
        self.add(time, dataclasses.replace(solution, cycle=end))

    def resume(self, solution: Solution, energy: Sequence[float]) -> None:
        """Take over the last cycle of an earlier run; collective.

        Args:
            solution: Of its last load step, with what is worn then.
            energy: Sums of its energy balance, of no use here.
        """
        self._measure(solution)

    def _of_contact(self, solution: Solution, number: int) -> dict[str, Any]:
        if self.cycle is None:  # resumed, and not computed anew
            return dict(self.steps[-1].contacts[number].quantities)
        return dict(self.cycle.contacts[number])

    def _work_along(self, quantities: dict[str, Any]) -> dict[str, Any]:
        return {EXTERNAL_WORK: None}

    def _end_cycle(self, quantities: dict[str, Any]) -> None:
        """Compare nothing: the cycle before was not computed."""


class CyclesOfRun(StepDriver):
    """Takes the load steps of a run through its cycles; collective.

    Args:
        scene: Whose cycles have jumps.
    """

    takes_all = False

    def __init__(self, scene: Scene) -> None:
        assert scene.cycles is not None and scene.cycles.jumps is not None
        self._cycles, self._jumps = scene.cycles, scene.cycles.jumps
        self._history: CycleHistory | None = None
        self._progress: Progress | None = None

    @property
    def last(self) -> WearCycle | None:
        """The last cycle that was computed; None before there is one."""
        return None if self._history is None else self._history.cycle

    def modelled(self, scene: Scene) -> Scene:
        """The scene that ends with the first of its cycles."""
        return one_cycle(scene, None, None)[0]

    def history(
        self, problem: Problem, timings: Timings, forces_of: Callable[[Solution], Any]
    ) -> CycleHistory:
        """Make the history of cycles; its arguments are those of ``StepHistory``."""
        self._history = CycleHistory(problem, timings, forces_of)
        return self._history

    def resume(self, load_steps: LoadSteps, saved: SavedRun) -> Solution:
        """Take up the cycles of another run; collective.

        Returns:
            The end of the last cycle that was computed.
        """
        solution = super().resume(load_steps, saved)
        assert load_steps.last is not None
        self._progress = _progress(solution, load_steps.last, saved.auxiliary)
        return with_depths(load_steps.problem.contacts, self._progress.rates)

    def drive(
        self,
        load_steps: LoadSteps,
        recorder: StepListener,
        keeper: StateKeeper,
        counted: Callable[[], None],
    ) -> None:
        """Compute cycles, and pass over others, to the last one; collective.

        Their state is kept at the end of each that is computed: no other run can go on from within.

        Args:
            load_steps: Of the run.
            recorder: Adds single load steps, of no use here.
            keeper: Keeps the state.
            counted: Called when a cycle has been added to the history.

        Raises:
            NotConvergedError: A load step of a cycle.
            StoppedError: The run is to end.
        """
        assert self._history is not None
        repetition, contacts = self._cycles.repetition, load_steps.problem.contacts
        worn = WearCycles(load_steps, repetition.begin, self._jumps, self._progress)
        for cycle in worn.run(repetition.number):
            assert worn.progress is not None
            solution = with_depths(contacts, worn.progress.rates)
            end = repetition.begin + cycle.number * repetition.period
            self._history.add_cycle(end, solution, cycle)
            counted()
            keeper.keep(_auxiliary(worn.progress))

    def budget(self, load_steps: LoadSteps, steps: Sequence[StepRecord]) -> ErrorBudget:
        """Estimated errors of the last cycle: none, and why, where the scene asks for some.

        Args:
            load_steps: At their end.
            steps: The cycles that were computed.
        """
        if load_steps.problem.scene.solver.errors == "none":
            return ErrorBudget()
        return ErrorBudget(notes=[_NOT_ESTIMATED])


def _auxiliary(progress: Progress) -> AuxiliaryState:
    """Return the progress of cycles as state to be saved."""
    earlier, rates = progress.earlier, progress.rates
    said: dict[str, Any] = {name: getattr(progress, name) for name in _NUMBERS}
    return AuxiliaryState(
        said=said
        | {
            "number": rates.number,
            "earlier": earlier.number,
            "before": progress.before.tolist(),
            "works": rates.works.tolist(),
            "stick_areas": rates.stick_areas,
        },
        at_points=[
            {"cycle_begin": begin, "cycle_depth": depth, "earlier_depth": before}
            for begin, depth, before in zip(rates.begin, rates.depths, earlier.depths, strict=True)
        ],
    )


def _progress(solution: Solution, end: AcceptedStep, auxiliary: AuxiliaryState) -> Progress:
    """How far the cycles of another run are.

    Args:
        solution: At the end of the last one.
        end: The last load step.
        auxiliary: What was kept beside it.
    """
    said, at_points = auxiliary.said, auxiliary.at_points

    def rates(number: int, depths: list[Array]) -> Rates:
        return Rates(
            number=number,
            begin=[values["cycle_begin"] for values in at_points],
            depths=depths,
            works=np.array(said["works"]),
            stick_areas=said["stick_areas"],
            solution=solution,
            end=end,
        )

    return Progress(
        # Of that one only number and depths count.
        earlier=rates(said["earlier"], [values["earlier_depth"] for values in at_points]),
        rates=rates(said["number"], [values["cycle_depth"] for values in at_points]),
        before=np.array(said["before"]),
        **{name: said[name] for name in _NUMBERS},
    )
