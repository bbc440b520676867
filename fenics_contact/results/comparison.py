"""All that differs between runs, as rows of tables and as sentences."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from fenics_contact.common.wording import one_line
from fenics_contact.quantities import table
from fenics_contact.quantities.table import (
    MEASURED_BY_PRELOADS,
    OF_SUPPORTS,
    has_true_value,
    measured_by,
)
from fenics_contact.results.check_messages import title
from fenics_contact.results.compared_runs import (
    ComparedRun,
    is_made_in_python,
    scene_rows,
    units_of,
)
from fenics_contact.results.quantities import (
    idle_quantities,
    in_figures,
    measured_by_parameter,
    secondary_quantities,
    without_value,
)
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import NO_UNITS, Errors, Quantities
from fenics_contact.results.rounding import Difference, Estimate, difference, sizes_of
from fenics_contact.scene.quantity_names import OF_PRELOADS

# What is said of the model, in this order.
_MODEL = (
    *("kinematics", "symmetry", "degree", "cell", "cells", "dofs", "contact_points", "bodies"),
    *("ranks", "solver", "strategy", "scalar_unknowns", "terms"),
)
_NamesOf: TypeAlias = Callable[[ComparedRun], Sequence[str] | Mapping[str, Any]]
#: In place of what a run does not have.
NOT_THERE = "–"


@dataclass(frozen=True)
class QuantityRow:
    """A quantity of all runs.

    Attributes:
        name: Of it, in words.
        unit: Empty where no run has units.
        values: Of each run, with bars.
        differences: Of each run but the first, from the first; None where one of the two has not
            got the quantity.
    """

    name: str
    unit: str
    values: list[str]
    differences: list[Difference | None]

    @property
    def differs(self) -> bool:
        """Whether a run differs from the first by more than round-off."""
        return any(found is None or found.is_there for found in self.differences)


@dataclass(frozen=True)
class QuantityGroup:
    """Quantities of one thing.

    Attributes:
        title: What they are of.
        rows: Its quantities.
        settings: Name and value in each run of what is no quantity, such as parameters as used.
    """

    title: str
    rows: list[QuantityRow]
    settings: list[list[str]] = field(default_factory=list)

    def only_what_differs(self) -> QuantityGroup:
        """Without rows that are the same in all runs."""
        rows = [row for row in self.rows if row.differs]
        return QuantityGroup(
            self.title, rows, [row for row in self.settings if len(set(row[1:])) > 1]
        )


@dataclass(frozen=True)
class Comparison:
    """Runs side by side; the first is the one that others are compared with.

    Attributes:
        runs: Two or more.
        every: Whether what does not differ is among the rows as well.
    """

    runs: Sequence[ComparedRun]
    every: bool = False

    @property
    def names(self) -> list[str]:
        """Names of the runs."""
        return [run.name for run in self.runs]

    def scene_rows(self) -> list[list[str]]:
        """Key and value in each run of what was asked for."""
        return scene_rows(self.runs, self.every)

    def model_rows(self) -> list[list[str]]:
        """Name and value in each run of what was solved, by what, and how long it took."""
        rows = [
            [key.replace("_", " "), *(in_figures(run.result.model[key]) for run in self.runs)]
            for key in _MODEL
        ]
        rows.append(["load steps", *(str(len(run.result.steps)) for run in self.runs)])
        seconds = [f"{run.result.timings.total:.3g}" for run in self.runs]
        rows.append(["seconds", *seconds])
        programs = dict.fromkeys(name for run in self.runs for name in run.result.versions)
        for name in programs:
            found = (run.result.versions.get(name, NOT_THERE) for run in self.runs)
            rows.append([f"version of {name}", *found])
        return self._shown(rows)

    def check_rows(self) -> list[list[str]]:
        """Name and value in each run of the checks that failed in one of them, or of all."""
        rows = []
        for name in dict.fromkeys(name for run in self.runs for name in run.result.checks):
            found = [run.result.checks.get(name) for run in self.runs]
            words = [
                NOT_THERE
                if check is None
                else f"{'ok' if check.passed else 'FAILED'}, {_short(check.value)} of "
                f"{_short(check.limit)}"
                for check in found
            ]
            if self.every or any(check is not None and not check.passed for check in found):
                rows.append([title(name), *words])
        return rows

    def groups(self) -> list[QuantityGroup]:
        """Quantities of the whole model, of contacts, supports and preloads, that differ."""
        found = [self._whole(), *self._contacts(), self._supports(), self._preloads()]
        shown = found if self.every else [group.only_what_differs() for group in found]
        return [group for group in shown if group.rows or group.settings]

    def notes(self) -> list[str]:
        """Return remarks to read before numbers are compared, a sentence each."""
        return list(_notes(self.runs))

    def headline(self, groups: Sequence[QuantityGroup]) -> str:
        """How much differs, in a sentence.

        Args:
            groups: That are shown.
        """
        rows = [(group, row) for group in groups for row in group.rows]
        differing = [(group, row) for group, row in rows if row.differs]
        if not differing:
            return "No quantity differs by more than round-off."
        beyond = [
            (found.count, f"{row.name} ({group.title})")
            for group, row in differing
            for found in row.differences
            if found is not None and found.is_beyond_bars and found.count is not None
        ]
        if beyond:
            most, name = max(beyond)
            farthest = f"by {most:.2g} error bars" if most < math.inf else "which has no error"
            names = len({name for _, name in beyond})
            return (
                f"{_counted(names)} by more than the sum of both error bars; most of all "
                f"{name}, {farthest}."
            )
        every = [found for _, row in differing for found in row.differences]
        apart = [found for found in every if found is None or found.is_there]
        unknown = [found is None or found.count is None for found in apart]
        if all(unknown):
            return f"{_counted(len(differing))}; by how many error bars is not known."
        where = "where bars are known" if any(unknown) else "all"
        return f"{_counted(len(differing))}, {where} by less than the sum of both error bars."

    def _shown(self, rows: list[list[str]]) -> list[list[str]]:
        return [row for row in rows if self.every or len(set(row[1:])) > 1]

    def _row(self, name: str, measured: str, estimates: list[Estimate | None]) -> QuantityRow:
        size = max(
            sizes_of(run.result.quantities, run.result.contacts)[measured] for run in self.runs
        )
        first, *others = estimates
        apart = [
            None if first is None or other is None else difference(first, other, size)
            for other in others
        ]
        unit = (units_of(self.runs) or NO_UNITS).of(measured)
        words = [NOT_THERE if found is None else found.words(size) for found in estimates]
        return QuantityRow(one_line(name), unit, words, apart)

    def _quantity_rows(
        self, places: Sequence[tuple[Quantities, Errors] | None], hidden: set[str]
    ) -> Iterator[QuantityRow]:
        """Yield the rows of the quantities of one contact, support or model in all runs."""
        there = [place for place in places if place is not None]
        for key in dict.fromkeys(key for quantities, _ in there for key in quantities):
            if key in hidden or not (self.every or has_true_value(key)):
                continue
            estimates = [
                None if place is None or key not in place[0] else _estimate(key, *place)
                for place in places
            ]
            yield self._row(key.replace("_", " "), measured_by(key), estimates)

    def _whole(self) -> QuantityGroup:
        several = any(len(run.result.contacts) > 1 for run in self.runs)
        hidden = self._hidden([run.result.contacts for run in self.runs])
        hidden |= set(table.resultants_of_contacts()) if several else set()
        places = [(run.result.quantities, run.result.errors) for run in self.runs]
        return QuantityGroup("whole model", list(self._quantity_rows(places, hidden)))

    def _hidden(self, contacts: Sequence[Sequence[ContactRecord]]) -> set[str]:
        """Quantities that say nothing about the contacts of any run, or nothing new."""
        idle = set.intersection(*(idle_quantities(one) for one in contacts))
        every = [one for found in contacts for one in found]
        return idle | (set() if self.every else secondary_quantities(every))

    def _contacts(self) -> Iterator[QuantityGroup]:
        """Contact by contact; of the only one quantities are those of the whole model."""
        several = any(len(run.result.contacts) > 1 for run in self.runs)
        for name in _names(self.runs, lambda run: [one.name for one in run.result.contacts]):
            found = [
                next((one for one in run.result.contacts if one.name == name), None)
                for run in self.runs
            ]
            rows: list[QuantityRow] = []
            if several:
                places = [None if one is None else (one.quantities, one.errors) for one in found]
                there = [[one] for one in found if one is not None]
                rows = list(self._quantity_rows(places, self._hidden(there)))
            yield QuantityGroup(f"contact '{one_line(name)}'", rows, self._settings(found))

    def _settings(self, contacts: Sequence[ContactRecord | None]) -> list[list[str]]:
        """Kind, law and parameters as used."""
        there = [one for one in contacts if one is not None]
        settings = {"kind": "contact", "friction law": "law", "slave": "slave"}
        rows = [
            [
                words,
                *(NOT_THERE if one is None else in_figures(getattr(one, key)) for one in contacts),
            ]
            for words, key in settings.items()
        ]
        units = units_of(self.runs) or NO_UNITS
        for key in dict.fromkeys(key for one in there for key in one.parameters):
            values = [
                NOT_THERE if one is None else in_figures(one.parameters.get(key))
                for one in contacts
            ]
            unit = units.of(measured_by_parameter(key))
            rows.append([f"{key.replace('_', ' ')}{f' ({unit})' if unit else ''}", *values])
        return [row for row in rows if not set(row[1:]) <= {"none", NOT_THERE}]

    def _supports(self) -> QuantityGroup:
        """Reactions of the supports of each name, and their moments."""
        rows = []
        for name in _names(self.runs, lambda run: run.result.reactions):
            found = [run.result.reactions.get(name) for run in self.runs]
            for key in OF_SUPPORTS:
                estimates = [
                    Estimate(one.quantities[key], one.errors.get(key))
                    if one is not None and key in one.quantities
                    else None
                    for one in found
                ]
                if any(estimate is not None for estimate in estimates):
                    words = f"{key.replace('_', ' ')} of '{name}'"
                    rows.append(self._row(words, measured_by(key), estimates))
        return QuantityGroup("supports", rows)

    def _preloads(self) -> QuantityGroup:
        rows = []
        for name in _names(self.runs, lambda run: run.result.preloads):
            found = [run.result.preloads.get(name) for run in self.runs]
            for quantity in OF_PRELOADS:
                estimates = [
                    None if one is None else Estimate(one[quantity], one.errors.get(quantity))
                    for one in found
                ]
                measured = MEASURED_BY_PRELOADS[quantity]
                rows.append(self._row(f"{quantity} of '{name}'", measured, estimates))
        return QuantityGroup("preloads", rows)


def _estimate(key: str, quantities: Quantities, errors: Errors) -> Estimate:
    value = quantities[key]
    reason = without_value(key) if value is None else ""
    return Estimate(value, errors.get(key), reason, key in errors or has_true_value(key))


def _names(runs: Sequence[ComparedRun], names_of: _NamesOf) -> list[str]:
    """Names of things of any run, once each."""
    return list(dict.fromkeys(name for run in runs for name in names_of(run)))


def _counted(number: int) -> str:
    return f"{number} quantit{'y differs' if number == 1 else 'ies differ'}"


def _short(value: float | None) -> str:
    return "not a number" if value is None else f"{value:.2e}"


def _notes(runs: Sequence[ComparedRun]) -> Iterator[str]:
    if len({run.result.model.kinematics for run in runs}) > 1:
        yield (
            "The runs differ in their kinematics: areas are lengths and forces are per thickness "
            "in plane models, and axes are radius and axis in axisymmetric ones."
        )
    if len({run.result.model.symmetry for run in runs}) > 1:
        yield "The runs differ in their planes of symmetry: each reports the part that it models."
    for run in runs:
        if not run.result.converged:
            yield f"'{run.name}' did not converge: its numbers are those of its last load step."
        elif not any(row["total"] is not None for row in run.result.errors.values()):
            yield f"'{run.name}' has no error bars."
    if is_made_in_python(runs):
        yield "What was made in Python is not in the files of a run, and may differ as well."
    units = units_of(runs)
    without = [run.name for run in runs if run.result.units is None]
    if units is not None and without:
        yield (
            f"{_quoted(without)} say no units: numbers are taken to be in "
            f"{units.of('length')} and {units.of('force')}, as those of the others."
        )
    for kind, names_of in _NAMED.items():
        for name in _names(runs, names_of):
            lacking = [run.name for run in runs if name not in names_of(run)]
            if lacking:
                having = [run.name for run in runs if name in names_of(run)]
                yield (
                    f"The {kind} '{one_line(name)}' is only in {_quoted(having)}, not in "
                    f"{_quoted(lacking)}."
                )


_NAMED: dict[str, _NamesOf] = {
    "contact": lambda run: [one.name for one in run.result.contacts],
    "support": lambda run: run.result.reactions,
    "preload": lambda run: run.result.preloads,
}


def _quoted(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
