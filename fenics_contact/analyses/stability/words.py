"""Modes of bodies that slide steadily: rows of a table, a sentence, and the file of them."""

from __future__ import annotations

from fenics_contact.analyses.stability.record import StabilityRecord
from fenics_contact.results.records.record import NO_UNITS, UnitsRecord
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.result import Result
from fenics_contact.results.tables import AnalysisWords, Rows, headed
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import UnitNames

# What they measure.
_RATE, _FREQUENCY = "1/time", "cycles/time"


def stability_rows(result: Outcome) -> list[list[str]]:
    """A table of all modes, its head first; empty where none were asked for."""
    if result.stability is None:
        return []
    units = result.units
    head = [
        "mode",
        headed("frequency", _FREQUENCY, units),
        headed("growth rate", _RATE, units),
        "damping ratio",
        "",
    ]
    rows = [
        [
            str(mode.number),
            f"{mode.frequency:.6g}",
            f"{mode.growth_rate if mode.damping_ratio else 0.0:.4g}",
            f"{mode.damping_ratio:.3g}",
            "grows" if mode.grows else "",
        ]
        for mode in result.stability.modes
    ]
    return [head, *rows]


def stability_words(found: StabilityRecord, units: UnitsRecord | None) -> str:
    """Return the result in one or two sentences.

    Args:
        found: Of a result.
        units: Of the run, if any.
    """
    names = units or NO_UNITS
    rate, frequency = (f" {names.of(what)}".rstrip() for what in (_RATE, _FREQUENCY))
    growing = [mode for mode in found.modes if mode.grows]
    said = f"Steady sliding at a friction coefficient of {found.friction_coefficient:g} "
    if growing:
        worst = max(growing, key=lambda mode: mode.growth_rate)
        verb = "grows" if len(growing) == 1 else "grow"
        kind = "flutters" if worst.frequency > 0 else "diverges"
        said += (
            f"{kind}: of {len(found.modes)} modes {len(growing)} {verb}, most of all number "
            f"{worst.number}, at a rate of {worst.growth_rate:.3g}{rate} and a frequency of "
            f"{worst.frequency:.4g}{frequency}."
        )
    else:
        said += f"lasts, as far as {len(found.modes)} modes tell: none of them grows."
    if found.critical_coefficient is not None:
        said += f" The critical friction coefficient is {found.critical_coefficient:.4g}."
    elif found.curve:
        most = found.curve[-1].friction_coefficient
        said += f" Up to a coefficient of {most:g} none of them grows."
    return said


class _StabilityWords(AnalysisWords):
    def plan(self, scene: Scene, units: UnitNames | None) -> list[str]:
        asked = scene.stability
        if asked is None:
            return []
        over = "" if asked.up_to is None else f", followed to a coefficient of {asked.up_to:g}"
        return [f"Steady sliding: {asked.number} complex modes about the last state{over}"]

    def tables(self, result: Outcome) -> list[Rows]:
        return [stability_rows(result)]

    def files(self, result: Result) -> dict[str, Rows]:
        found = result.stability
        return {"stability.csv": curve_rows(found)} if found is not None and found.curve else {}


WORDS = _StabilityWords()


def curve_rows(found: StabilityRecord) -> list[list[str]]:
    """The rows of ``stability.csv``, its header first: one a coefficient and mode."""
    rows = [["friction_coefficient", "mode", "frequency", "growth_rate"]]
    for point in found.curve:
        pairs = zip(point.frequencies, point.growth_rates, strict=True)
        for number, (frequency, rate) in enumerate(pairs, start=1):
            values = (point.friction_coefficient, frequency, rate)
            coefficient, *numbers = (repr(float(value)) for value in values)
            rows.append([coefficient, str(number), *numbers])
    return rows
