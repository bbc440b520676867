"""The estimate of each source of errors, where the scene has it and it is to be made."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cached_property
from typing import Any

from fenics_contact.common.failures import attempt
from fenics_contact.common.timings import ESTIMATING, doing
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import MAX_CONTACT_PRESSURE
from fenics_contact.scene.loading.load_paths import cycles_of, knots
from fenics_contact.scene.quantity_names import Reaction
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.held_back import TOO_STIFF
from fenics_contact.trust.error_estimates.load_steps import (
    CoarseHistory,
    between_turns,
    step_errors,
)
from fenics_contact.trust.error_estimates.measured import (
    Measured,
    OfCycles,
    recorded,
    without_losses,
)
from fenics_contact.trust.error_estimates.mesh.estimate import mesh_errors
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors
from fenics_contact.trust.error_estimates.parameters import (
    domain_errors,
    iteration_errors,
    penalty_errors,
    regularisation_errors,
)
from fenics_contact.trust.error_estimates.solving_again import Again, restore

_WORDS = {
    "mesh": "the mesh",
    "penalty": "the penalty",
    "regularisation": "the regularisation",
    "iteration": "the iterations",
    "step": "the load steps",
    "domain": "the piece of the half-space",
}
SOURCES = tuple(_WORDS)
# Histories of at most so many steps are solved again without being asked for.
_SHORT = 4

# Newton steps that the estimate of a source may take over those of the answer: it solves four to
# ten times for something else, mostly in fewer steps. An answer in few steps counts as one in more.
_AT_MOST, _FEW = 20, 10

# None where a source was not estimated.
Errors = Mapping[Hashable, float] | None


class Estimates:
    """The estimate of each source, where the scene has it and it is to be made.

    Attributes:
        local: Of the cells, once the error by the mesh has been estimated.
    """

    def __init__(
        self, load_steps: LoadSteps, measure: Measured, steps: Sequence[Mapping[str, Any]]
    ) -> None:
        self._load_steps, self._measure, self._steps = load_steps, measure, steps
        self._times = [step["load_factor"] for step in steps]
        self._problem = load_steps.problem
        system = load_steps.newton.system
        scene = self._problem.scene
        self._wants_all = scene.solver.errors == "all" or scene.accuracy is not None
        self._is_cheap, self._solver = system.repeats_cheaply, system.name
        self._notes: list[str] = []
        self.local: LocalErrors | None = None
        self._parts = between_turns(self._times, knots(scene))
        self._of_cycles = OfCycles(cycles_of(scene), self._times)
        self._own_steps = int(sum(step["newton_iterations"] for step in steps))
        self._most = _AT_MOST * max(self._own_steps, _FEW)
        self._takes_all = self._wants_all or len(self._times) <= _SHORT

    def all(self) -> tuple[dict[str, Errors], list[str]]:
        """Return the errors of all sources, {} for one that the scene lacks; and notes."""
        return {source: self._of(source) for source in SOURCES}, self._notes

    def _has(self, source: str) -> bool:
        problem = self._problem
        return {
            "mesh": True,
            "penalty": any(contact.has_penalty for contact in problem.contacts),
            "regularisation": any(
                one.friction.regularisation.is_numerical for one in problem.contacts
            ),
            "iteration": True,
            "step": _remembers(problem),
            "domain": problem.far_field is not None,
        }[source]

    def _of(self, source: str) -> Errors:
        if not self._has(source):
            return {}
        why = self._not_here(source)
        if why is None and not self._wants_all:
            why = self._too_dear(source)
        if why is not None:
            if why not in self._notes:
                self._notes.append(why)
            return None
        estimate: dict[str, Callable[[], Errors]] = {
            "mesh": self._of_mesh,
            "penalty": lambda: self._by_again(penalty_errors),
            "regularisation": lambda: self._by_again(regularisation_errors),
            "iteration": self._of_iterations,
            "step": self._of_steps,
            "domain": self._of_domain,
        }
        doing(f"{ESTIMATING} by {_WORDS[source]}")
        missing = f"The error by {_WORDS[source]} was not estimated"
        comm, before = self._problem.comm, len(self._notes)
        with self._load_steps.newton.budget.of(self._most, self._used_up):
            found = attempt(comm, missing, estimate[source], None, self._notes)
        if found is None and len(self._notes) > before:
            restore(self._load_steps)
        elif found is None:
            self._notes.append(f"{missing}: solving again with less of it did not converge.")
        return found

    @property
    def _used_up(self) -> str:
        return (
            f"it takes more than {self._most} Newton steps, and the answer took {self._own_steps}"
        )

    def _not_here(self, source: str) -> str | None:
        """Why there is no estimate of a source, asked for or not; None where there is one."""
        if source == "mesh" and any(contact.wear.wears for contact in self._problem.contacts):
            return (
                "The error by the mesh is not estimated where contacts wear: what was worn before "
                "has a part in it."
            )
        return None

    def _too_dear(self, source: str) -> str | None:
        """Why a source is estimated on demand alone, None for one that is at once.

        Where another answer costs about as much as it did first, the sources that take one or two
        from near by are had; others take many, or begin anew.
        """
        takes_few = self._takes_all or self._takes_fewer
        if self._takes_history(source) and not (self._is_cheap and takes_few):
            return (
                "Errors by penalty, regularisation and load steps were not estimated, as friction "
                'remembers its path: solver.errors = "all" solves the whole history again.'
            )
        if source == "mesh" and not self._is_cheap:
            return (
                f"The error by the mesh was not estimated, which with the {self._solver} solver "
                'takes several times as long as the run: solver.errors = "all" does it.'
            )
        return None

    @property
    def _takes_fewer(self) -> bool:
        """Whether fewer load steps tell at little cost; scalars of a body begin at their starts."""
        return CoarseHistory.pays(self._parts) and not self._problem.body_scalars

    @cached_property
    def _coarse(self) -> CoarseHistory:
        """The history in fewer load steps."""
        return CoarseHistory(self._load_steps, self._measure, self._parts)

    @cached_property
    def _again(self) -> Again | None:
        """How the answer with something changed is found; None where it is not.

        Of what remembers its path from the start; in fewer load steps, where these are many.
        """
        if len(self._times) == 1 or not _remembers(self._problem):
            return Again.of_last_step(self._load_steps, self._measure)
        if self._takes_all:
            return Again.of_steps(self._load_steps, self._measure, self._times)
        return self._coarse.again if self._takes_fewer else None

    def _by_again(self, estimate: Callable[[LoadSteps, Again], Errors]) -> Errors:
        return None if self._again is None else estimate(self._load_steps, self._again)

    def _of_iterations(self) -> Errors:
        found = iteration_errors(self._load_steps, self._measure)
        return None if found is None else self._of_cycles.of_steps(found)

    def _of_domain(self) -> Errors:
        found = domain_errors(self._load_steps, self._measure)
        return None if found is None else without_losses(found)

    def _of_steps(self) -> Errors:
        if self._takes_all:
            return step_errors(self._load_steps, self._measure, self._parts)
        return self._coarse.step_errors()

    def _of_mesh(self) -> Errors:
        assert self._load_steps.last is not None
        answer = self._measure(self._load_steps.last.solution)
        rows = [(step["load_factor"], recorded(step, answer)) for step in self._steps]
        last = Again.of_last_step(self._load_steps, self._measure, roughly=True)
        again = (self._again if self._takes_history("penalty") else None) or last
        drawn = again if self._takes_all else last
        calls = (self._load_steps, self._measure, rows, again, drawn, self._notes)
        found, self.local = mesh_errors(*calls)
        if found is not None:
            for key, error in self._shared().items():
                if key in found:
                    found[key] += error
        if found is not None and again.walk is None:
            found = without_losses(found)
        is_told = TOO_STIFF in self._notes
        if found is not None and MAX_CONTACT_PRESSURE not in found and not is_told:
            self._notes.append(
                "The largest contact pressure has no error bar: cells are too coarse there, or it "
                "grows with every refinement, as under a corner of an obstacle."
            )
        return found

    def _shared(self) -> dict[Hashable, float]:
        """Return the unknown part of reactions where supports meet; collective."""
        problem, last = self._problem, self._load_steps.last
        assert last is not None
        needed = BulkForces(problem, last.solution).unbalanced.reshape(-1)
        labels = [support.label for support in problem.applied_supports]
        groups: dict[int | str, list[int]] = {number: [number] for number in range(len(labels))}
        for number, label in enumerate(labels):
            groups.setdefault(label, []).append(number)
        unknown = problem.shared_reactions.unknown
        displacement = last.solution.displacement
        return {
            Reaction(of): unknown(needed, displacement, numbers) for of, numbers in groups.items()
        }

    def _takes_history(self, source: str) -> bool:
        """Whether an estimate takes all load steps again, not the last one alone."""
        several = len(self._times) > 1 and _remembers(self._problem)
        return source == "step" or (several and source in ("penalty", "regularisation"))


def _remembers(problem: Problem) -> bool:
    """Whether the answer depends on load steps: friction, wear, locked scalars, new pairings."""
    if any(contact.is_path_dependent for contact in problem.contacts):
        return True
    if any(unknown.is_locked for unknown in problem.unknowns):
        return True
    return any(contact.kinematics.paired_at is not None for contact in problem.contacts)
