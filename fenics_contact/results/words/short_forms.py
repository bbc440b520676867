"""A result at a glance: its verdict and main quantities, as text and for notebooks."""

from __future__ import annotations

from html import escape
from typing import NamedTuple

from fenics_contact.common.plain_text import one_line
from fenics_contact.quantities import table
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    FRICTION_FORCE,
    INDENTATION,
    MAX_CONTACT_PRESSURE,
    NORMAL_FORCE,
    REACTION,
    SLIP_AREA,
)
from fenics_contact.quantities.table import MEASURED_BY_PRELOADS, measured_by
from fenics_contact.results.quantities import idle_quantities, without_value
from fenics_contact.results.records.record import Errors, Quantities
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.records.units import NO_UNITS
from fenics_contact.results.result import Result
from fenics_contact.results.words.rounding import rounded, sizes_of
from fenics_contact.scene.quantity_names import OF_PRELOADS

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


def quantity_rows(result: Result, key: str) -> list[Shown]:
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


def preload_rows(result: Result) -> list[Shown]:
    """Force and elongation of every preload, in words."""
    units, rows = result.units or NO_UNITS, []
    for name, preload in result.preloads.items():
        how = ", locked" if preload.locked else ""
        for quantity, words in zip(OF_PRELOADS, ("force", "elongation"), strict=True):
            said = rounded(preload[quantity], preload.errors.get(quantity))
            unit = units.of(MEASURED_BY_PRELOADS[quantity])
            rows.append(Shown(one_line(f"{words} of {name}{how}"), *said, unit))
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


def as_text(result: Result) -> str:
    """A line each for title, verdict and main quantities.

    Args:
        result: Of a run.
    """
    lines = [f"Result: {_title(result)}", one_line(result.verdict)]
    return "\n".join([*lines, *map(str, _main_rows(result))])


def as_html(result: Result) -> str:
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


def _title(result: Result) -> str:
    return one_line(result.title or "without a title")


def _main_rows(result: Result) -> list[Shown]:
    """None of a run that did not converge: its numbers are of no answer."""
    hidden = idle_quantities(result.contacts)
    keys = [key for key in _MAIN if key in result.quantities and key not in hidden]
    rows = [row for key in keys for row in quantity_rows(result, key)] + preload_rows(result)
    rows = rows if result.converged else []
    left_out = f"{len(rows) - _MOST} more"
    return rows if len(rows) <= _MOST else [*rows[:_MOST], Shown(left_out, "", "", "")]
