"""Quantities of a run by its contacts and supports: sums by name, and those that matter most."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any, NamedTuple

from fenics_contact.common.wording import one_line
from fenics_contact.quantities import table
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    FRICTION_FORCE,
    FRICTION_WORK,
    INDENTATION,
    MAX_CONTACT_PRESSURE,
    MAX_SLIP,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
    REACTION,
    SLIP_AREA,
    SLIP_SHARE,
)
from fenics_contact.quantities.table import MEASURED_BY_PRELOADS, QuantityValue, measured_by
from fenics_contact.results.records.contacts import ContactRecord, PreloadRecord, SupportRecord
from fenics_contact.results.records.record import NO_UNITS, Errors, Quantities, UnitsRecord
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.rounding import is_none, rounded, sizes_of
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.law_tables import NormalLawTable
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.quantity_names import OF_PRELOADS, OfScalar
from fenics_contact.scene.reference import measured_by as measured_by_key


def measured_by_parameter(name: str) -> str:
    """Return the dimension of a contact's parameter, that of the scene's key of its name."""
    return measured_by_key(name, Contact, Obstacle, *NormalLawTable.__subclasses__())


def idle_quantities(contacts: Sequence[ContactRecord]) -> set[str]:
    """Names of the quantities that say nothing about some contacts, and are not shown."""
    if not contacts:
        return {one.name for one in table.every() if one.together is not None}
    missing = set()
    if all(not contact.carries_shear for contact in contacts):
        missing.add("friction")
    if all(contact.pressure_is_given for contact in contacts):
        missing.add("contact found")
    return {one.name for one in table.every() if one.needs in missing}


def secondary_quantities(contacts: Sequence[ContactRecord]) -> set[str]:
    """Names of the quantities that others say as well, and that are not shown.

    One that stands for a quantity which some contact has not is shown.
    """
    found = {one.name for one in table.every() if one.is_secondary}
    for one in table.every():
        if any(contact.quantities.get(one.name) is None for contact in contacts):
            found.discard(one.instead)
    return found


def without_value(name: str) -> str:
    """Why a quantity of a contact has no value, in words.

    Args:
        name: Of the quantity.
    """
    row = table.find(name)
    return "none" if row is None else row.no_value


def scalars_of_step(step: Mapping[str, Any]) -> Mapping[str, Mapping[str, Any]]:
    """Records of the scalar unknowns that a load step's results name, by these names."""
    return dict(step.get("preloads", {}))


def quantities_of_scalars(records: Mapping[str, Mapping[str, Any]]) -> dict[Hashable, float]:
    """The quantities of records of scalar unknowns that have error bars, by ``OfScalar`` keys."""
    return {
        OfScalar(name, quantity): record[quantity]
        for name, record in records.items()
        for quantity in OF_PRELOADS
    }


def reactions_by_name(supports: Sequence[SupportRecord]) -> dict[str, dict[str, Any]]:
    """Quantities of the supports of each name together: resultant and moment add up."""
    found: dict[str, dict[str, Any]] = {}
    for support in supports:
        before = found.setdefault(support.name, {})
        for name, value in support.quantities.items():
            before[name] = _sum(before[name], value) if name in before else value
    return found


def _sum(one: QuantityValue, other: QuantityValue) -> QuantityValue:
    """Add two numbers, or two vectors by component."""
    if isinstance(one, Sequence) and isinstance(other, Sequence):
        return [a + b for a, b in zip(one, other, strict=True)]
    assert not isinstance(one, Sequence) and not isinstance(other, Sequence)
    return one + other


# Of what friction can hold: what it does not hold.
_NO_SHARE = 1e-9


def headlines(result: Outcome) -> list[str]:
    """A line a preload and a contact, and what friction dissipated; none without an answer.

    Args:
        result: Of a run.
    """
    if not result.converged:
        return []
    words = _Words(result.units or NO_UNITS, sizes_of(result.quantities, result.contacts))
    lines = [words.of_preload(name, preload) for name, preload in result.preloads.items()]
    lines += [words.of_contact(contact) for contact in result.contacts if contact.quantities]
    lines += _parts(result)
    if result.contacts and FRICTION_WORK not in idle_quantities(result.contacts):
        lines.append(f"Friction dissipated {words.estimate(FRICTION_WORK, result)}.")
    return lines


