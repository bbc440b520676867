"""Runs of the cases of error bars, and the page of what they gave: ``docs/error_bars.md``."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from mpi4py import MPI

from fenics_contact.common.errors import FenicsContactError
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.records.steps import CycleRecord
from fenics_contact.results.result import Result
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.case import UntrustedError
from fenics_contact.verification.error_bars.case import (
    SOURCES,
    BarCase,
    Model,
    Reference,
    Row,
    Setting,
    rows_of,
    size_of,
    without_penalties,
)

# Of the last cycle, where loads come again.
CYCLE_LOSS = "cycle_loss"

Errors = Mapping[str, Mapping[str, float | None]]


@dataclass(frozen=True)
class BarAnswer:
    """Findings of a run: quantities, and their estimated errors by source."""

    quantities: Quantities
    errors: Errors


Solver = Callable[[Model], BarAnswer]


@dataclass(frozen=True)
class BarOutcome:
    """A case that was run.

    Attributes:
        case: The case.
        rows: Of all runs.
        notes: Of runs that gave no answer.
        seconds: For all.
    """

    case: BarCase
    rows: tuple[Row, ...]
    notes: tuple[str, ...]
    seconds: float


def answer_with_errors(model: Model) -> BarAnswer:
    """Solve, and estimate all errors; collective."""
    found = _solved(model, "all")
    last = _last_cycle(found)
    if last is None:
        return BarAnswer(found.quantities, found.errors)
    return BarAnswer(_with_loss(found), {**found.errors, CYCLE_LOSS: last.errors})


def run_bar_case(case: BarCase, quick: bool, solver: Solver = answer_with_errors) -> BarOutcome:
    """Run a case; collective. Runs without an answer are noted."""
    started = time.perf_counter()
    references: dict[float, Reference] = {}
    rows: list[Row] = []
    notes: list[str] = []
    for setting in case.runs(quick):
        try:
            if setting.load not in references:
                references[setting.load] = reference_of(case, setting.load)
            answer = solver(case.model_of(setting))
        except FenicsContactError as error:
            notes.append(f"{words_of(setting)}: {error}")
            continue
        found = references[setting.load]
        rows += rows_of(case, setting, answer.quantities, answer.errors, found)
    seconds = MPI.COMM_WORLD.allreduce(time.perf_counter() - started, op=MPI.MAX)
    return BarOutcome(case, tuple(rows), tuple(notes), seconds)


def reference_of(case: BarCase, load: float) -> Reference:
    """The formula's, or that of the finer of two fine meshes; collective."""
    if case.exact is not None:
        return Reference(case.exact(load), {})
    assert case.finer is not None
    models = [case.finer(level, load) for level in (0, 1)]
    coarse, fine = (
        without_penalties(model.scene, _with_loss(_solved(model, "none"))) for model in models
    )
    doubt = {name: size_of(np.subtract(value, coarse[name])) for name, value in fine.items()}
    return Reference(fine, doubt)


def _last_cycle(found: Result) -> CycleRecord | None:
    return None if found.cycles is None else found.cycles.each[-1]


def _with_loss(found: Result) -> Quantities:
    """Its quantities, and what the last cycle lost."""
    last = _last_cycle(found)
    return found.quantities if last is None else {**found.quantities, CYCLE_LOSS: last.loss}


def words_of(setting: Setting) -> str:
    """A run in a few words."""
    return (
        f"{setting.element}, {setting.cells} cells, parameters {setting.level + 1}, load "
        f"{setting.load:g}"
    )


def _solved(model: Model, errors: Literal["all", "none"]) -> Result:
    """A result that converged, whatever the checks say of large parameters."""
    settings = dataclasses.replace(model.scene.solver, errors=errors)
    scene = dataclasses.replace(model.scene, solver=settings)
    result = Run(scene, MPI.COMM_WORLD, model.body).solve()
    if not result.converged:
        raise UntrustedError(result.verdict)
    return result


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
    """Text that another program has written at the end of the page.

    Args:
        before: The page as it was.

    >>> kept("# Error bars. ## Scenes at random. 500 of them.")[1:]
    '## Scenes at random. 500 of them.'
    """
    _, heading, section = before.partition(_RANDOM)
    return f"\n{heading}{section}" if heading else ""


@dataclass(frozen=True)
class Count:
    """Summary of some rows of the table of error bars.

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
    """Summarise rows of the table of error bars."""
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
    """Name of the source whose estimate is the largest."""
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
