"""How far from the truth every number may be, by source: the error budget of a run.

Sources are the mesh, the penalties ε₁, the regularisation ε, what the iterations leave, the load
steps, and the piece of a half-space that is meshed. Each is estimated on its own; what all may make
together is taken to be their sum.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from fenics_contact.common.timings import ESTIMATING, doing
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.quantities import (
    contact_quantities,
    global_quantities,
    preload_records,
    support_records,
)
from fenics_contact.problem.problem import Problem
from fenics_contact.results.quantities import QUANTITIES, QuantityValue, reactions_by_name
from fenics_contact.results.records.contacts import PreloadRecord, ReactionRecord, SupportRecord
from fenics_contact.scene.quantity_names import OF_PRELOADS, OfPreload, Reaction
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.convergence.unbounded import Unbounded
from fenics_contact.trust.error_estimates.half_space import domain_errors
from fenics_contact.trust.error_estimates.load_steps import step_errors
from fenics_contact.trust.error_estimates.mesh.estimate import mesh_errors
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors
from fenics_contact.trust.error_estimates.parameters import (
    iteration_errors,
    penalty_errors,
    regularisation_errors,
)

SOURCES = ("mesh", "penalty", "regularisation", "iteration", "step", "domain")
# Histories of at most so many steps are solved again without being asked for.
_SHORT = 4

Row = dict[str, float | None]
# None where a source was not estimated.
Errors = Mapping[Hashable, float] | None


@dataclass(frozen=True)
class ErrorBudget:
    """Estimated absolute errors, of vectors the length of the difference.

    Attributes:
        quantities: Quantity → source → error, and ``total``; None where it was not estimated.
        contacts: The same of every contact, in scene order.
        supports: The same of every support.
        reactions: The same of all supports of a name together, by that.
        preloads: The same of every preload, by its name.
        notes: Sentences that say what was not estimated, and why.
        local: Errors of the cells, where those by the mesh were estimated.
        unbounded: What does not converge, by the keys of quantities, of a contact by its number
            and the name, of supports a ``Reaction``, with the sentence that says why.
    """

    quantities: dict[str, Row] = field(default_factory=dict)
    contacts: list[dict[str, Row]] = field(default_factory=list)
    supports: list[dict[str, Row]] = field(default_factory=list)
    reactions: dict[str, dict[str, Row]] = field(default_factory=dict)
    preloads: dict[str, dict[str, Row]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    local: LocalErrors | None = None
    unbounded: dict[Hashable, str] = field(default_factory=dict)

    def of_contact(self, number: int) -> dict[str, Row]:
        """``errors`` of a contact for ``result.json``, where there are any."""
        return self.contacts[number] if self.contacts else {}

    def of_supports(self, supports: list[SupportRecord]) -> list[SupportRecord]:
        """``supports`` of ``result.json``, with ``errors`` where there are any.

        Args:
            supports: Without.
        """
        if not self.supports:
            return supports
        rows = zip(supports, self.supports, strict=True)
        return [replace(support, errors=errors) for support, errors in rows]

    def of_reactions(self, supports: list[SupportRecord]) -> dict[str, ReactionRecord]:
        """``reactions`` of ``result.json``, with ``errors`` where there are any.

        Args:
            supports: As of ``of_supports``.
        """
        return {
            name: ReactionRecord(reaction=reaction, errors=self.reactions.get(name, {}))
            for name, reaction in reactions_by_name(supports).items()
        }

    def of_preloads(self, preloads: Mapping[str, PreloadRecord]) -> dict[str, PreloadRecord]:
        """``preloads`` of ``result.json``, with ``errors`` where there are any.

        Args:
            preloads: Without.
        """
        return {
            name: replace(preload, errors=self.preloads.get(name, {}))
            for name, preload in preloads.items()
        }


def error_budget(load_steps: LoadSteps, steps: Sequence[Mapping[str, Any]]) -> ErrorBudget:
    """Estimate the errors of the last load step's quantities; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        steps: What came out of all load steps, as in ``result.json``.

    Returns:
        Nothing where the scene has ``solver.errors = "none"``.
    """
    problem = load_steps.problem
    if problem.scene.solver.errors == "none" or load_steps.last is None:
        return ErrorBudget()
    measure = _Measure(load_steps)
    answer = measure(load_steps.last.solution)
    estimates = _Estimates(load_steps, measure, steps)
    found, notes = estimates.all()
    last = load_steps.last.unknowns
    unbounded = Unbounded(problem, last.displacement, last.time)
    rows, why = unbounded.strip({key: _row(key, found) for key in answer}, answer)
    notes += dict.fromkeys(why.values())
    every = {key: row for key, row in rows.items() if isinstance(key, str)}
    if len(steps) > 1:  # what is measured is that of the last forces alone
        every["external_work"] = _of_work(every, steps[-1]["quantities"].get("energy_defect"))
    contacts = [
        {key[1]: row for key, row in rows.items() if isinstance(key, tuple) and key[0] == number}
        for number in range(len(problem.contacts))
    ]
    of = {key.of: {"reaction": row} for key, row in rows.items() if isinstance(key, Reaction)}
    preloads: dict[str, dict[str, Row]] = {}
    for key, row in rows.items():
        if isinstance(key, OfPreload):
            preloads.setdefault(key.name, {})[key.quantity] = row
    return ErrorBudget(
        quantities=every,
        contacts=contacts,
        supports=[of[number] for number in range(len(problem.applied_supports))],
        reactions={name: row for name, row in of.items() if isinstance(name, str)},
        preloads=preloads,
        notes=notes,
        local=estimates.local,
        unbounded=why,
    )


class _Measure:
    """Quantities of a solution, called in its state.

    Of a contact by its number and the name, of supports by a ``Reaction``.
    """

    def __init__(self, load_steps: LoadSteps) -> None:
        assert load_steps.last is not None
        self._problem = load_steps.problem
        self._answer = load_steps.last.solution
        self._of_answer: dict[Hashable, QuantityValue] = {}

    def __call__(self, solution: Solution) -> dict[Hashable, QuantityValue]:
        """Of a solution; collective."""
        if solution is not self._answer:
            return self._measured(solution)
        if not self._of_answer:
            self._of_answer = self._measured(solution)
        return self._of_answer

    def _measured(self, solution: Solution) -> dict[Hashable, QuantityValue]:
        problem = self._problem
        forces = BulkForces(problem, solution)
        supports = support_records(forces)
        contacts = [contact_quantities(problem, solution, i) for i in range(len(problem.contacts))]
        every = global_quantities(forces, contacts)
        found: dict[Hashable, QuantityValue] = _known(every)
        found.update(problem.points.quantities(solution.displacement))
        for number, of_contact in enumerate(contacts):
            found |= {(number, name): value for name, value in _known(of_contact).items()}
        return found | _reactions(supports) | _preloads(preload_records(problem, solution))


def _reactions(supports: list[SupportRecord]) -> dict[Hashable, QuantityValue]:
    """Of each support, and of those of each name together."""
    found: dict[Hashable, QuantityValue] = {
        Reaction(number): row.reaction for number, row in enumerate(supports)
    }
    return found | {Reaction(name): sum_ for name, sum_ in reactions_by_name(supports).items()}


def _preloads(records: Mapping[str, PreloadRecord]) -> dict[Hashable, QuantityValue]:
    """Force and elongation of each."""
    return {
        OfPreload(name, quantity): record[quantity]
        for name, record in records.items()
        for quantity in OF_PRELOADS
    }


def _known(quantities: Mapping[str, Any]) -> dict[Hashable, QuantityValue]:
    """Those that have a true value, and one here: the force along no axis is none."""
    return {name: quantities[name] for name in QUANTITIES if quantities.get(name) is not None}


class _Estimates:
    """The estimate of each source, where the scene has it and it is to be made.

    Attributes:
        local: Of the cells, once the error by the mesh has been estimated.
    """

    def __init__(
        self, load_steps: LoadSteps, measure: _Measure, steps: Sequence[Mapping[str, Any]]
    ) -> None:
        self._load_steps, self._measure, self._steps = load_steps, measure, steps
        self._times = [step["load_factor"] for step in steps]
        self._problem = load_steps.problem
        system = load_steps.newton.system
        scene = self._problem.scene
        self._wants_all = scene.solver.errors == "all" or scene.accuracy is not None
        self._is_cheap = isinstance(system, CondensedSystem)
        self._solver = system.name
        self._notes: list[str] = []
        self.local: LocalErrors | None = None

    def all(self) -> tuple[dict[str, Errors], list[str]]:
        """Of all sources by name, with {} for one that the scene does not have; and notes."""
        if not (self._is_cheap or self._wants_all):
            note = (
                f"Errors were not estimated, which with the {self._solver} solver takes about as "
                'long as the run: solver.errors = "all" does it.'
            )
            return {source: None if self._has(source) else {} for source in SOURCES}, [note]
        return {source: self._of(source) for source in SOURCES}, self._notes

    def _has(self, source: str) -> bool:
        problem = self._problem
        return {
            "mesh": True,
            "penalty": any(contact.has_penalty for contact in problem.contacts),
            "regularisation": any(one.friction.has_regularisation for one in problem.contacts),
            "iteration": True,
            "step": _remembers(problem),
            "domain": problem.far_field is not None,
        }[source]

    def _of(self, source: str) -> Errors:
        if not self._has(source):
            return {}
        again = self._times if self._takes_history(source) else ()
        if len(again) > _SHORT and not self._wants_all:
            note = (
                "Errors by penalty, regularisation and load steps were not estimated, as friction "
                'remembers its path: solver.errors = "all" solves the whole history again.'
            )
            if note not in self._notes:
                self._notes.append(note)
            return None
        if source == "mesh" and any(contact.wear.wears for contact in self._problem.contacts):
            self._notes.append(
                "The error by the mesh is not estimated where contacts wear: what was worn before "
                "has a part in it."
            )
            return None
        load_steps, measure = self._load_steps, self._measure
        estimate: dict[str, Callable[[], Errors]] = {
            "mesh": self._of_mesh,
            "penalty": lambda: penalty_errors(load_steps, measure, again),
            "regularisation": lambda: regularisation_errors(load_steps, measure, again),
            "iteration": lambda: iteration_errors(load_steps, measure),
            "step": lambda: step_errors(load_steps, measure, again),
            "domain": lambda: domain_errors(load_steps, measure),
        }
        doing(f"{ESTIMATING} by {_WORDS[source]}")
        found = estimate[source]()
        if found is None:
            self._notes.append(
                f"The error by {_WORDS[source]} was not estimated: solving again with less of it "
                "did not converge."
            )
        return found

    def _of_mesh(self) -> Errors:
        assert self._load_steps.last is not None
        answer = self._measure(self._load_steps.last.solution)
        recorded = [(step["load_factor"], _recorded(step, answer)) for step in self._steps]
        again = self._times if self._takes_history("penalty") else []
        again = again if len(again) <= _SHORT or self._wants_all else []
        found, self.local = mesh_errors(self._load_steps, self._measure, recorded, again)
        if found is not None:
            for key, error in self._shared().items():
                if key in found:
                    found[key] += error
        if found is not None and "max_contact_pressure" not in found:
            self._notes.append(
                "The largest contact pressure has no error bar: cells are too coarse there, or it "
                "grows with every refinement, as under a corner of an obstacle."
            )
        return found

    def _shared(self) -> dict[Hashable, float]:
        """What is not known of reactions where supports meet; collective."""
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


_WORDS = {
    "mesh": "the mesh",
    "penalty": "the penalty",
    "regularisation": "the regularisation",
    "iteration": "the iterations",
    "step": "the load steps",
    "domain": "the piece of the half-space",
}


def _recorded(
    step: Mapping[str, Any], answer: Mapping[Hashable, QuantityValue]
) -> dict[Hashable, QuantityValue]:
    """Quantities of a load step by the keys of ``_Measure``, those that it has."""
    found: dict[Hashable, QuantityValue] = dict(answer) | _reactions(step["supports"])
    found |= _preloads(step.get("preloads", {}))
    for key in answer:
        if isinstance(key, str | tuple):
            of, name = (step["contacts"][key[0]], key[1]) if isinstance(key, tuple) else (step, key)
            recorded = of["quantities"].get(name)
            found[key] = answer[key] if recorded is None else recorded
    return found


def _remembers(problem: Problem) -> bool:
    """Whether the answer depends on load steps: friction, wear, locked bolts, new pairings."""
    if any(contact.remembers for contact in problem.contacts):
        return True
    if any(preload.is_locked for preload in problem.preloads):
        return True
    return any(contact.kinematics.paired_at is not None for contact in problem.contacts)


def _row(key: Hashable, found: Mapping[str, Errors]) -> Row:
    """Errors of a quantity by source, and their sum; a source that is not there makes none."""
    row: Row = {}
    for source, errors in found.items():
        row[source] = None if errors is None else (errors.get(key) if errors else 0.0)
    return row | {"total": _sum(list(row.values()))}


def _sum(values: Sequence[float | None]) -> float | None:
    """None where one is."""
    known = [value for value in values if value is not None]
    return sum(known) if len(known) == len(values) else None


def _of_work(rows: Mapping[str, Row], defect: float | None) -> Row:
    """Of the work along a path: it went into energies and friction, so it is as wrong as these.

    Args:
        rows: Of other quantities.
        defect: What the steps leave open of that balance; None without one, as with the static law,
            where only sources that are not there make no error.
    """
    names = ("strain_energy", "penalty_energy", "friction_work", "elastic_slip_energy")
    parts = [rows[name] for name in names if name in rows]
    row = {source: _sum([part[source] for part in parts]) for source in SOURCES}
    if defect is None:
        row = {source: 0.0 if error == 0 else None for source, error in row.items()}
    else:
        row["step"] = _sum([row["step"], abs(defect)])
    return row | {"total": _sum(list(row.values()))}
