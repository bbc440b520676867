"""What rows of scenes at random say together: how far bars cover, what must not be; no FEniCSx."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from statistics import median

import numpy as np
from random_changes import Change, Row, refinements, size_of


@dataclass
class Coverage:
    """Of a quantity, over all scenes.

    Attributes:
        changes: How many count.
        covered: By the bar of the coarse answer.
        missing: Without a bar.
        endless: Left out: the run says that they do not converge.
        ratios: Bar over change.
    """

    changes: int = 0
    covered: int = 0
    missing: int = 0
    endless: int = 0
    ratios: list[float] = field(default_factory=list)

    def add(self, change: Change) -> None:
        """One more; without a bar it is not covered, unless it does not converge."""
        if change.bar is None and change.endless == "yes":
            self.endless += 1
            return
        self.changes += 1
        self.covered += change.covered
        self.missing += change.bar is None
        if change.bar is not None:
            self.ratios.append(change.bar / change.change)


def coverage(rows: Iterable[Row]) -> dict[str, Coverage]:
    """By quantity, of all scenes that were answered on both meshes, checks passed."""
    found: dict[str, Coverage] = {}
    for change in refinements(rows):
        found.setdefault(change.quantity, Coverage()).add(change)
    return found


def against_statics(rows: Iterable[Row]) -> list[str]:
    """Scenes that were answered where statics refuse them, or the other way round."""
    found = []
    for row in rows:
        must = row.get("must_be", "")
        refused = row["code"] in (2, 3)
        if row["stage"] == "coarse" and (
            (must == "refused" and row["code"] == 0) or (must in ("answered", "seen") and refused)
        ):
            found.append(f"{_name(row)}: must be {must}, ended with {row['code']}: {row['words']}")
    return found


def rank_differences(rows: Iterable[Row]) -> list[str]:
    """Scenes whose outcome, or a number of it by more than 1e-6, depends on the number of ranks."""
    found, first = [], {}
    for row in rows:
        if row["stage"] != "coarse":
            continue
        other = first.setdefault(row["number"], row)
        if other is row:
            continue
        if other["code"] != row["code"]:
            codes = f"{other['code']} on {other['ranks']}, {row['code']} on {row['ranks']} ranks"
            found.append(f"{_name(row)}: {codes}")
        elif row["code"] == 0:
            found += [f"{_name(row)}: {text}" for text in _unlike(other, row)]
    return found


def solver_differences(rows: Iterable[Row]) -> list[str]:
    """Scenes whose outcome, or a number of it by more than 1e-5, depends on the direct solver."""
    rows, found = list(rows), []
    others = {row["number"]: row for row in rows if row["stage"] == "solver"}
    for row in rows:
        other = others.get(row["number"])
        if row["stage"] != "coarse" or other is None or row["ranks"] != other["ranks"]:
            continue
        who = f"{_name(row)}, by {row['solver']} and {other.get('solver', 'the other solver')}"
        if other["code"] != row["code"]:
            found.append(f"{who}: ended with {row['code']} and {other['code']}: {other['words']}")
        else:
            found += [f"{who}: {text}" for text in _unlike(row, other, 1e-5, bars=False)]
    return found


def _unlike(one: Row, other: Row, most: float = 1e-6, bars: bool = True) -> list[str]:
    """Quantities that differ, or that only one of both has a bar of."""
    found = []
    for name, (values, bar) in one["quantities"].items():
        theirs = other["quantities"].get(name, [[], None])
        a, b = np.array(values), np.array(theirs[0])
        if len(a) != len(b) or (bars and (bar is None) != (theirs[1] is None)):
            found.append(f"{name} {values} ± {bar} and {theirs[0]} ± {theirs[1]}")
            continue
        change = float(np.linalg.norm(a - b))
        if change > most * size_of(one, name, a, b):
            found.append(f"{name} {values} and {theirs[0]}")
    return found


def _name(row: Row) -> str:
    return f"{row['number']} ({row['kind']})"


def table(found: Mapping[str, Coverage]) -> str:
    """Of all quantities, as Markdown."""
    lines = [
        "| quantity | changes | covered | without a bar | do not converge | median bar / change |",
        "|---|---|---|---|---|---|",
    ]
    for name, each in sorted(found.items(), key=lambda item: -item[1].changes):
        share = f"{100 * each.covered / each.changes:.0f} %" if each.changes else ""
        ratio = f"{median(each.ratios):.2g}" if each.ratios else ""
        lines.append(
            f"| {name} | {each.changes} | {share} | {each.missing} | {each.endless} | {ratio} |"
        )
    return "\n".join(lines)
