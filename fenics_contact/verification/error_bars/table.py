"""The table of error bars as a page: ``docs/error_bars.md``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.verification.error_bars.case import SOURCES, Row
from fenics_contact.verification.error_bars.runs import BarOutcome, words_of

# What is asked for.
SHARE_HELD, MEDIAN_RATIO = 0.95, 5.0
_WORST_SHOWN = 25
_ROLES = (
    ("all cases", None),
    ("cases that test", "tested"),
    ("cases that constants were chosen by", "chosen"),
)

_INTRODUCTION = """\
# Error bars against true errors

Written by `fenics-contact verify --errors --table docs/error_bars.md`; do not edit. `verify
--errors` without the last two words prints the same; names choose cases, `--quick` takes about a
minute, `--json FILE` writes every row. Exit code 4 says that the bars do not hold as asked for.

Every case is run on three meshes of each element, with three ε and ε₁ on each of these, from the
automatic ones on. The *true error* of a quantity is its distance from a formula that is exact for
what is modelled, or from the same model on much finer meshes (and of a larger domain, with more
load steps), with the automatic parameters, which are small. The *bar* is `errors.QUANTITY.total` of
`result.json`. A bar *holds* if the true error is no larger; the *ratio* is bar over true error.
Asked for: 95 % of the bars hold, with a median ratio of 5 at the most.

