"""A result at a glance: its verdict and main quantities, as text and for notebooks."""

from __future__ import annotations

from html import escape

from fenics_contact.common.plain_text import one_line
from fenics_contact.results.quantities import FORCES, idle_quantities, without_value
from fenics_contact.results.records.record import Errors, Quantities
from fenics_contact.results.result import Result
from fenics_contact.results.words.rounding import rounded, size_of_forces
from fenics_contact.scene.quantity_names import OF_ONE_CONTACT, OF_PRELOADS

_MAIN = (
    *("normal_force", "friction_force", "reaction", "indentation", "max_contact_pressure"),
    *("contact_area", "slip_area"),
)
_MOST = 20  # rows, of a scene of many contacts


def quantity_rows(result: Result, key: str) -> list[tuple[str, str, str]]:
    """Name, value and error bar of a quantity, in words.

    Of a resultant, those of each contact where there are several.

    Args:
        result: Of a run.
        key: The quantity's.
    """
    words = key.replace("_", " ")
    places: list[tuple[str, Quantities, Errors]] = [(words, result.quantities, result.errors)]
    if key in OF_ONE_CONTACT and len(result.contacts) > 1:
        places = [(f"{words} of {one.name}", one.quantities, one.errors) for one in result.contacts]
    size = size_of_forces(result.quantities, result.contacts) if key in FORCES else 0.0
    rows = []
    for name, found, errors in places:
        words, bar = without_value(key, found), ""
        value = found[key]
        if value is not None:
            words, bar = rounded(value, errors.get(key), size)
        rows.append((one_line(name), words, bar))
    return rows


def preload_rows(result: Result) -> list[tuple[str, str, str]]:
    """Name, value and error bar of force and elongation of every preload, in words."""
    rows = []
    for name, preload in result.preloads.items():
        how = ", locked" if preload.locked else ""
        for quantity, words in zip(OF_PRELOADS, ("force", "elongation"), strict=True):
            said = rounded(preload[quantity], preload.errors.get(quantity))
            rows.append((one_line(f"{words} of {name}{how}"), *said))
    return rows


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
    for name, value, bar in _main_rows(result):
        lines.append(f"{name}: {value}{f' ± {bar}' if bar else ''}")
    return "\n".join(lines)


def as_html(result: Result) -> str:
    """The same in HTML; all text is escaped.

    Args:
        result: Of a run.
    """
    rows = [
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td>'
        f"<td>{escape(bar)}</td></tr>"
        for name, value, bar in _main_rows(result)
    ]
    head = '<tr><th scope="col">quantity</th><th scope="col">value</th><th scope="col">±</th></tr>'
    table = f"<table><thead>{head}</thead><tbody>{''.join(rows)}</tbody></table>" if rows else ""
    title, verdict = escape(_title(result)), escape(one_line(result.verdict))
    return f"<div><p><strong>{title}</strong></p><p>{verdict}</p>{table}</div>"


def _title(result: Result) -> str:
    return one_line(result.title or "without a title")


def _main_rows(result: Result) -> list[tuple[str, str, str]]:
    """None of a run that did not converge: its numbers are of no answer."""
    hidden = idle_quantities(result.contacts)
    keys = [key for key in _MAIN if key in result.quantities and key not in hidden]
    rows = [row for key in keys for row in quantity_rows(result, key)] + preload_rows(result)
    rows = rows if result.converged else []
    left_out = f"{len(rows) - _MOST} more"
    return rows if len(rows) <= _MOST else [*rows[:_MOST], (left_out, "", "")]
