"""End of a run, after its last load step: checks, other answers, error bars."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from mpi4py import MPI

from fenics_contact.common.failures import attempt
from fenics_contact.common.timings import Timings
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Check
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.solve.load_steps.accepted_step import Unknowns
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.convergence.unseen import judged_by_depth
from fenics_contact.trust.error_estimates.budget import ErrorBudget, unknown_budget
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors
from fenics_contact.trust.error_estimates.solving_again import restore
from fenics_contact.trust.uniqueness import OtherAnswers, search_other_solutions

AtEnd = Callable[[LoadSteps, LocalErrors | None], None]
Judge = Callable[[LoadSteps, Sequence[StepRecord]], ErrorBudget]


@dataclass
class EndOfRun:
    """Results after the last load step; what fails among them is said in ``notes``.

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
    _unknown: ErrorBudget = field(default_factory=ErrorBudget)

    def reach(self, scene: Scene, load_steps: LoadSteps, history: StepHistory[Any]) -> None:
        """Take the answer, before other answers move the contacts about; collective.

        Args:
            scene: What is solved.
            load_steps: At their end.
            history: Theirs.
        """
        self.last = None if load_steps.last is None else load_steps.last.unknowns
        self.checks = history.checks()
        self.budget = self._unknown = unknown_budget(scene, history.steps[-1])

    def interrupt(self, load_steps: LoadSteps) -> None:
        """Somebody asked to stop while errors were estimated: the answer stays; collective."""
        self.interrupted = True
        restore(load_steps)

    def look_beside(self, load_steps: LoadSteps, timings: Timings, weighs_depth: bool) -> None:
        """Judge what sinks in between points, and look for other answers; collective.

        Args:
            load_steps: At their end.
            timings: To which what it takes is counted.
            weighs_depth: Whether what sinks in is weighed by what it would carry.
        """
        comm = load_steps.problem.comm
        if weighs_depth:
            with timings.phase("output"):
                missing = "How far what sinks in between points governs the answer was not found"
                depth = partial(judged_by_depth, load_steps, self.checks)
                self.checks = attempt(comm, missing, depth, self.checks, self.notes)
        with timings.phase("output"):
            missing = "It was not found whether the answer is the only one"
            search = partial(search_other_solutions, load_steps)
            self.others = attempt(comm, missing, search, OtherAnswers(), self.notes)
            if self.notes:
                restore(load_steps)

    def estimate_errors(
        self,
        load_steps: LoadSteps,
        steps: Sequence[StepRecord],
        judge: Judge,
        at_end: AtEnd | None,
    ) -> None:
        """Estimate errors, and tell somebody who needs those of cells; collective.

        Args:
            load_steps: At their end.
            steps: All load steps.
            judge: Estimates.
            at_end: Who is told.
        """
        estimate = partial(judge, load_steps, steps)
        if not self.take_budget(load_steps.problem.comm, estimate):
            restore(load_steps)
        if at_end is not None:
            tell = partial(at_end, load_steps, self.budget.local)
            missing = "Cells were not weighed for the accuracy"
            attempt(load_steps.problem.comm, missing, tell, None, self.notes)

    def take_budget(self, comm: MPI.Comm, estimate: Callable[[], ErrorBudget]) -> bool:
        """Have estimated errors, or say why these are unknown; collective.

        Args:
            comm: Communicator.
            estimate: Finds them.

        Returns:
            Whether they were found.
        """
        said = list(self.budget.notes)
        notes: list[str] = []
        found = attempt(comm, "Errors were not estimated", estimate, self._unknown, notes)
        self.budget = replace(found, notes=[*found.notes, *said, *notes])
        return not notes