Left out are quantities that are given, or vanish by symmetry, so that neither true error nor bar
exceeds round-off; `max_penetration` and `penalty_energy` of penalties, which are all error; and
those of which the reference is not known to a tenth of the true error or of the bar, whichever is
larger: the distance between two references on fine meshes is what they are trusted to. Cases by
which constants of the estimators were *chosen* count apart from those that *test* them.
"""


# Of the part that benchmarks/random_scenes.py writes.
_RANDOM = "## Scenes at random"


def kept(before: str) -> str:
    """What another program has written at the end of the page.

    Args:
        before: The page as it was.

    >>> kept("# Error bars. ## Scenes at random. 500 of them.")[1:]
    '## Scenes at random. 500 of them.'
    """
    _, heading, section = before.partition(_RANDOM)
    return f"\n{heading}{section}" if heading else ""


@dataclass(frozen=True)
class Count:
    """What some rows say together.

    Attributes:
        rows: Those that count.
        undecided: How many more there are of which the reference is not good enough.
        without: How many more have no bar.
    """

    rows: tuple[Row, ...]
    undecided: int
    without: int

    @property
    def held(self) -> int:
        """How many bars hold."""
        return sum(row.held for row in self.rows)

    @property
    def share(self) -> float:
        """Share of the bars that hold, 0 of none."""
        return self.held / len(self.rows) if self.rows else 0.0

    @property
    def median(self) -> float:
        """Median of estimated over true error; infinite of none."""
        return float(np.median([row.ratio for row in self.rows])) if self.rows else np.inf

    @property
    def least(self) -> float:
        """The smallest ratio."""
        return min((row.ratio for row in self.rows), default=np.inf)

    @property
    def passed(self) -> bool:
        """Whether the bars hold as asked for."""
        return self.share >= SHARE_HELD and self.median <= MEDIAN_RATIO

    def cells(self) -> list[str]:
        """For a row of a table."""
        if not self.rows:
            return ["0", "", "", "", str(self.undecided), str(self.without)]
        return [
            str(len(self.rows)),
            f"{100 * self.share:.0f} %",
            f"{self.median:.2g}",
            f"{self.least:.2g}",
            str(self.undecided),
            str(self.without),
        ]


def count(rows: Iterable[Row]) -> Count:
    """What rows say together."""
    found = [row for row in rows if not row.is_given]
    return Count(
        tuple(row for row in found if row.counts),
        sum(row.total is not None and not row.is_decided for row in found),
        sum(row.total is None for row in found),
    )


def passed(outcomes: Sequence[BarOutcome]) -> bool:
    """Whether all runs gave an answer, and bars hold: over all cases, and over those that test."""
    rows = [row for outcome in outcomes for row in outcome.rows]
    tested = [row for row in rows if row.case.role == "tested"]
    groups = [rows, tested] if tested else [rows]
    return all(count(group).passed for group in groups) and not any(o.notes for o in outcomes)


def summary(outcomes: Sequence[BarOutcome]) -> list[str]:
    """A sentence on all cases, and on those of each role."""
    rows = [row for outcome in outcomes for row in outcome.rows]
    said = []
    for name, role in _ROLES:
        found = count(row for row in rows if role in (None, row.case.role))
        if found.rows:
            said.append(
                f"{name}: {found.held} of {len(found.rows)} bars hold ({100 * found.share:.1f} %), "
                f"median ratio {found.median:.2g}; {found.undecided} undecided, "
                f"{found.without} without a bar"
            )
    return said or ["no bars"]


def page(outcomes: Sequence[BarOutcome]) -> str:
    """The page, in Markdown."""
    rows = [row for outcome in outcomes for row in outcome.rows]
    parts = [_INTRODUCTION, *(f"- {line}" for line in summary(outcomes))]
    parts += ["", "## Cases", "", *_cases(outcomes)]
    parts += ["", "## Quantities", "", *_grouped("quantity", rows, lambda row: row.quantity)]
    parts += ["", "## Elements", "", *_grouped("element", rows, lambda row: row.setting.element)]
    parts += ["", "## Parameters", "", *_grouped("ε, ε₁", rows, _level_of)]
    parts += ["", "## Largest source", "", *_grouped("largest source", rows, main_source)]
    parts += ["", "## Bars that are too short, shortest first", "", *_worst(rows)]
    notes = [f"- `{o.case.name}`, {note}" for o in outcomes for note in o.notes]
    parts += ["", "Runs without an answer:", "", *notes] if notes else []
    return "\n".join(parts) + "\n"


def main_source(row: Row) -> str:
    """Which estimate is the largest."""
    found = {source: row.sources.get(source) or 0.0 for source in SOURCES}
    return max(found, key=lambda source: found[source])


def _level_of(row: Row) -> str:
    return ("smallest", "medium", "largest")[row.setting.level]


def _cases(outcomes: Sequence[BarOutcome]) -> list[str]:
    lines = [
        "| case | what | role | elements | bars | hold | median ratio | least | undecided | "
        "without | seconds | reference |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for outcome in outcomes:
        case = outcome.case
        cells = [case.name, case.summary, case.role, ", ".join(case.elements)]
        cells += [*count(outcome.rows).cells(), f"{outcome.seconds:.0f}", case.source]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _grouped(title: str, rows: Sequence[Row], key: Callable[[Row], str]) -> list[str]:
    lines = [
        f"| {title} | bars | hold | median ratio | least | undecided | without |",
        "|---|---|---|---|---|---|---|",
    ]
    for name in dict.fromkeys(key(row) for row in rows):
        found = count(row for row in rows if key(row) == name)
        lines.append(f"| {' | '.join([name, *found.cells()])} |")
    return lines


def _worst(rows: Sequence[Row]) -> list[str]:
    short = sorted((row for row in rows if row.counts and not row.held), key=lambda r: r.ratio)
    lines = [
        "| case | run | quantity | true error, relative | ratio | largest source |",
        "|---|---|---|---|---|---|",
    ]
    for row in short[:_WORST_SHOWN]:
        relative = f"{row.error / row.size:.1e}" if row.size else f"{row.error:.1e} abs"
        cells = [row.case.name, words_of(row.setting), row.quantity, relative]
        cells += [f"{row.ratio:.2g}", main_source(row)]
        lines.append(f"| {' | '.join(cells)} |")
    if len(short) > _WORST_SHOWN:
        lines += ["", f"And {len(short) - _WORST_SHOWN} more."]
    return lines
