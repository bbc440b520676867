"""Modes of bodies that slide steadily, as rows of a table and in a sentence."""

from __future__ import annotations

from fenics_contact.results.records.run import Outcome
from fenics_contact.results.records.stability import StabilityRecord
from fenics_contact.results.words.tables import headed


def stability_rows(result: Outcome) -> list[list[str]]:
    """A table of all modes, its head first; empty where none were asked for.

    Args:
        result: The result.
    """
    if result.stability is None:
        return []
    units = result.units
    head = [
        "mode",
        headed("frequency", "cycles/time", units),
        headed("growth rate", "1/time", units),
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


def stability_words(found: StabilityRecord) -> str:
    """What came out, in one or two sentences, without units.

    Args:
        found: Of a result.
    """
    growing = [mode for mode in found.modes if mode.grows]
    said = f"Steady sliding at a friction coefficient of {found.friction_coefficient:g} "
    if growing:
        worst = max(growing, key=lambda mode: mode.growth_rate)
        verb = "grows" if len(growing) == 1 else "grow"
        kind = "flutters" if worst.frequency > 0 else "diverges"
        said += (
            f"{kind}: of {len(found.modes)} modes {len(growing)} {verb}, most of all number "
            f"{worst.number}, at a rate of {worst.growth_rate:.3g} and a frequency of "
            f"{worst.frequency:.4g}."
        )
    else:
        said += f"lasts, as far as {len(found.modes)} modes tell: none of them grows."
    if found.critical_coefficient is not None:
        said += f" The critical friction coefficient is {found.critical_coefficient:.4g}."
    elif found.curve:
        most = found.curve[-1].friction_coefficient
        said += f" Up to a coefficient of {most:g} none of them grows."
    return said
