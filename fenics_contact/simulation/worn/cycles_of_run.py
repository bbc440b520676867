"""The cycles of a run that wear, in place of its load steps one by one; and going on with them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.restart.state_file import SavedRun
from fenics_contact.simulation.worn.cycle_history import CycleHistory
from fenics_contact.simulation.worn.rates import Progress, Rates
from fenics_contact.simulation.worn.wear_cycles import WearCycles, with_depths
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, AuxiliaryState
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.error_estimates.budget import ErrorBudget

_NOT_ESTIMATED = (
    "Errors by mesh, penalty, regularisation and load steps are not estimated where cycles are "
    "passed over, as all would be computed again: compare with a run on another mesh or with other "
    "settings. Those of passing over stand beside each cycle."
)
_NUMBERS = ("size", "passed_over", "pressure_change", "errors")


class CyclesOfRun:
    """Takes the load steps of a run through its cycles; collective.

    Args:
        scene: Whose cycles have jumps.
        history: To which those that are computed are added.
        counted: Called when one has been added.
    """

    def __init__(
        self,
        scene: Scene,
        history: CycleHistory,
        counted: Callable[[], None],
    ) -> None:
        assert scene.cycles is not None and scene.cycles.jumps is not None
        self._cycles, self._jumps = scene.cycles, scene.cycles.jumps
        self._history, self._counted = history, counted
        self._progress: Progress | None = None

    def resume(self, load_steps: LoadSteps, saved: SavedRun) -> Solution:
        """Take up the cycles of another run; collective.

        Args:
            load_steps: Of this one.
            saved: Of the other one.

        Returns:
            The end of the last cycle that was computed.
        """
        solution = load_steps.resume(saved.last, saved.pace, saved.forces, saved.auxiliary)
        assert load_steps.last is not None
        self._progress = _progress(solution, load_steps.last, saved.auxiliary)
        return with_depths(load_steps.problem.contacts, self._progress.rates)

    def drive(self, load_steps: LoadSteps, keep: Callable[[AuxiliaryState], None]) -> None:
        """Compute cycles, and pass over others, to the last one; collective.

        Args:
            load_steps: Of the run.
            keep: Called when a cycle has been added, with what another run needs besides its last
                load step to go on from there; not within a cycle, of which none can go on.

        Raises:
            NotConvergedError: A load step of a cycle.
            StoppedError: The run is to end.
        """
        repetition, contacts = self._cycles.repetition, load_steps.problem.contacts
        worn = WearCycles(load_steps, repetition.begin, self._jumps, self._progress)
        for cycle in worn.run(repetition.number):
            assert worn.progress is not None
            solution = with_depths(contacts, worn.progress.rates)
            end = repetition.begin + cycle.number * repetition.period
            self._history.add_cycle(end, solution, cycle)
            self._counted()
            keep(_auxiliary(worn.progress))

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
