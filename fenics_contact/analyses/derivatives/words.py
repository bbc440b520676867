"""Derivatives of a result, and what tolerances make of it, as rows of tables."""

from __future__ import annotations

from fenics_contact.analyses.derivatives.record import Derivative, Uncertainty
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.rounding import UNKNOWN, bar_in_words, rounded
from fenics_contact.results.tables import AnalysisWords, Rows

_HEAD = ["derivative of, by", "value", "±", "discrete"]


def derivative_rows(result: Outcome) -> list[list[str]]:
    """A table of all derivatives, its head first; empty where none were asked for.

    Each quantity has a row, and below it one for each number that it is derived by: both names
    beside each other would be wider than a terminal.
    """
    rows = [_HEAD]
    for name, by_key in result.derivatives.items():
        rows.append([name.replace("_", " "), "", "", ""])
        rows += [[f"  {key}", *_mean(found), _discrete(found)] for key, found in by_key.items()]
    return rows if len(rows) > 1 else []


def notes_on_derivatives(result: Outcome) -> list[str]:
    """Return remarks on the derivatives, in sentences."""
    found = [
        key
        for by_key in result.derivatives.values()
        for key, one in by_key.items()
        if one.of_single_answers
    ]
    if not found:
        return []
    keys = ", ".join(dict.fromkeys(found))
    return [
        f"Cells are too large for means by {keys}: a change of the number by a quarter moves no "
        "edge of contact or of stick by a cell, so the values are those of single answers, which "
        "may jump from cell to cell. A finer mesh gives means."
    ]


def _mean(found: Derivative) -> tuple[str, str]:
    """Value and spread in as many figures as are sure."""
    if found.value is None:
        return UNKNOWN, UNKNOWN
    return rounded(found.value, {"total": found.spread})


def _discrete(found: Derivative) -> str:
    if found.discrete is None:
        return UNKNOWN
    return f"{found.discrete:.6g}" + (" one-sided" if found.one_sided else "")


def uncertainty_rows(result: Outcome) -> list[list[str]]:
    """A table of what tolerances and the mesh make of each quantity; empty without tolerances."""
    rows = [
        [
            name,
            *map(bar_in_words, (found.data, found.data_at_most, found.numerical)),
            UNKNOWN if found.larger is None else f"the {found.larger}",
            _largest(found),
        ]
        for name, found in result.uncertainty.items()
    ]
    head = ["± of", "by tolerances", "at most", "error bar", "larger", "most of the data by"]
    return [head, *rows] if rows else []


def _largest(found: Uncertainty) -> str:
    """The key whose tolerance makes most of a quantity."""
    parts = {key: part for key, part in found.by.items() if part}
    return max(parts, key=lambda key: parts[key]) if parts else ""


class _DerivativeWords(AnalysisWords):
    def tables(self, result: Outcome) -> list[Rows]:
        return [derivative_rows(result), uncertainty_rows(result)]

    def notes(self, result: Outcome) -> list[str]:
        return notes_on_derivatives(result)


WORDS = _DerivativeWords()
