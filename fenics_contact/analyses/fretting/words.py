"""Fretting in words, and the table that a run writes of it."""

from __future__ import annotations

from fenics_contact.analyses.fretting.record import FrettingRecord
from fenics_contact.analyses.fretting.table import Fretting
from fenics_contact.results.records.record import ErrorRow, UnitsRecord
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.result import Result
from fenics_contact.results.rounding import UNKNOWN, bar_in_words
from fenics_contact.results.tables import AnalysisWords, Rows, headed
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import UnitNames

NAMES = {"swt": "SWT", "crossland": "Crossland", "dang_van": "Dang Van"}


def fretting_plan(fretting: Fretting, cycles: bool, units: UnitNames | None) -> str:
    """A line on what a run will look at.

    Args:
        fretting: Of the scene.
        cycles: Whether loads come again.
        units: Their names, if any.
    """
    names = list(NAMES.values())
    criteria = names[0] if fretting.limits is None else ", ".join(names)
    lives = "" if fretting.life is None else " with lives"
    over = "the last cycle" if cycles else "all load steps"
    if not cycles and fretting.begin > 0:
        over += f" from time {fretting.begin:g}"
    unit = f" {units.length}" if units is not None else ""
    return (
        f"Fretting: {criteria}{lives}, by the stress over {over}, up to {fretting.depth:g}{unit} "
        "from where contacts touch"
    )


def fretting_words(asked: Fretting | None, found: FrettingRecord | None) -> str:
    """A sentence where fretting was asked for and could not be looked at, or nothing."""
    if asked is None:
        return ""
    if found is None:
        return (
            " Fretting could not be evaluated: there is no whole cycle of stresses, as those of "
            "load steps before a --resume are not kept; run all of them at once."
        )
    if not found.worst:
        return " Fretting could not be evaluated: no contact touches over the cycle."
    return ""


def fretting_rows(
    found: FrettingRecord | None, units: UnitsRecord | None = None
) -> list[list[str]]:
    """A table of the worst places, its head first; empty where there are none.

    Args:
        found: Of the run.
        units: Of its numbers, if any.
    """
    if found is None or not found.worst:
        return []
    at = headed("at", "length", units)
    rows = [
        ["fretting by", headed("largest", "stress", units), "± mesh", at, "on", "means", "± mesh"]
    ]
    for name, one in found.worst.items():
        if name == "swt":
            means = "" if one.life is None else f"{one.life:.3g} cycles"
            off = one.life_errors
        else:
            factor = one.safety_factor
            means = "" if factor is None else f"safety factor {factor:.4g}"
            off = one.safety_factor_errors
        place = ", ".join(f"{x:.4g}" for x in one.at)
        row = [NAMES[name], f"{one.value:.4g}", _bar(one.errors), place, one.contact or one.body]
        rows.append([*row, means, _bar(off) if means else ""])
    return rows


def _bar(errors: ErrorRow) -> str:
    """Return the error bar of the mesh alone."""
    found = errors.get("mesh")
    return UNKNOWN if found is None else bar_in_words(found)


class _FrettingWords(AnalysisWords):
    def plan(self, scene: Scene, units: UnitNames | None) -> list[str]:
        asked = scene.fretting
        return [] if asked is None else [fretting_plan(asked, scene.cycles is not None, units)]

    def tables(self, result: Outcome) -> list[Rows]:
        return [fretting_rows(result.fretting, result.units)]

    def files(self, result: Result) -> dict[str, Rows]:
        places = result.fretting_places
        return {} if places is None else {"fretting.csv": places.rows()}


WORDS = _FrettingWords()
