"""Modes, and what joints damp of them, as rows of tables on terminals and in a file."""

from __future__ import annotations

from collections.abc import Sequence

from fenics_contact.analyses.vibration.record import DampingRecord
from fenics_contact.analyses.vibration.table import Damping
from fenics_contact.results.records.record import Errors
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.result import Result
from fenics_contact.results.rounding import bar_in_words
from fenics_contact.results.tables import AnalysisWords, Rows, headed
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import UnitNames


def _bar(errors: Errors, name: str) -> str:
    """Return the error bar of a quantity, ``?`` where it was not estimated."""
    return bar_in_words(errors.get(name, {}).get("total"))


def mode_rows(result: Outcome) -> list[list[str]]:
    """A table of all modes, its head first; empty where none were asked for."""
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
    """A table of all amplitudes of all modes that were driven, its head first, or nothing."""
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


class _VibrationWords(AnalysisWords):
    def plan(self, scene: Scene, units: UnitNames | None) -> list[str]:
        lines = []
        if scene.modes is not None:
            number = scene.modes.number
            lines.append(f"Modes: the {number} lowest about the last state, contacts stuck")
        if scene.damping is not None:
            lines.append(_damping_plan(scene.damping, units))
        return lines

    def tables(self, result: Outcome) -> list[Rows]:
        return [mode_rows(result), damping_rows(result)]

    def files(self, result: Result) -> dict[str, Rows]:
        return {"damping.csv": damping_file(result.damping)} if result.damping else {}


def _damping_plan(driven: Damping, units: UnitNames | None) -> str:
    """Return a line on the modes that are driven, and how far."""
    which = "mode" if len(driven.modes) == 1 else "modes"
    length = "" if units is None else f" {units.length}"
    return (
        f"Damping: {which} {', '.join(map(str, driven.modes))} driven to "
        f"{len(driven.amplitudes)} amplitudes, from {driven.amplitudes[0]:g} to "
        f"{driven.amplitudes[-1]:g}{length}, {driven.increments} load steps a cycle"
    )


WORDS = _VibrationWords()


def damping_file(found: Sequence[DampingRecord]) -> list[list[str]]:
    """The rows of ``damping.csv``, its header first: one a mode and amplitude.

    Bars stand in ``…_error``, which is empty where they were not estimated.

    Args:
        found: At least one.
    """
    names = [name for name in found[0] if name not in ("by", "contacts", "errors")]
    contacts, keys = list(found[0].contacts), list(found[0].by)
    bars = ("natural_frequency", "damping_ratio", "loss")
    rows = [
        [
            *(*keys, *names),
            *(f"{contact}.loss" for contact in contacts),
            *(f"{name}_error" for name in bars),
        ]
    ]
    for one in found:
        values = [one.by[key] for key in keys] + [one[name] for name in names]
        values += [one.contacts[name] for name in contacts]
        known = [one.errors.get(name, {}).get("total") for name in bars]
        values += ["" if error is None else error for error in known]
        rows.append([value if isinstance(value, str) else repr(value) for value in values])
    return rows
