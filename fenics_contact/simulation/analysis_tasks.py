"""Tasks of analyses in a run: along its load steps, with its answer, and after it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact.analyses import registry
from fenics_contact.analyses.registry import Analysis
from fenics_contact.common.failures import attempt, silently
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.run import Seconds
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.step_driver import StepDriver
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.systems.solution import Solution


@dataclass(frozen=True)
class AnalysisFinding:
    """Results of an analysis with the answer.

    Attributes:
        attributes: Of the result.
        further: What ``further`` of the result has of it, by name; plain data for ``result.json``.
        words: Added to its verdict.
    """

    attributes: Mapping[str, Any] = field(default_factory=dict)
    further: Mapping[str, Any] = field(default_factory=dict)
    words: str = ""


class AnalysisTask:
    """Task of one analysis in a run, nothing by default; all methods are collective.

    The part ``task`` of its folder has the class as ``TASK``.

    Attributes:
        missing: What messages say where ``accepted``, ``evaluate`` or ``complete`` fails.
        fields: What they say where ``write_fields`` fails.

    Args:
        scene: One that asks for the analysis.

    Raises:
        InputError: The scene cannot have what it asks for.
    """

    missing: str
    fields: str = ""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def require(self, problem: Problem) -> None:
        """Refuse what a model does not have, before any load step.

        Raises:
            InputError: In one sentence.
        """

    def driver(self) -> StepDriver | None:
        """Return its own way to take load steps; None where a run takes one after the other."""
        return None

    def begin(self, problem: Problem) -> None:
        """Make ready to follow the load steps of a problem, of which none is taken yet."""

    def resumed(self) -> None:
        """Load steps of an earlier run, which were not followed, come before those of this one."""

    def begin_files(self, comm: MPI.Comm, folder: Path, resumed: float | None) -> None:
        """Make ready to write the files that grow with the load steps.

        Args:
            comm: Of the run.
            folder: Where to.
            resumed: Pseudo-time up to which there are files of an earlier run; None of a new one.

        Raises:
            MachineError: They cannot be made.
        """

    def add_to_files(self) -> None:
        """Write what has been added to the history.

        Raises:
            MachineError: It could not be written.
        """

    def accepted(self, time: float, solution: Solution) -> None:
        """Follow a load step, in whose state the problem is.

        Args:
            time: Its pseudo-time.
            solution: Of the step.
        """

    def evaluate(self) -> AnalysisFinding:
        """Return the results once the last load step is solved."""
        return AnalysisFinding()

    def complete(self, result: Result, body: Callable[[], KeptBody], notes: list[str]) -> Result:
        """The result with what it takes the body again to find.

        Args:
            result: Of the run, which converged.
            body: Gives the body.
            notes: To which sentences are added on what could not be found.
        """
        return result

    def unknown(self, result: Result) -> Result:
        """The result where ``complete`` failed."""
        return result

    def write_fields(self, problem: Problem, result: Result, folder: Path) -> None:
        """Write what ParaView shows of it.

        Args:
            problem: Of the last load step.
            result: Of the run.
            folder: Where to.
        """


class AnalysisTasks:
    """The analyses that a scene asks for; what fails of one is said, and the answer stands.

    Args:
        scene: The scene.
        comm: Of the run; all methods are collective.

    Attributes:
        notes: Sentences on what could not be followed of load steps.
        driver: Takes the load steps of the run.

    Raises:
        InputError: The scene cannot have what it asks for.
    """

    def __init__(self, scene: Scene, comm: MPI.Comm) -> None:
        self._comm = comm
        asked = [(analysis, analysis.part("task")) for analysis in registry.asked_by(scene)]
        self._tasks: list[tuple[Analysis, AnalysisTask]] = [
            (analysis, part.TASK(scene)) for analysis, part in asked if part is not None
        ]
        own = (task.driver() for _, task in self._tasks)
        self.driver = next((driver for driver in own if driver is not None), StepDriver())
        self._following: list[AnalysisTask] = []
        self.notes: list[str] = []

    def of(self, table: str) -> AnalysisTask:
        """The task of an analysis that the scene asks for.

        Args:
            table: Key of the scene that asks for it.
        """
        return next(task for analysis, task in self._tasks if table in analysis.tables)

    @property
    def use_body(self) -> bool:
        """Whether some solve on the body of the answer again."""
        return any(analysis.uses_body for analysis, _ in self._tasks)

    @property
    def phases(self) -> list[str]:
        """Names of the times that they take."""
        return [analysis.phase for analysis, _ in self._tasks if analysis.phase]

    def require(self, problem: Problem) -> None:
        """Refuse what a model does not have."""
        for _, task in self._tasks:
            task.require(problem)

    def begin(self, problem: Problem) -> None:
        """Make ready to follow the load steps of a problem, from the first one on."""
        self.notes = []
        self._following = [task for _, task in self._tasks]
        for task in self._following:
            task.begin(problem)

    def resumed(self) -> None:
        """Load steps of an earlier run come before those of this one."""
        for task in self._following:
            task.resumed()

    def begin_files(self, folder: Path, resumed: float | None) -> None:
        """Make ready to write the files that grow with the load steps.

        Args:
            folder: Where to.
            resumed: Pseudo-time up to which there are files of an earlier run; None of a new one.
        """
        for _, task in self._tasks:
            task.begin_files(self._comm, folder, resumed)

    def add_to_files(self) -> None:
        """Write what has been added to the history to the files that grow with the load steps."""
        for _, task in self._tasks:
            task.add_to_files()

    def accepted(self, time: float, solution: Solution) -> None:
        """Follow a load step; one that fails follows no further ones.

        Args:
            time: Its pseudo-time.
            solution: Of the step.
        """
        for task in list(self._following):
            known = len(self.notes)
            follow = partial(task.accepted, time, solution)
            attempt(self._comm, task.missing, follow, None, self.notes)
            if len(self.notes) > known:
                self._following.remove(task)

    def evaluate(self, notes: list[str]) -> AnalysisFinding:
        """Return the results of all tasks with the answer.

        Args:
            notes: To which is added what could not be found.
        """
        every = [
            attempt(self._comm, task.missing, task.evaluate, AnalysisFinding(), notes)
            for task in self._following
        ]
        attributes = {name: one for found in every for name, one in found.attributes.items()}
        further = {name: one for found in every for name, one in found.further.items()}
        return AnalysisFinding(attributes, further, "".join(found.words for found in every))

    def complete(self, result: Result, body: Callable[[], KeptBody], timings: Timings) -> Result:
        """The result with what it takes the body again to find.

        Args:
            result: Of a run that converged.
            body: Gives the body.
            timings: To which what it takes is counted.
        """
        for analysis, task in self._tasks:
            if analysis.uses_body:
                notes: list[str] = []
                with timings.phase(analysis.phase or "output"), silently():
                    find = partial(task.complete, result, body, notes)
                    unknown = task.unknown(result)
                    result = attempt(self._comm, task.missing, find, unknown, notes)
                said = (_plain(note, analysis.tables) for note in notes)
                words = " ".join([result.verdict, *said])
                seconds = Seconds(**timings.summary(self._comm))
                result = dataclasses.replace(result, timings=seconds, verdict=words)
        return result

    def write_fields(
        self, problem: Problem, result: Result, folder: Path, notes: list[str]
    ) -> None:
        """Write what ParaView shows of them.

        Args:
            problem: Of the last load step.
            result: Of the run.
            folder: Where to.
            notes: To which is added what could not be written.
        """
        for _, task in self._tasks:
            write = partial(task.write_fields, problem, result, folder)
            attempt(self._comm, task.fields, write, None, notes)


def _plain(note: str, tables: tuple[str, ...]) -> str:
    """Without the name of the part of the scene, which the sentence has said."""
    missing, _, reason = note.partition(": ")
    for name in tables:
        reason = reason.removeprefix(f"{name}: ")
    return f"{missing}: {reason}"
