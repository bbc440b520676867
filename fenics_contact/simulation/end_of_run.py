"""The end of a run: checks, other answers, error bars, and its result."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from mpi4py import MPI

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.failures import attempt
from fenics_contact.common.timings import CHECKING, LOOKING_AHEAD, SEARCHING, Timings, doing
from fenics_contact.evaluate.couplings import coupling_records
from fenics_contact.evaluate.quantities import contact_points
from fenics_contact.evaluate.sector import sector_record
from fenics_contact.problem.existence.condition import FreeMotion
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import SLIP_FACTOR
from fenics_contact.results.load_history import cycles_record
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.records.run import Model, Seconds
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Check, Result
from fenics_contact.results.tables import cycle_words
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.settings import SolverSettings
from fenics_contact.simulation import verdict
from fenics_contact.simulation.analysis_tasks import AnalysisTasks
from fenics_contact.simulation.description import model_of, record_of, units_of
from fenics_contact.simulation.modes_of_motion import ChosenModes
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.solve.load_steps.accepted_step import Unknowns
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.solver_choice import SolverChoice
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.convergence.unseen import judged_by_depth
from fenics_contact.trust.error_estimates.budget import ErrorBudget, unknown_budget
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors
from fenics_contact.trust.error_estimates.solving_again import restore
from fenics_contact.trust.exact_bias import Bias, exact_bias
from fenics_contact.trust.slip_factor import SlipFactor, slip_factor
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
        slip: By how much varying loads can grow until a part slips as a whole.
        slip_near: Factor of the loads that is tried first for it; None where none is known.
        bias: What penalty and smoothing of friction change, measured.
        slip_errors: Estimated errors of that by source; empty where they are not.
        notes: Sentences on what could not be found beside the answer.
        interrupted: Whether somebody asked to stop before all of it was found.
    """

    last: Unknowns | None = None
    others: OtherAnswers = field(default_factory=OtherAnswers)
    budget: ErrorBudget = field(default_factory=ErrorBudget)
    checks: dict[str, Check] = field(default_factory=dict)
    slip: SlipFactor = field(default_factory=SlipFactor)
    slip_near: float | None = None
    bias: Bias = field(default_factory=Bias)
    slip_errors: dict[str, float | None] = field(default_factory=dict)
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
        doing(CHECKING)
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
        doing(SEARCHING)
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

    def measure_bias(self, load_steps: LoadSteps, timings: Timings) -> None:
        """Measure what penalty and smoothing change in the last load step; collective.

        Args:
            load_steps: At their end.
            timings: To which what it takes is counted.
        """
        failed: list[str] = []
        missing = "What penalty and smoothing change was not measured"
        with timings.phase("output"):
            measure = partial(exact_bias, load_steps)
            self.bias = attempt(load_steps.problem.comm, missing, measure, Bias(), failed)
        if self.bias.check is not None:
            self.checks = self.checks | {"regularisation": self.bias.check}
        self.notes += self.bias.notes + failed
        if failed:
            restore(load_steps)

    def look_ahead(self, load_steps: LoadSteps, timings: Timings, settings: SolverSettings) -> None:
        """Find by how much loads can grow until a part slips, where that is asked for; collective.

        Args:
            load_steps: At their end.
            timings: To which what it takes is counted.
            settings: How the scene is solved.
        """
        by_steps = settings.slip_limit == "steps"
        if settings.errors == "none" and not by_steps:
            return
        doing(LOOKING_AHEAD)
        missing = "By how much loads can grow until a part slips was not found"
        find = partial(slip_factor, load_steps, by_steps, self.slip_near)
        failed: list[str] = []
        with timings.phase("output"):
            self.slip = attempt(load_steps.problem.comm, missing, find, SlipFactor(), failed)
        if failed:
            self.notes += failed
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
                bias=self.end.bias.of_contact(number),
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
        slip, errors = self.end.slip, self.end.budget.quantities
        if near is not None and slip.factor is not None:
            near = dataclasses.replace(
                near, factor=slip.factor, kind=slip.kind, motion=slip.motion or near.motion
            )
            if not slip.is_bound:
                quantities = {**quantities, SLIP_FACTOR: slip.factor}
            if self.end.slip_errors:
                near = dataclasses.replace(near, errors={"factor": self.end.slip_errors})
                errors = {**errors, SLIP_FACTOR: self.end.slip_errors}
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
            couplings=self.end.budget.of_couplings(
                coupling_records(problem, solution, history.supports), problem.couplings.tolist()
            ),
            quantities=quantities,
            steps=history.steps,
            cycles=cycles,
            slip_limit=near,
            checks=checks,
            branches=self.end.others.branches,
            errors=errors,
            bias=self.end.bias.quantities,
            error_notes=self.end.budget.notes,
            timings=Seconds(**self.timings.summary(problem.comm)),
            versions=compat.versions(),
            units=units_of(self.scene, quantities),
            cyclic_symmetry=sector_record(history.forces, quantities),
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
