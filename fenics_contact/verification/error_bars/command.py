"""The command ``fenics-contact verify --errors``: whether the error bars hold."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI
from rich.markup import escape

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.parallel import on_root
from fenics_contact.common.terminal import Terminal
from fenics_contact.verification.command import FAILED, chosen, require_folder
from fenics_contact.verification.error_bars import CASES
from fenics_contact.verification.error_bars import runs as bar_table
from fenics_contact.verification.error_bars.case import SOURCES, BarCase, Row
from fenics_contact.verification.error_bars.runs import (
    BarOutcome,
    Solver,
    answer_with_errors,
    run_bar_case,
)


def verify_errors(
    names: Sequence[str],
    quick: bool = False,
    json_file: Path | None = None,
    table_file: Path | None = None,
    cases: Sequence[BarCase] = CASES,
    solver: Solver = answer_with_errors,
    quiet: bool = False,
) -> int:
    """Compare error bars with true errors; collective.

    Args:
        names: Of the cases to run; all if empty.
        quick: Fewer cases, elements, meshes and parameters.
        json_file: To write a list of all rows to.
        table_file: To write the table to, in Markdown.
        cases: To choose from.
        solver: What finds quantities and their errors.
        quiet: Say nothing, unless the bars do not hold.

    Returns:
        Exit code: 0 if the bars hold as asked for, else 4.

    Raises:
        InputError: There is no such case, or a file could not be written.
    """
    comm = MPI.COMM_WORLD
    to_run = [case for case in chosen(names, cases) if case.quick or names or not quick]
    on_root(comm, lambda: require_folder("--json", json_file))
    on_root(comm, lambda: require_folder("--table", table_file))
    console = Terminal(quiet=quiet or comm.rank > 0, highlight=False, soft_wrap=True)
    width = max(len(case.name) for case in to_run)
    outcomes = []
    for number, case in enumerate(to_run, 1):
        outcome = run_bar_case(case, quick, solver)
        outcomes.append(outcome)
        for line in _lines(outcome, f"{number:2} of {len(to_run)}", width):
            console.print(line)
    verdict = bar_table.passed(outcomes)
    console.be_quiet(comm.rank > 0 or (quiet and verdict))
    _print_short(console, outcomes)
    console.print()
    for line in bar_table.summary(outcomes):
        console.print(f"{line}.")
    console.print(
        f"Asked for: {100 * bar_table.SHARE_HELD:.0f} % hold, median ratio at most "
        f"{bar_table.MEDIAN_RATIO:g}: {'met' if verdict else '[bold red]NOT MET[/bold red]'}. In "
        f"{sum(outcome.seconds for outcome in outcomes):.0f} s."
    )
    on_root(comm, lambda: _write(outcomes, json_file, table_file))
    return 0 if verdict else FAILED


def _lines(outcome: BarOutcome, counted: str, width: int) -> list[str]:
    """What is said of a case while they run."""
    found = bar_table.count(outcome.rows)
    lines = [
        f"{counted}  {outcome.case.name:{width}}  {found.held:3} of {len(found.rows):3} hold, "
        f"median ratio {found.median:6.2g}, least {found.least:6.2g}, {found.undecided} undecided, "
        f"{found.without} without a bar, {outcome.seconds:.0f} s: {escape(outcome.case.summary)}"
    ]
    return lines + [escape(f"      {note}") for note in outcome.notes]


def _print_short(console: Terminal, outcomes: Sequence[BarOutcome]) -> None:
    """The bars that are too short, quantity by quantity of every case."""
    for outcome in outcomes:
        short = [row for row in outcome.rows if row.counts and not row.held]
        for quantity in dict.fromkeys(row.quantity for row in short):
            rows = [row for row in short if row.quantity == quantity]
            least = min(rows, key=lambda row: row.ratio)
            console.print(
                f"too short: {outcome.case.name}, {quantity}: {len(rows)}, the shortest "
                f"{least.ratio:.2g} of the true error ({bar_table.main_source(least)})"
            )


def _write(outcomes: Sequence[BarOutcome], json_file: Path | None, table_file: Path | None) -> None:
    if json_file is not None:
        rows = [_as_dict(row) for outcome in outcomes for row in outcome.rows]
        text = json.dumps(rows, indent=2, ensure_ascii=False) + "\n"
        replace_file(json_file, text.encode())
    if table_file is not None:
        before = table_file.read_text(encoding="utf-8") if table_file.exists() else ""
        page = bar_table.page(outcomes) + bar_table.kept(before)
        replace_file(table_file, page.encode())


def _as_dict(row: Row) -> dict[str, Any]:
    """A row for ``--json``."""
    setting = row.setting
    ratio = None if row.total is None or not math.isfinite(row.ratio) else row.ratio
    return {
        "name": row.case.name,
        "role": row.case.role,
        "element": setting.element,
        "cells": setting.cells,
        "parameters": setting.level + 1,
        "load": setting.load,
        "quantity": row.quantity,
        "reference": row.size,
        "reference_doubt": row.doubt,
        "true_error": row.error,
        "estimated_error": row.total,
        **{source: row.sources.get(source) for source in SOURCES},
        "ratio": ratio,
        "held": row.held,
        "counts": row.counts,
    }
