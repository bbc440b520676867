"""Derivatives of a result as rows of a table."""

from __future__ import annotations

from fenics_contact.results.records.derivatives import Derivative
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.words.rounding import UNKNOWN, rounded

_HEAD = ["derivative of", "in", "value", "±", "of the discrete answer", ""]


def derivative_rows(result: Outcome) -> list[list[str]]:
    """A table of all derivatives, its head first; empty where none were asked for.

    Args:
        result: The result.
    """
    rows = [
        [name, key, *_mean(found), _discrete(found), "one-sided" if found.one_sided else ""]
        for name, by_key in result.derivatives.items()
        for key, found in by_key.items()
    ]
    return [_HEAD, *rows] if rows else []


def _mean(found: Derivative) -> tuple[str, str]:
    """Value and spread in as many figures as are sure."""
    if found.value is None:
        return UNKNOWN, UNKNOWN
    return rounded(found.value, {"total": found.spread})


def _discrete(found: Derivative) -> str:
    return UNKNOWN if found.discrete is None else f"{found.discrete:.6g}"
