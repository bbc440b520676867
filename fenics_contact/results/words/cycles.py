"""Cycles of loads in words."""

from __future__ import annotations

from fenics_contact.results.records.cycles import CyclesRecord
from fenics_contact.results.records.units import UnitsRecord
from fenics_contact.results.words.rounding import UNKNOWN, bar_in_words
from fenics_contact.results.words.tables import headed

# What becomes of loads that come again, as it is said of a cycle from which on it is so.
_KINDS = {
    "shakedown": "shakedown: friction loses nothing any more",
    "steady loop": "a steady loop: every further cycle loses {loss:.4g}",
    "ratchetting": (
        "ratchetting: every further cycle loses {loss:.4g}, and slip grows by {advance:.3g} in each"
    ),
}


def cycle_words(cycles: CyclesRecord | None) -> str:
    """A sentence on what becomes of cycles of loads, or nothing."""
    if cycles is None:
        return ""
    last = cycles.each[-1]
    if not last.is_closed:
        still = "" if last.change is None else f"; tractions still change by {last.change:.2g}"
        if last.is_kept_changing:
            still += ", and so does what is kept at the contact points, such as wear"
        many = "cycle" if cycles.computed == 1 else "cycles"
        return f" The loop is not closed after {cycles.computed} {many}{still}."
    words = _KINDS[last.kind].format(loss=last.loss, advance=last.advance)
    return f" The loop closed in cycle {cycles.closed_in} of {cycles.number}, {words}."


def cycle_rows(cycles: CyclesRecord | None, units: UnitsRecord | None = None) -> list[list[str]]:
    """A table of all cycles that were computed, its head first; empty where there are none.

    Args:
        cycles: Of the run.
        units: Of their numbers, if any.
    """
    if cycles is None:
        return []
    several = list(cycles.each[0].contacts) if len(cycles.each[0].contacts) > 1 else []
    rows = [
        [
            "cycle",
            headed("loss", "energy", units),
            "±",
            *(headed(f"at '{name}'", "energy", units) for name in several),
            headed("work", "energy", units),
            "change of tractions",
            headed("slip grows by", "length", units),
            "",
        ]
    ]
    for one in cycles.each:
        changes = [UNKNOWN if x is None else f"{x:.2g}" for x in (one.change, one.advance)]
        lost = [f"{one.contacts[name]:.5g}" for name in several]
        bar = bar_in_words(one.errors.get("total"))
        row = [str(one.number), f"{one.loss:.5g}", bar, *lost, f"{one.work:.5g}", *changes]
        rows.append([*row, one.kind])
    return rows
