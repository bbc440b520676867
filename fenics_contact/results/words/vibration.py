"""Modes, and what joints damp of them, as rows of tables."""

from __future__ import annotations

from fenics_contact.results.records.record import Errors
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.words.rounding import bar_in_words
from fenics_contact.results.words.tables import headed


def _bar(errors: Errors, name: str) -> str:
    """Of a quantity, ``?`` where it was not estimated."""
    return bar_in_words(errors.get(name, {}).get("total"))


def mode_rows(result: Outcome) -> list[list[str]]:
    """A table of all modes, its head first; empty where none were asked for.

    Args:
        result: The result.
    """
    frequency = headed("natural frequency", "cycles/time", result.units)
    head = ["mode", frequency, "±", headed("modal mass", "mass", result.units)]
    rows = [
        [
            str(mode.number),
            f"{mode.natural_frequency:.6g}",
            _bar(mode.errors, "natural_frequency"),
            f"{mode.modal_mass:.4g}",
        ]
        for mode in result.modes
    ]
    return [head, *rows] if rows else []


def damping_rows(result: Outcome) -> list[list[str]]:
    """A table of all amplitudes of all modes that were driven, its head first, or nothing.

    Args:
        result: The result.
    """
    if not result.damping:
        return []
    units = result.units
    contacts = list(result.damping[0].contacts)
    several = contacts if len(contacts) > 1 else []
    keys = list(result.damping[0].by)
    head = [
        *keys,
        "mode",
        headed("amplitude", "length", units),
        headed("natural frequency", "cycles/time", units),
        "±",
        "damping ratio",
        "±",
        headed("loss of a cycle", "energy", units),
        "±",
        *(headed(f"at '{name}'", "energy", units) for name in several),
        "",
    ]
    rows = [
        [
            *(f"{one.by[key]:g}" for key in keys),
            str(one.mode),
            f"{one.amplitude:.4g}",
            f"{one.natural_frequency:.6g}",
            _bar(one.errors, "natural_frequency"),
            f"{one.damping_ratio:.4g}",
            _bar(one.errors, "damping_ratio"),
            f"{one.loss:.4g}",
            _bar(one.errors, "loss"),
            *(f"{one.contacts[name]:.4g}" for name in several),
            one.kind or "not closed",
        ]
        for one in result.damping
    ]
    return [head, *rows]
