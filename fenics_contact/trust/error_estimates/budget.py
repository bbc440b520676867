"""How far from the truth every number may be, by source: the error budget of a run.

Sources are the mesh, the penalties ε₁, the regularisation ε, what the iterations leave, the load
steps, and the piece of a half-space that is meshed. Each is estimated on its own; what all may make
together is taken to be their sum.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace

from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    ELASTIC_SLIP_ENERGY,
    ENERGY_DEFECT,
    EXTERNAL_WORK,
    FRICTION_WORK,
    PENALTY_ENERGY,
    REACTION,
    REACTION_MOMENT,
    SPRING_ENERGY,
    STRAIN_ENERGY,
)
from fenics_contact.results.quantities import (
    quantities_of_scalars,
    reactions_by_name,
    scalars_of_step,
)
from fenics_contact.results.records.contacts import (
    CouplingRecord,
    ReactionRecord,
    ScalarRecord,
    SupportRecord,
)
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.quantity_names import LossOfCycle, OfScalar, Reaction
from fenics_contact.scene.scene import Scene
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.convergence.coarse_contacts import (
    CoarseContact,
    coarse_contacts,
    notes_on,
    without_bars,
)
from fenics_contact.trust.convergence.unbounded import Unbounded
from fenics_contact.trust.error_estimates.estimates import SOURCES, Errors, Estimates
from fenics_contact.trust.error_estimates.measured import Measured, known_quantities
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors

_OF_MOTION = (
    'Errors of a motion were not estimated: solver.errors = "all" solves it again, with half the '
    "step, on a finer mesh, and with less of all else."
)

_OF_FINITE_STRAINS = (
    "Errors are not estimated in finite strains yet: compare with a finer mesh, and with twice as "
    "many load steps."
)

Row = dict[str, float | None]


@dataclass(frozen=True)
class ErrorBudget:
    """Estimated absolute errors, of vectors the length of the difference.

    Attributes:
        quantities: Quantity → source → error, and ``total``; None where it was not estimated.
        contacts: The same of every contact, in scene order.
        supports: The same of every support.
        reactions: The same of all supports of a name together, by that.
        scalars: The same of every scalar unknown that results name, by that name.
        losses: Of what friction dissipates in a cycle of loads, by its key.
        notes: Sentences that say what was not estimated, and why.
        local: Errors of the cells, where those by the mesh were estimated.
        unbounded: What does not converge, by the keys of quantities, of a contact by its number
            and the name, of supports a ``Reaction``, with the sentence that says why.
        coarse: Contacts for which the mesh is too coarse.
    """

    quantities: dict[str, Row] = field(default_factory=dict)
    contacts: list[dict[str, Row]] = field(default_factory=list)
    supports: list[dict[str, Row]] = field(default_factory=list)
    reactions: dict[str, dict[str, Row]] = field(default_factory=dict)
    scalars: dict[str, dict[str, Row]] = field(default_factory=dict)
    losses: dict[LossOfCycle, Row] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    local: LocalErrors | None = None
    unbounded: dict[Hashable, str] = field(default_factory=dict)
    coarse: list[CoarseContact] = field(default_factory=list)

    @classmethod
    def of_rows(cls, rows: Mapping[Hashable, Row], contacts: int, supports: int) -> ErrorBudget:
        """From the errors of each quantity.

        Args:
            rows: By the keys of ``Measured``.
            contacts: How many there are.
            supports: Likewise.
        """
        of_contacts: list[dict[str, Row]] = [{} for _ in range(contacts)]
        of: dict[int | str, dict[str, Row]] = {}
        for key, row in rows.items():
            if isinstance(key, Reaction):
                of.setdefault(key.of, {})[key.quantity] = row
            if isinstance(key, tuple):
                of_contacts[key[0]][key[1]] = row
        return cls(
            quantities={key: row for key, row in rows.items() if isinstance(key, str)},
            contacts=of_contacts,
            supports=[of[number] for number in range(supports)],
            reactions={name: row for name, row in of.items() if isinstance(name, str)},
            scalars=_by_scalar(rows),
            losses={key: row for key, row in rows.items() if isinstance(key, LossOfCycle)},
        )

    def of_contact(self, number: int) -> dict[str, Row]:
        """``errors`` of a contact for ``result.json``, where there are any."""
        return self.contacts[number] if self.contacts else {}

    def of_supports(self, supports: list[SupportRecord]) -> list[SupportRecord]:
        """``supports`` of ``result.json``, with ``errors`` where there are any."""
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
            name: ReactionRecord(**quantities, errors=self.reactions.get(name, {}))
            for name, quantities in reactions_by_name(supports).items()
        }

    def of_scalars(self, records: Mapping[str, ScalarRecord]) -> dict[str, ScalarRecord]:
        """Records of scalar unknowns of ``result.json``, with ``errors`` where there are any."""
        return {
            name: replace(record, errors=self.scalars.get(name, {}))
            for name, record in records.items()
        }

    def of_couplings(
        self, records: Sequence[CouplingRecord], numbers: Sequence[int]
    ) -> list[CouplingRecord]:
        """``couplings`` of ``result.json``, with ``errors`` where there are any.

        Args:
            records: Without them.
            numbers: Those of the couplings among the applied supports.
        """
        if not self.supports:
            return list(records)
        found = []
        for record, number in zip(records, numbers, strict=True):
            forces = self.supports[number]
            known = {"force": forces.get(REACTION), "moment": forces.get(REACTION_MOMENT)}
            errors = self.scalars.get(record.name, {}) | {k: row for k, row in known.items() if row}
            found.append(replace(record, errors=errors))
        return found


def _by_scalar(rows: Mapping[Hashable, Row]) -> dict[str, dict[str, Row]]:
    """The errors of scalar unknowns among those of all, by their names and quantities."""
    found: dict[str, dict[str, Row]] = {}
    for key, row in rows.items():
        if isinstance(key, OfScalar):
            found.setdefault(key.name, {})[key.quantity] = row
    return found


def unknown_budget(scene: Scene, step: StepRecord) -> ErrorBudget:
    """Return the budget of errors that could not be estimated: no quantity has a bar."""
    if scene.solver.errors == "none":
        return ErrorBudget()
    row: Row = dict.fromkeys((*SOURCES, "total"))
    return ErrorBudget(
        quantities={name: row for name in _named(step.quantities)},
        contacts=[{name: row for name in _named(one.quantities)} for one in step.contacts],
        supports=[dict.fromkeys(one.quantities, row) for one in step.supports],
        reactions={
            name: dict.fromkeys(quantities, row)
            for name, quantities in reactions_by_name(step.supports).items()
        },
        scalars=_by_scalar(dict.fromkeys(quantities_of_scalars(scalars_of_step(step)), row)),
    )


def _named(quantities: Quantities) -> list[str]:
    """Return the names of quantities that have a true value."""
    return [name for name in known_quantities(quantities) if isinstance(name, str)]


def error_budget(load_steps: LoadSteps, steps: Sequence[StepRecord]) -> ErrorBudget:
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
    if problem.inertia.moves:
        return ErrorBudget(notes=[] if problem.scene.solver.errors == "all" else [_OF_MOTION])
    if not problem.elastic.is_linear:
        return replace(unknown_budget(problem.scene, steps[-1]), notes=[_OF_FINITE_STRAINS])
    measure = Measured(load_steps)
    answer = measure(load_steps.last.solution)
    estimates = Estimates(load_steps, measure, steps)
    found, notes = estimates.all()
    last = load_steps.last
    unbounded = Unbounded(problem, last.solution, last.unknowns.time)
    rows = {key: row_of(key, found) for key in answer} | _given(problem)
    rows, why = unbounded.strip(rows, answer)
    notes += dict.fromkeys(why.values())
    coarse = coarse_contacts(load_steps)
    rows |= {key: rows[key] | {"mesh": None, "total": None} for key in without_bars(rows, coarse)}
    notes += notes_on(coarse)
    if len(steps) > 1:  # what is measured is that of the last forces alone
        every = {key: row for key, row in rows.items() if isinstance(key, str)}
        none = {source for source, errors in found.items() if errors == {}}
        defect = steps[-1]["quantities"].get(ENERGY_DEFECT)
        rows[EXTERNAL_WORK] = _of_work(every, defect, none)
    budget = ErrorBudget.of_rows(rows, len(problem.contacts), len(problem.applied_supports))
    return replace(budget, notes=notes, unbounded=why, local=estimates.local, coarse=coarse)


def _given(problem: Problem) -> dict[Hashable, Row]:
    """Forces on the body's scalars that are given at the end, which have no error."""
    given = [one.key_of_force for one in problem.body_scalars if not one.is_locked]
    return {key: dict.fromkeys((*SOURCES, "total"), 0.0) for key in given if key is not None}


