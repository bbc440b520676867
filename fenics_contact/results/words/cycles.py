"""Cycles of loads in words."""

from __future__ import annotations

from fenics_contact.quantities.names import MAX_WEAR_DEPTH, WORN_VOLUME
from fenics_contact.results.records.cycles import CycleRecord, CyclesRecord, WornCycleEnd
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
    if last.worn is not None:
        return _worn_words(cycles.computed, last.number, last.worn)
    if not last.is_closed:
        still = "" if last.change is None else f"; tractions still change by {last.change:.2g}"
        if last.is_kept_changing:
            still += ", and so does what is kept at the contact points, such as wear"
        many = "cycle" if cycles.computed == 1 else "cycles"
        return f" The loop is not closed after {cycles.computed} {many}{still}."
    words = _KINDS[last.kind].format(loss=last.loss, advance=last.advance)
    return f" The loop closed in cycle {cycles.closed_in} of {cycles.number}, {words}."


def _worn_words(computed: int, number: int, worn: WornCycleEnd) -> str:
    """Return how many cycles that wear were computed, and the error of the others, in words."""
    errors = worn.errors
    return (
        f" {number} cycles wear, of which {computed} were computed; passing over the others may be "
        f"off by {errors[WORN_VOLUME]:.2g} in the worn volume, and by "
        f"{errors[MAX_WEAR_DEPTH]:.2g} in the deepest wear."
    )


def cycle_rows(cycles: CyclesRecord | None, units: UnitsRecord | None = None) -> list[list[str]]:
    """A table of all cycles that were computed, its head first; empty where there are none.

    Args:
        cycles: Of the run.
        units: Of their numbers, if any.
    """
    if cycles is None:
        return []
    if cycles.each[0].worn is not None:
        return _worn_rows(cycles.each, units)
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
        work = UNKNOWN if one.work is None else f"{one.work:.5g}"
        row = [str(one.number), f"{one.loss:.5g}", bar, *lost, work, *changes]
        rows.append([*row, one.kind])
    return rows


def _worn_rows(each: list[CycleRecord], units: UnitsRecord | None) -> list[list[str]]:
    """Return the table of cycles that wear, most of which are passed over."""
    rows = [
        [
            "cycle",
            "passed over before",
            headed("loss", "energy", units),
            "change of pressures",
            headed("never slips", "area", units),
            "depth over half width",
            headed("± of worn volume", "volume", units),
            headed("± of deepest wear", "length", units),
        ]
    ]
    for one in each:
        worn = one.worn
        assert worn is not None
        rows.append(
            [
                str(one.number),
                str(worn.passed_over),
                f"{one.loss:.5g}",
                f"{worn.pressure_change:.2g}",
                f"{sum(worn.stick_areas.values()):.4g}",
                f"{worn.depth_over_width:.2g}",
                f"{worn.errors[WORN_VOLUME]:.2g}",
                f"{worn.errors[MAX_WEAR_DEPTH]:.2g}",
            ]
        )
    return rows
