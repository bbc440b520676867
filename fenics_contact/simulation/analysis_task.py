"""Tasks of analyses in a run: along its load steps, with its answer, and after it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.step_driver import StepDriver
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.newton.solution import Solution


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
        """What takes the load steps of a run in its own way; None where each is taken once."""
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
