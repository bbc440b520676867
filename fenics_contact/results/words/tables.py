"""Results of a run as rows of a table and in short words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fenics_contact.quantities import table
from fenics_contact.quantities.names import FRICTION_FORCE, NORMAL_FORCE, SLIP_AREA, STICK_AREA
from fenics_contact.quantities.table import measured_by
from fenics_contact.results.records.model import RigidMotion
from fenics_contact.results.records.record import Errors
from fenics_contact.results.records.steps import BranchRecord
from fenics_contact.results.records.units import NO_UNITS, UnitsRecord
from fenics_contact.results.words.rounding import bar_in_words

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