@dataclass(frozen=True)
class _Words:
    """Words for a run's values.

    Attributes:
        units: Its own; without names where it has none.
        sizes: Of its forces, pressures and so on.
    """

    units: UnitsRecord
    sizes: Mapping[str, float]

    def of_preload(self, name: str, preload: PreloadRecord) -> str:
        """Return the force of a preload, and whether its length is locked."""
        force = self._with_bar(preload.force, preload.errors, "force", "force")
        locked = ", its length locked" if preload.locked else ""
        return f"Preload '{one_line(name)}': force {force}{locked}."

    def of_contact(self, contact: ContactRecord) -> str:
        """Return the force, largest pressure and slip of a contact."""
        found, idle = contact.quantities, idle_quantities([contact])
        pressing = NORMAL_FORCE if found.get(NORMAL_FORCE) is not None else PRESSURE_INTEGRAL
        words = []
        if found.get(pressing) is not None:
            words.append(f"presses with {self.estimate(pressing, contact)}")
        friction = found.get(FRICTION_FORCE)
        if isinstance(friction, list) and FRICTION_FORCE not in idle:
            force = math.hypot(*friction)
            said = self._with_bar(force, contact.errors, FRICTION_FORCE, "force")
            share = _share(contact)
            if not is_none(force, self.sizes["force"]):
                words.append(f"friction {said}" + (f" ({share} of its limit)" if share else ""))
            elif share not in (
                "",
                "0 %",
                "-",
            ):  # around an axis forces cancel, and their moments do not
                words.append(f"friction at {share} of its limit")
        for key, said in (
            (MAX_CONTACT_PRESSURE, "peak pressure"),
            (MAX_SLIP, "slips by up to"),
        ):
            if found.get(key) is None or key in idle:
                continue
            if not is_none(found[key], self.sizes[measured_by(key)]):
                words.append(f"{said} {self.estimate(key, contact)}")
        return f"Contact '{one_line(contact.name)}': {', '.join(words)}."

    def estimate(self, key: str, found: ContactRecord | Outcome) -> str:
        """A quantity with its bar."""
        value = found.quantities[key]
        assert value is not None
        return self._with_bar(value, found.errors, key, measured_by(key))

    def _with_bar(self, value: QuantityValue, errors: Errors, key: str, measured: str) -> str:
        """Without a bar where the run estimated none at all, and where none is needed."""
        said, bar = rounded(value, errors.get(key), self.sizes[measured])
        unit = self.units.of(measured)
        return f"{said}{f' ± {bar}' if errors and bar else ''}{f' {unit}' if unit else ''}"


def _share(contact: ContactRecord) -> str:
    """How much of what friction can hold it does; empty of files before that was written."""
    if SLIP_SHARE not in contact.quantities:
        return ""
    share = contact.quantities[SLIP_SHARE]
    return "-" if share is None else _percent(share)


def _percent(share: float) -> str:
    """A share of a limit; what is round-off is none."""
    return f"{100 * share:.3g} %" if share > _NO_SHARE else "0 %"


def _parts(result: Outcome) -> list[str]:
    """How much of what friction can hold of it each part uses, all its contacts together."""
    limit = result.slip_limit
    if limit is None:
        return []
    said = [
        f"Part '{one_line(name)}': friction holds it with {_percent(share)} of its limit."
        for name, share in limit.parts.items()
        if share is not None
    ]
    if limit.factor is not None and limit.kind == "upper bound":
        said.append(
            f"At {limit.factor:.4g} times the loads that vary a part slips or tips at the latest "
            f"({limit.motion}), whatever the pressures become (upper bound)."
        )
    elif limit.factor is not None:
        said.append(
            f"At {limit.factor:.4g} times the loads that vary a part slips as a whole "
            f"({limit.kind})."
        )
    return said


_MAIN = (
    *(NORMAL_FORCE, FRICTION_FORCE, REACTION, INDENTATION, MAX_CONTACT_PRESSURE),
    *(CONTACT_AREA, SLIP_AREA),
)
_MOST = 20  # rows, of a scene of many contacts


class Shown(NamedTuple):
    """A quantity in words.

    Attributes:
        name: Of it, and of what has it.
        value: In as many figures as its bar leaves sure.
        bar: Empty where it needs none.
        unit: Empty where the run has no units.
    """

    name: str
    value: str
    bar: str
    unit: str

    def __str__(self) -> str:
        bar, unit = f" ± {self.bar}" if self.bar else "", f" {self.unit}" if self.unit else ""
        return f"{self.name}: {self.value}{bar}{unit}"


