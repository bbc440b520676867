"""The command ``fenics-contact verify --hard``: runs hard cases and says what came out."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI
from rich.markup import escape

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.parallel import on_root
from fenics_contact.common.terminal import Terminal
from fenics_contact.verification.command import FAILED, chosen, require_folder
from fenics_contact.verification.hard import CASES, table
from fenics_contact.verification.hard.case import HardCase, HardOutcome, run_hard_case


def verify_hard(
    names: Sequence[str],
    json_file: Path | None = None,
    table_file: Path | None = None,
    cases: Sequence[HardCase] = CASES,
    quiet: bool = False,
) -> int:
    """Run hard cases; collective.

    Args:
        names: Of the cases to run; all if empty.
        json_file: To write a list of what was found to.
        table_file: To write the table to, in Markdown.
        cases: To choose from.
        quiet: Say nothing but of those that fail.

    Returns:
        Exit code: 0 if all passed, else 4.

    Raises:
        InputError: There is no such case, or a file could not be written.
    """
    comm = MPI.COMM_WORLD
    to_run = chosen(names, cases)
    on_root(comm, lambda: require_folder("--json", json_file))
    on_root(comm, lambda: require_folder("--table", table_file))
    console = Terminal(quiet=comm.rank > 0, highlight=False, soft_wrap=True)
    width = max(len(case.name) for case in to_run)
    outcomes = []
    for number, case in enumerate(to_run, 1):
        outcome = run_hard_case(case)
        outcomes.append(outcome)
        console.be_quiet(comm.rank > 0 or (quiet and outcome.passed))
        for line in _lines(outcome, f"{number:3} of {len(to_run)}", width):
            console.print(line)
    passed = all(outcome.passed for outcome in outcomes)
    console.be_quiet(comm.rank > 0 or (quiet and passed))
    console.print(
        f"\n{table.summary(outcomes)} In {sum(outcome.seconds for outcome in outcomes):.0f} s."
    )
    on_root(comm, lambda: _write(outcomes, json_file, table_file))
    return 0 if passed else FAILED


def _lines(outcome: HardOutcome, counted: str, width: int) -> list[str]:
    """What is said of a case while they run."""
    trial = outcome.decisive
    judgement = outcome.judgement
    if not outcome.passed:
        judgement = f"[bold red]{judgement}[/bold red]"
    case = outcome.case
    lines = [
        f"{counted}  {case.name:{width}}  {judgement}  {outcome.ending} ({trial.exit_code}), "
        f"Newton {trial.newton}, outer {trial.outer}, {outcome.seconds:.1f} s: "
        f"{escape(case.difficulty)}"
    ]
    worst = outcome.worst
    if worst is not None:
        kind = " abs" if worst.absolute else ""
        lines.append(
            escape(
                f"      {worst.quantity}: {worst.value:.7g}, reference {worst.reference:.7g}, "
                f"error {worst.error:.1e}{kind}, limit {worst.tolerance:.1e} ({case.source})"
            )
        )
    if trial.exit_code or outcome.note:
        lines.append(escape(f"      {outcome.note or trial.sentence}"))
    return lines


def _write(
    outcomes: Sequence[HardOutcome], json_file: Path | None, table_file: Path | None
) -> None:
    if json_file is not None:
        rows = [outcome.as_dict() for outcome in outcomes]
        text = json.dumps(rows, indent=2, ensure_ascii=False) + "\n"
        replace_file(json_file, text.encode())
    if table_file is not None:
        replace_file(table_file, table.page(outcomes).encode())
