"""The command ``fenics-contact verify``: runs cases and says what came out."""

from __future__ import annotations

import json
import os
import textwrap
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol, TypeVar

from mpi4py import MPI
from rich.markup import escape
from rich.table import Table

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import FenicsContactError, InputError
from fenics_contact.common.parallel import on_root
from fenics_contact.common.terminal import Terminal
from fenics_contact.common.wording import did_you_mean
from fenics_contact.verification import CASES
from fenics_contact.verification.case import Case, Finding, Outcome, no_value, noting_meshes

FAILED = 4


class _Named(Protocol):
    @property
    def name(self) -> str: ...


AnyCase = TypeVar("AnyCase", bound=_Named)

# Of the table at least; a narrower terminal, or a file, would have it cut.
_WIDTH = 110
_WIDEST = 10_000  # any table is narrower


def verify(
    names: Sequence[str],
    quick: bool = False,
    json_file: Path | None = None,
    cases: Sequence[Case] = CASES,
    quiet: bool = False,
) -> int:
    """Run cases; collective.

    Args:
        names: Of the cases to run; all if empty.
        quick: Coarser and fewer runs.
        json_file: To write a list of findings to.
        cases: To choose from.
        quiet: Say nothing, unless one fails.

    Returns:
        Exit code: 0 if all passed, else 4.

    Raises:
        InputError: There is no such case, or the file could not be written.
    """
    comm = MPI.COMM_WORLD
    to_run = chosen(names, cases)
    on_root(comm, lambda: require_folder("--json", json_file))
    console = Terminal(quiet=quiet or comm.rank > 0, highlight=False)
    console.widen(_WIDTH)
    outcomes = []
    width = max(len(case.name) for case in to_run)
    for number, case in enumerate(to_run, 1):
        outcome = run_case(case, quick)
        outcomes.append(outcome)
        verdict = "passed" if outcome.passed else "[bold red]FAILED[/bold red]"
        console.print(
            f"{number:2} of {len(to_run)}  {case.name:{width}} {escape(case.summary):52} "
            f"{outcome.seconds:6.1f} s  {verdict}",
            soft_wrap=True,
        )
    passed = all(outcome.passed for outcome in outcomes)
    console.be_quiet(comm.rank > 0 or (quiet and passed))
    _print_outcomes(console, outcomes)
    on_root(comm, lambda: _write(json_file, outcomes))
    return 0 if passed else FAILED


def run_case(case: Case, quick: bool) -> Outcome:
    """Run a case; collective. An error becomes a finding that did not pass."""
    comm = MPI.COMM_WORLD
    started = time.perf_counter()
    findings: list[Finding] = []
    with noting_meshes() as meshes:
        try:
            for finding in case.run(quick):
                findings.append(finding)
        except FenicsContactError as error:
            findings.append(no_value(error))
    seconds = comm.allreduce(time.perf_counter() - started, op=MPI.MAX)
    return Outcome(case, tuple(findings), seconds, tuple(meshes))


def chosen(names: Sequence[str], cases: Sequence[AnyCase]) -> list[AnyCase]:
    """Cases by their names, in their own order; all if there are no names.

    Raises:
        InputError: There is none of that name.
    """
    known = [case.name for case in cases]
    for name in names:
        if name not in known:
            if hint := did_you_mean(name, known):
                raise InputError(f"verify: no case '{name}'{hint}")
            listed = textwrap.wrap(", ".join(known), _WIDTH - 2, break_on_hyphens=False)
            raise InputError("\n  ".join([f"verify: no case '{name}'; there are", *listed]))
    return [case for case in cases if not names or case.name in names]


def require_folder(option: str, file: Path | None) -> None:
    """Refuse a file that could not be written, before any work."""
    if file is None:
        return
    if file.is_dir() or not os.access(file.parent, os.W_OK):
        raise InputError(f"{option} '{file}': not a file in a folder that can be written to")


def _write(json_file: Path | None, outcomes: Sequence[Outcome]) -> None:
    if json_file is not None:
        rows = [row for outcome in outcomes for row in outcome.rows()]
        text = json.dumps(rows, indent=2, ensure_ascii=False) + "\n"
        replace_file(json_file, text.encode())


def _print_outcomes(console: Terminal, outcomes: Sequence[Outcome]) -> None:
    """The table of findings, then sources and what went wrong."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("case", no_wrap=True)
    table.add_column("quantity", no_wrap=True)
    for header in ("value", "reference", "error", "tolerance"):
        table.add_column(header, justify="right", no_wrap=True)
    table.add_column("")
    for outcome in outcomes:
        for finding in outcome.findings:
            table.add_row(outcome.case.name, *_cells(finding))
    console.print()
    # Numbers that are cut say nothing: a file takes any width, a terminal folds lines.
    unbounded = console.options.update(max_width=_WIDEST)
    console.widen(console.measure(table, options=unbounded).maximum)
    console.print(table)
    console.print("\nErrors are relative, or absolute where marked abs. References:")
    for outcome in outcomes:
        console.print(f"  {outcome.case.name}: {outcome.case.source}", markup=False, soft_wrap=True)
    failed = [outcome for outcome in outcomes if not outcome.passed]
    for outcome in failed:
        for note in (finding.note for finding in outcome.findings if finding.note):
            console.print(f"{outcome.case.name}: {note}", markup=False, soft_wrap=True)
    seconds = sum(outcome.seconds for outcome in outcomes)
    verdict = f"{len(failed)} of {len(outcomes)} cases FAILED" if failed else "All cases passed"
    console.print(f"\n{verdict}, in {seconds:.0f} s.")


def _cells(finding: Finding) -> list[str]:
    kind = " abs" if finding.absolute else ""
    return [
        escape(finding.quantity),
        f"{finding.value:.7g}",
        f"{finding.reference:.7g}",
        f"{finding.error:.1e}",
        f"{finding.tolerance:.1e}{kind}",
        "passed" if finding.passed else "[bold red]FAILED[/bold red]",
    ]
