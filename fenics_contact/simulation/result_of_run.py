"""The result of a run, put together from all that was found on the way."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.failures import attempt
from fenics_contact.common.timings import Timings
from fenics_contact.evaluate.quantities import contact_points
from fenics_contact.problem.existence.condition import FreeMotion
from fenics_contact.problem.problem import Problem
from fenics_contact.results.cycle_losses import cycles_record
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.model import Model, Seconds
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Result
from fenics_contact.results.words.tables import cycle_words
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation import verdict
from fenics_contact.simulation.analysis_tasks import AnalysisTasks
from fenics_contact.simulation.description import model_of, record_of, units_of
from fenics_contact.simulation.end_of_run import EndOfRun
from fenics_contact.simulation.modes_of_motion import ChosenModes
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.solver_choice import SolverChoice


@dataclass(frozen=True)
class ResultOfRun:
    """Puts the result of a run together; all methods but ``contacts`` are collective.

    Attributes:
        scene: What was solved.
        problem: Its model.
        free_motion: Rigid motions that the supports leave to friction.
        choice: The solver.
        history: The load steps that were accepted.
        tasks: What analyses of the scene do.
        end: What is known once the last load step is solved.
        modes: In which bodies move.
        timings: Seconds so far.
    """

    scene: Scene
    problem: Problem
    free_motion: FreeMotion
    choice: SolverChoice
    history: StepHistory[Any]
    tasks: AnalysisTasks
    end: EndOfRun
    modes: ChosenModes
    timings: Timings

    @property
    def solution(self) -> Solution | None:
        """Nodal values of this rank of the last load step that was accepted, if any."""
        return self.history.solution

    @property
    def model(self) -> Model:
        """``model`` of ``result.json``."""
        model = model_of(self.problem, self.choice, self.free_motion, self.solution)
        return dataclasses.replace(model, free_modes_error=self.modes.error(self.history.steps))

    def contacts(self, quantities: Sequence[Quantities] | None = None) -> list[ContactRecord]:
        """``contacts`` of ``result.json``.

        Args:
            quantities: Those of each contact, once there are any.
        """
        quantities = quantities or [{} for _ in self.problem.contacts]
        pairs = zip(self.problem.contacts, quantities, strict=True)
        return [
            dataclasses.replace(
                record_of(contact),
                uniqueness_limit=self.end.others.limit(contact.label),
                quantities=found,
                errors=self.end.budget.of_contact(number),
            )
            for number, (contact, found) in enumerate(pairs)
        ]

    def evaluate(self) -> Result:
        """Return the result of the last load step, which was solved; collective."""
        problem, solution, history = self.problem, self.solution, self.history
        assert solution is not None
        modes = self.modes
        quantities, open_share = history.steps[-1].quantities, history.energy_balance.open_share
        with self.timings.phase("output"):
            checks = (self.end.checks or history.checks()) | modes.check(history.steps)
            points = contact_points(problem, solution)
            not_found: list[str] = []
            found = self.tasks.evaluate(not_found)
        contacts = self.contacts(history.by_contact)
        far = () if self.scene.half_space is None else (self.scene.half_space.label,)
        losses = self.end.budget.losses
        notes = [*history.notes, *self.tasks.notes, *not_found, *self.end.notes]
        passes = cycles_of(self.scene)
        count = partial(cycles_record, history.steps, contacts, passes, far, losses)
        cycles = attempt(problem.comm, "Losses of cycles were not found", count, None, notes)
        missing = "How near parts are to slipping was not found"
        near = attempt(problem.comm, missing, history.slip_limit, None, notes)
        said = verdict.with_unresolved(verdict.of_checks(checks), problem, solution, notes)
        said += verdict.remarks(problem, solution, history.steps, open_share, notes)
        return Result(
            title=self.scene.title,
            converged=True,
            verdict=said
            + cycle_words(cycles)
            + found.words
            + self.end.others.words()
            + modes.words(history.steps)
            + "".join(f" {note}" for note in notes),
            model=self.model,
            contacts=contacts,
            supports=self.end.budget.of_supports(history.supports),
            reactions=self.end.budget.of_reactions(history.supports),
            preloads=self.end.budget.of_scalars(history.scalars),
            quantities=quantities,
            steps=history.steps,
            cycles=cycles,
            slip_limit=near,
            checks=checks,
            branches=self.end.others.branches,
            errors=self.end.budget.quantities,
            error_notes=self.end.budget.notes,
            timings=Seconds(**self.timings.summary(problem.comm)),
            versions=compat.versions(),
            units=units_of(self.scene, quantities),
            points=points,
            further=found.further,
            **found.attributes,
        )

    def _stopped_short(self, words: str, steps: list[StepRecord]) -> Result:
        """Return the result of a history that did not reach its end; collective.

        Args:
            words: Why it did not.
            steps: Those accepted, and the one that was not.
        """
        if self.solution is not None:
            reached = self.history.steps[-1].load_factor
            words += (
                f" Results are those of the last load step that was done, at time {reached:g} of "
                f"{self.scene.load_steps.last:g}; --resume goes on from there."
            )
            return dataclasses.replace(self.evaluate(), converged=False, verdict=words, steps=steps)
        return Result(
            title=self.scene.title,
            converged=False,
            verdict=words,
            model=self.model,
            contacts=self.contacts(),
            supports=[],
            quantities={},
            steps=steps,
            checks={},
            timings=Seconds(**self.timings.summary(self.problem.comm)),
            versions=compat.versions(),
            units=units_of(self.scene, ()),
        )

    def unconverged(self, error: NotConvergedError, tried: float, spent: int) -> Result:
        """Return the result up to a load step that did not converge, with its history; collective.

        Args:
            error: Why it did not.
            tried: Its pseudo-time.
            spent: Newton iterations spent on it.
        """
        step = StepRecord(
            load_factor=tried,
            newton_iterations=spent,
            outer_iterations=0,
            attempts=list(error.attempts),
            residual_history=list(error.residual_history),
            quantities={},
        )
        reached = None if self.solution is None else self.history.steps[-1].load_factor
        asked = verdict.asked_too_much(self.problem, self.solution, tried, reached)
        why = asked or str(error)
        words = verdict.unconverged(why, self.scene.load_steps, tried, reached)
        if self.solution is not None:
            words += verdict.facets_too_straight(self.problem, self.solution)
        return self._stopped_short(words, [*self.history.steps, step])

    def interrupted(self) -> Result:
        """Return the result of load steps that somebody asked to stop; collective."""
        words = "Interrupted" + ("." if self.solution else " before any load step was done.")
        return dataclasses.replace(self._stopped_short(words, self.history.steps), interrupted=True)
