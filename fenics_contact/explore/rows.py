"""The table of the page: an answer's quantities in words, with bars where these were estimated."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from fenics_contact.common.wording import one_line
from fenics_contact.quantities import table
from fenics_contact.quantities.names import REACTION
from fenics_contact.quantities.table import MEASURED_BY_PRELOADS, has_true_value, measured_by
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.quantities import idle_quantities
from fenics_contact.results.records.contacts import ContactRecord, PreloadRecord
from fenics_contact.results.records.record import NO_UNITS, Errors, Quantities, UnitsRecord
from fenics_contact.results.result import Result
from fenics_contact.results.words.rounding import rounded, sizes_of
from fenics_contact.scene.quantity_names import OF_PRELOADS
from fenics_contact.simulation.studies.quick_answers import Answer

# What a row says where bars are made when one lets go.
_LATER = ""


@dataclass(frozen=True)
class Numbers:
    """The numbers of an answer, whole or quick.

    Attributes:
        quantities: Of the whole model.
        contacts: Each contact, with its own.
        preloads: By name.
        reactions: Of the supports of each name, with errors; of a whole answer.
        errors: Of the whole model's quantities.
        has_bars: Whether errors were estimated as far as the scene asks for it.
    """

    quantities: Quantities
    contacts: Sequence[ContactRecord]
    preloads: Mapping[str, PreloadRecord]
    reactions: Mapping[str, Any] = field(default_factory=dict)
    errors: Errors = field(default_factory=dict)
    has_bars: bool = False

    @classmethod
    def of_answer(cls, answer: Answer, records: Sequence[ContactRecord]) -> Numbers:
        """Return the numbers of a quick answer.

        Args:
            answer: That converged.
            records: Of its contacts, without numbers.
        """
        contacts = [
            dataclasses.replace(record, quantities=found, errors={})
            for record, found in zip(records, answer.contacts, strict=True)
        ]
        return cls(answer.quantities, contacts, answer.preloads)

    @classmethod
    def of_result(cls, result: Result) -> Numbers:
        """Return the numbers of a whole answer."""
        return cls(
            result.quantities,
            result.contacts,
            result.preloads,
            result.reactions if len(result.reactions) > 1 else {},
            result.errors,
            has_bars=bool(result.errors),
        )


def rows_of(
    numbers: Numbers, points: ContactPoints | None, units: UnitsRecord | None
) -> list[list[str]]:
    """Name, value, bar and unit of each, those of a contact, support or preload with its name.

    Args:
        numbers: Of an answer.
        points: Its contact points.
        units: Of the scene, if any.
    """
    idle = idle_quantities(numbers.contacts)
    if points is not None and points.friction_traction.any():
        idle = {name for name in idle if not _needs_friction(name)}
    rows = _Rows(units or NO_UNITS, numbers, idle)
    found = list(rows.of("", numbers.quantities, numbers.errors))
    for contact in numbers.contacts if len(numbers.contacts) > 1 else ():
        found += rows.of(contact.name, contact.quantities, contact.errors)
    for name, reaction in numbers.reactions.items():
        found.append(
            rows.row(
                f"reaction of {one_line(name)}",
                "force",
                reaction.reaction,
                REACTION,
                reaction.errors,
            )
        )
    for name, preload in numbers.preloads.items():
        for key in OF_PRELOADS:
            words = f"{key} of {one_line(name)}"
            found.append(
                rows.row(words, MEASURED_BY_PRELOADS[key], preload[key], key, preload.errors)
            )
    return found


def _needs_friction(name: str) -> bool:
    row = table.find(name)
    return row is not None and row.needs == "friction"


class _Rows:
    """Makes the rows of an answer."""

    def __init__(self, units: UnitsRecord, numbers: Numbers, idle: set[str]) -> None:
        self._units, self._numbers, self._idle = units, numbers, idle
        self._sizes = sizes_of(numbers.quantities, numbers.contacts)
        self._order = {one.name: place for place, one in enumerate(table.every())}

    def of(self, owner: str, quantities: Quantities, errors: Errors) -> Iterator[list[str]]:
        """Yield the rows of the whole model, or of a contact among several."""
        several = len(self._numbers.contacts) > 1
        last = len(self._order)
        for name in sorted(quantities, key=lambda name: self._order.get(name, last)):
            value = quantities[name]
            if value is None or name in self._idle or not has_true_value(name):
                continue
            if not owner and several and name in table.resultants_of_contacts():
                continue
            words = name.replace("_", " ") + (f" of {one_line(owner)}" if owner else "")
            yield self.row(words, measured_by(name), value, name, errors)

    def row(self, words: str, measured: str, value: Any, name: str, errors: Errors) -> list[str]:
        """One of them."""
        shown, bar = rounded(value, errors.get(name), self._sizes[measured])
        if not self._numbers.has_bars:
            bar = _LATER
        return [words, shown, f"± {bar}" if bar not in ("", "?") else bar, self._units.of(measured)]