def quantity_rows(result: Outcome, key: str) -> list[Shown]:
    """A quantity in words; of a resultant, those of each contact where there are several.

    Args:
        result: Of a run.
        key: The quantity's.
    """
    words = key.replace("_", " ")
    places: list[tuple[str, Quantities, Errors]] = [(words, result.quantities, result.errors)]
    if key in table.resultants_of_contacts() and len(result.contacts) > 1:
        places = [(f"{words} of {one.name}", one.quantities, one.errors) for one in result.contacts]
    size = sizes_of(result.quantities, result.contacts)[measured_by(key)]
    unit = (result.units or NO_UNITS).of(measured_by(key))
    rows = []
    for name, found, errors in places:
        value = found[key]
        if value is None:
            rows.append(Shown(one_line(name), without_value(key), "", ""))
        else:
            rows.append(Shown(one_line(name), *rounded(value, errors.get(key), size), unit))
    return rows


def preload_rows(result: Outcome) -> list[Shown]:
    """Force and elongation of every preload, in words."""
    units, rows = result.units or NO_UNITS, []
    for name, preload in result.preloads.items():
        how = ", locked" if preload.locked else ""
        for quantity, words in zip(OF_PRELOADS, ("force", "elongation"), strict=True):
            said = rounded(preload[quantity], preload.errors.get(quantity))
            unit = units.of(MEASURED_BY_PRELOADS[quantity])
            rows.append(Shown(one_line(f"{words} of {name}{how}"), *said, unit))
    return rows


#: What couplings have in results, with what each measures.
MEASURED_BY_COUPLINGS = {
    "displacement": "length",
    "rotation": "angle",
    "force": "force",
    "moment": "force·length",
}


def coupling_rows(result: Outcome) -> list[Shown]:
    """Motion of every coupling, and the force and moment on it, in words."""
    units, rows = result.units or NO_UNITS, []
    for one in result.couplings:
        for quantity, measured in MEASURED_BY_COUPLINGS.items():
            value = one[quantity]
            if not value:  # an axisymmetric model has no rotation
                continue
            said = rounded(value, one.errors.get(quantity))
            unit = units.of(measured) if measured != "angle" else "rad" if result.units else ""
            rows.append(Shown(one_line(f"{quantity} of {one.name}"), *said, unit))
    return rows


def reaction_rows(result: Outcome) -> list[Shown]:
    """Reactions of the supports of each name, in words."""
    size = sizes_of(result.quantities, result.contacts)["force"]
    unit = (result.units or NO_UNITS).of("force")
    return [
        Shown(one_line(name), *rounded(of.reaction, of.errors.get(REACTION), size), unit)
        for name, of in result.reactions.items()
    ]


def in_figures(value: object) -> str:
    """A number, the components of a vector, or a word."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return ", ".join(in_figures(entry) for entry in value)
    return "none" if value is None else str(value)


def as_text(result: Outcome) -> str:
    """A line each for title, verdict and main quantities.

    Args:
        result: Of a run.
    """
    lines = [f"Result: {_title(result)}", one_line(result.verdict)]
    return "\n".join([*lines, *map(str, _main_rows(result))])


def as_html(result: Outcome) -> str:
    """Return the short form of a result in HTML; all text is escaped.

    Args:
        result: Of a run.
    """
    names = ("quantity", "value", "±", *(("unit",) if result.units else ()))
    rows = [
        f'<tr><th scope="row">{escape(row.name)}</th>'
        + "".join(f"<td>{escape(cell)}</td>" for cell in row[1 : len(names)])
        + "</tr>"
        for row in _main_rows(result)
    ]
    head = "".join(f'<th scope="col">{name}</th>' for name in names)
    table = (
        f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"
        if rows
        else ""
    )
    title, verdict = escape(_title(result)), escape(one_line(result.verdict))
    return f"<div><p><strong>{title}</strong></p><p>{verdict}</p>{table}</div>"


def _title(result: Outcome) -> str:
    return one_line(result.title or "without a title")


def _main_rows(result: Outcome) -> list[Shown]:
    """None of a run that did not converge: its numbers are of no answer."""
    hidden = idle_quantities(result.contacts)
    keys = [key for key in _MAIN if key in result.quantities and key not in hidden]
    rows = [row for key in keys for row in quantity_rows(result, key)]
    rows += preload_rows(result) + coupling_rows(result)
    rows = rows if result.converged else []
    left_out = f"{len(rows) - _MOST} more"
    return rows if len(rows) <= _MOST else [*rows[:_MOST], Shown(left_out, "", "", "")]