def row_of(key: Hashable, found: Mapping[str, Errors]) -> Row:
    """Errors of a quantity by source, and their sum; a source that is not there makes none."""
    row: Row = {}
    for source, errors in found.items():
        row[source] = None if errors is None else (errors.get(key) if errors else 0.0)
    return row | {"total": _sum(list(row.values()))}


def _sum(values: Sequence[float | None]) -> float | None:
    """None where one is."""
    known = [value for value in values if value is not None]
    return sum(known) if len(known) == len(values) else None


def _of_work(rows: Mapping[str, Row], defect: float | None, none: Set[str]) -> Row:
    """Return the error of the work along a path: that of the energies and friction it went into.

    Args:
        rows: Of other quantities.
        defect: What the steps leave open of that balance; None without one, as with the static law,
            where only sources that are not there make no error.
        none: These.
    """
    stored = (STRAIN_ENERGY, SPRING_ENERGY, PENALTY_ENERGY, ELASTIC_SLIP_ENERGY)
    names = (*stored, FRICTION_WORK)
    parts = [rows[name] for name in names if name in rows]
    row = {source: _sum([part[source] for part in parts]) for source in SOURCES}
    if defect is None:
        row = {source: 0.0 if source in none else None for source in SOURCES}
    else:
        row["step"] = _sum([row["step"], abs(defect)])
    return row | {"total": _sum(list(row.values()))}
