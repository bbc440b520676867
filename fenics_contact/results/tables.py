"""Results of a run, its cycles and its analyses, in rows of tables and in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import cast

from fenics_contact.analyses import registry
from fenics_contact.quantities import table
from fenics_contact.quantities.names import (
    FRICTION_FORCE,
    NORMAL_FORCE,
    SLIP_AREA,
    STICK_AREA,
)
from fenics_contact.quantities.table import measured_by
from fenics_contact.results.records.record import NO_UNITS, Errors, UnitsRecord
from fenics_contact.results.records.run import Outcome, RigidMotion
from fenics_contact.results.records.steps import BranchRecord, CyclesRecord, StepRecord
from fenics_contact.results.result import Result
from fenics_contact.results.rounding import UNKNOWN, bar_in_words
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import UnitNames

# What answers of one scene are told apart by.
_OF_BRANCHES = (NORMAL_FORCE, FRICTION_FORCE, STICK_AREA, SLIP_AREA)


def branch_rows(
    branches: Sequence[BranchRecord], units: UnitsRecord | None = None
) -> list[list[object]]:
    """A table of all answers that were found, its head first; empty where there is but one.

    Args:
        branches: The answers.
        units: Of their numbers, if any.
    """
    if len(branches) < 2:
        return []
    names = [
        headed(name.replace("_", " "), measured_by(name.partition(" ")[0]), units)
        for name, _ in _of_branch(branches[0])
    ]
    rows: list[list[object]] = [["answer from the start", *names, "checks"]]
    for branch in branches:
        numbers = [value for _, value in _of_branch(branch)]
        rows.append([branch.start, *numbers, "ok" if branch.passed else "FAILED"])
    return rows


def _of_branch(branch: BranchRecord) -> Iterator[tuple[str, object]]:
    """Name and value of each number, resultants of several contacts contact by contact."""
    for key in _OF_BRANCHES:
        if key in table.resultants_of_contacts() and len(branch.contacts) > 1:
            for contact in branch.contacts:
                yield f"{key} of '{contact.name}'", contact.quantities[key]
        else:
            yield key, branch.quantities[key]


def headed(words: str, measured: str, units: UnitsRecord | None) -> str:
    """A column's or a row's name, with the unit of its numbers in brackets, if there is one.

    Args:
        words: The name.
        measured: What the numbers measure.
        units: Of the run, if any.
    """
    unit = (units or NO_UNITS).of(measured)
    return f"{words} ({unit})" if unit else words


def motion_words(motion: RigidMotion) -> str:
    """A rigid motion, and what may resist it."""
    return f"{motion.motion}: resisted by {', '.join(motion.resisted_by) or 'nothing'}"


def share_words(share: float) -> str:
    """The used share of a limit load: no scene at the limit is run, so none is said to be."""
    words = f"{share:.6g}"
    return "just below 1, the limit" if words == "1" else words


def error_rows(errors: Errors) -> list[list[str]]:
    """A table of estimated errors by source, its head first; empty where there are none.

    Args:
        errors: By quantity, in words.
    """
    if not errors:
        return []
    sources = list(next(iter(errors.values())))
    rows = [["quantity", *sources]]
    for name, row in errors.items():
        rows.append([name, *map(bar_in_words, row.values())])
    return rows


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
    own = registry.part_of_cycle(last, "words")
    if own is not None:
        return cast(AnalysisWords, own.WORDS).cycles(cycles)
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
    own = registry.part_of_cycle(cycles.each[0], "words")
    if own is not None:
        return cast(AnalysisWords, own.WORDS).cycle_rows(cycles, units)
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


Rows = list[list[str]]


class AnalysisWords:
    """Words of an analysis, the part ``words`` of its folder has them as ``WORDS``."""

    def plan(self, scene: Scene, units: UnitNames | None) -> list[str]:
        """Lines on what a run will look at, for ``fenics-contact check``.

        Args:
            scene: One that asks for the analysis.
            units: Names of its units, if any.
        """
        return []

    def cycle_plan(self, cycles: Cycles) -> str:
        """How many of the cycles of loads it takes in its own way, for ``fenics-contact check``.

        Args:
            cycles: Of a scene that asks for the analysis.
        """
        return ""

    def step_line(self, step: StepRecord, units: UnitNames | None) -> str:
        """A line for the log on a load step that it took in its own way.

        Args:
            step: Its record.
            units: Names of the scene's units, if any.
        """
        return ""

    def cycles(self, cycles: CyclesRecord) -> str:
        """A sentence, after a space, on cycles of loads that it took in its own way.

        Args:
            cycles: Of the result.
        """
        return ""

    def cycle_rows(self, cycles: CyclesRecord, units: UnitsRecord | None) -> Rows:
        """A table of cycles that it took in its own way, the head first.

        Args:
            cycles: Of the result.
            units: Of their numbers, if any.
        """
        return []

    def tables(self, result: Outcome) -> list[Rows]:
        """Tables of what came out, the head of each first.

        Args:
            result: A result that has something of the analysis.
        """
        return []

    def files(self, result: Result) -> dict[str, Rows]:
        """Tables that a run writes, the header of each first, by the names of their files.

        Args:
            result: A result that has something of the analysis.
        """
        return {}

    def notes(self, result: Outcome) -> list[str]:
        """Sentences on what came out, below the tables.

        Args:
            result: As of ``tables``.
        """
        return []
