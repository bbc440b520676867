"""The estimate of each source of errors, where the scene has it and it is to be made."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cached_property, partial
from typing import Any

from fenics_contact.common.failures import attempt
from fenics_contact.common.timings import ESTIMATING, doing
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import MAX_CONTACT_PRESSURE, REACTION_MOMENT
from fenics_contact.scene.loading.load_paths import cycles_of, knots, moduli_change
from fenics_contact.scene.quantity_names import Reaction
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.linear_change import (
    NO_STICK,
    LinearChange,
    LinearHistory,
    without_stick,
)
from fenics_contact.trust.error_estimates.load_steps import (
    CoarseHistory,
    between_turns,
    step_errors,
)
from fenics_contact.trust.error_estimates.measured import (
    TOO_STIFF,
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
# How much work the estimate of each is, about, for who watches.
_WORK = {
    "mesh": 8,
    "penalty": 1,
    "regularisation": 1,
    "iteration": 1,
    "step": 1,
    "domain": 1,
}
# Histories of at most so many steps are solved again without being asked for.
_SHORT = 4

# Newton steps that the estimate of a source may take over those of the answer: it solves four to
# ten times for something else, mostly in fewer steps. An answer in few steps counts as one in more.
_AT_MOST, _FEW = 20, 10
# The same where each costs much and the estimate was not asked for.
_AT_MOST_UNASKED = 0.25
# How often all load steps are taken by their tangents for the errors that are found along them,
# each time about as a Newton step. Together no more than the answer took, or than a few.
_PATHS, _ANYWAY = 6, 24

_NO_STEPS = (
    "The error by the load steps was not estimated, as the loads turn at both ends of a load step, "
    'or surfaces wear or slide far: solver.errors = "all" solves the whole history again.'
)

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
        self._can_repeat = system.repeats_history_cheaply
        self._notes: list[str] = []
        self.local: LocalErrors | None = None
        self._parts = between_turns(self._times, knots(scene))
        self._of_cycles = OfCycles(cycles_of(scene), self._times)
        self._own_steps = int(sum(step["newton_iterations"] for step in steps))
        is_asked = self._wants_all or self._can_repeat or not self._is_cheap
        self._more = "" if is_asked else '; solver.errors = "all" takes more'
        share = _AT_MOST if is_asked else _AT_MOST_UNASKED
        self._most = max(int(share * max(self._own_steps, _FEW)), 1)
        is_short = len(self._times) <= _SHORT and self._can_repeat
        self._takes_all = self._wants_all or is_short
        is_smooth = load_steps.newton.exact is None
        # The tangent knows nothing of how temperatures follow pressures, and moduli these.
        follows = self._problem.conduction is not None or moduli_change(scene)
        by_tangent = self._is_cheap and is_smooth and not follows
        self._is_linear = by_tangent and not (self._can_repeat or self._wants_all)

    def all(self) -> tuple[dict[str, Errors], list[str]]:
        """Return the errors of all sources, {} for one that the scene lacks; and notes."""
        return {source: self._of(source) for source in SOURCES}, self._notes

    def _has(self, source: str) -> bool:
        problem = self._problem
        is_exact = self._load_steps.newton.exact is not None
        return {
            "mesh": True,
            "penalty": any(contact.has_penalty for contact in problem.contacts) and not is_exact,
            "regularisation": not is_exact
            and any(one.friction.regularisation.is_numerical for one in problem.contacts),
            "iteration": True,
            "step": _remembers(problem),
            "domain": problem.far_field is not None,
        }[source]

    def _of(self, source: str) -> Errors:
        """Return the errors of a source, {} for one that the scene lacks; collective."""
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
        _tell(source, 0.0)
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
            f"{self._more}"
        )

    def _not_here(self, source: str) -> str | None:
        """Why there is no estimate of a source, asked for or not; None where there is one."""
        if source == "mesh" and any(contact.wear.wears for contact in self._problem.contacts):
            return (
                "The error by the mesh is not estimated where contacts wear: what was worn before "
                "has a part in it."
            )
        problem = self._problem
        if source == "mesh" and problem.conduction is not None and problem.elastic.mixed:
            return (
                "The error by the mesh is not estimated where heat flows through nearly "
                "incompressible material."
            )
        return None

    def _too_dear(self, source: str) -> str | None:
        """Why a source is estimated on demand alone, None for one that is at once.

        Where another answer costs about as much as it did first, the sources that take one or two
        from near by are had; others take many, or begin anew.
        """
        takes_few = self._takes_all or self._takes_fewer
        if self._is_linear:
            return self._too_long(source)
        if self._takes_history(source) and not (self._can_repeat and takes_few):
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

    def _too_long(self, source: str) -> str | None:
        """Why a source is not estimated by tangents alone; None for one that is.

        Those that are found along all load steps take each of these several times.
        """
        steps = _PATHS * len(self._times)
        if source == "step" and not self._linear_history.tells_steps:
            return _NO_STEPS
        if source not in ("mesh", "step") or not self._follows_path:
            return None
        if steps <= max(self._own_steps, _ANYWAY):
            return None
        return (
            "Errors by the mesh and the load steps were not estimated, which takes about as much "
            f"as {steps} Newton steps, and the answer took {self._own_steps}: solver.errors = "
            '"all" solves the whole history again.'
        )

    @property
    def _takes_fewer(self) -> bool:
        """Whether fewer load steps tell at little cost; scalars of a body begin at their starts."""
        pays = self._can_repeat and CoarseHistory.pays(self._parts)
        return pays and not self._problem.body_scalars

    @cached_property
    def _coarse(self) -> CoarseHistory:
        """The history in fewer load steps."""
        return CoarseHistory(self._load_steps, self._measure, self._parts)

    @cached_property
    def _linear(self) -> LinearChange:
        """Changes of the answer by its tangent."""
        return LinearChange(self._load_steps, self._measure, len(self._times))

    @cached_property
    def _linear_history(self) -> LinearHistory:
        """All load steps by the tangents at their ends."""
        return LinearHistory(self._load_steps, self._measure, self._times)

    @cached_property
    def _again(self) -> Again | None:
        """How the answer with something changed is found; None where it is not.

        Of what remembers its path from the start; in fewer load steps, where these are many.
        """
        if self._is_linear:
            # The length of a locked bolt is that of an earlier load step.
            locks = any(one.keeps_last for one in self._problem.body_scalars)
            return self._linear_history.again if locks else self._linear.again
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
        if self._is_linear:
            found = self._linear_history.step_errors()
            return None if found is None else without_losses(found)
        if self._takes_all:
            return step_errors(self._load_steps, self._measure, self._parts)
        return self._coarse.step_errors()

    def _of_mesh(self) -> Errors:
        assert self._load_steps.last is not None
        answer = self._measure(self._load_steps.last.solution)
        rows = [(step["load_factor"], recorded(step, answer)) for step in self._steps]
        if self._is_linear:
            single = self._linear.again
            drawn = again = self._linear_history.again if self._follows_path else single
            if again is None:
                return None
        else:
            last = Again.of_last_step(self._load_steps, self._measure, roughly=True)
            single = Again.of_last_step(self._load_steps, self._measure)
            again = (self._again if self._takes_history("penalty") else None) or last
            drawn = again if self._takes_all else last
        calls = (self._load_steps, self._measure, rows, again, drawn, single, self._notes)
        found, self.local = mesh_errors(*calls, partial(_tell, "mesh"))
        if found is not None:
            for key, error in self._shared().items():
                if key in found:
                    found[key] += error
        if found is not None and again.walk is None:
            found = without_losses(found)
        if found is not None and self._is_linear and self._problem.frictional:
            found = without_stick(found)
            self._notes.append(NO_STICK)
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
        shared, turned = problem.shared_reactions, problem.support_moments.of_unit_rotations
        moved = last.solution.displacement
        found: dict[Hashable, float] = {}
        for of, numbers in groups.items():
            found[Reaction(of)] = shared.unknown(needed, moved, numbers)
            way = turned(numbers[0], shared.dofs)
            moment = Reaction(of, REACTION_MOMENT)
            found[moment] = shared.unknown_along(way, needed, moved, numbers)
        return found

    def _takes_history(self, source: str) -> bool:
        """Whether an estimate takes all load steps again, not the last one alone."""
        return source == "step" or (self._follows_path and source in ("penalty", "regularisation"))

    @property
    def _follows_path(self) -> bool:
        """Whether what a change does depends on several load steps."""
        return len(self._times) > 1 and _remembers(self._problem)


def _tell(source: str, share: float) -> None:
    """Say that the estimate of a source is being made, and what share of it is done."""
    before = sum(_WORK[one] for one in SOURCES[: SOURCES.index(source)])
    done = (before + share * _WORK[source]) / sum(_WORK.values())
    doing(f"{ESTIMATING} by {_WORDS[source]}", done)


def _remembers(problem: Problem) -> bool:
    """Whether the answer depends on load steps: friction, wear, locked scalars, new pairings."""
    if any(contact.is_path_dependent for contact in problem.contacts):
        return True
    if any(unknown.keeps_last for unknown in problem.unknowns):
        return True
    return any(contact.kinematics.paired_at is not None for contact in problem.contacts)
