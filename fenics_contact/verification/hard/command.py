"""The command ``fenics-contact verify --hard``: runs hard cases and says what came out."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

from mpi4py import MPI
from rich.markup import escape

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.parallel import on_root
from fenics_contact.common.terminal import Terminal
from fenics_contact.verification.command import FAILED, chosen, require_folder
from fenics_contact.verification.hard import CASES
from fenics_contact.verification.hard.case import HardCase, HardOutcome, run_hard_case

_INTRODUCTION = """\
# Hard cases

Written by `fenics-contact verify --hard --table docs/hard_cases.md`; do not edit. `verify --hard`
without the last two words prints the same; names of cases choose some, `--json FILE` writes all
that was compared, and exit code 4 says that a case failed. Also under `mpirun -n N`.

Every case has an answer that is known from elsewhere, or is known to have none. It *passes* if the
program finds that answer within the limit, or ends without an answer, by exit code 2 (refused) or
3 (not converged), where that is expected and in words that name the reason. A case that is given a
wrong answer for good (exit code 0 and all checks passed) is **silently wrong**. An answer that a
check of the physics refuses (exit code 4) is *untrusted*, and passes only where the answer itself
is to be refused, as one with cells that turn inside out.

The row of a case has the run with the most Newton steps, or the one that gave no answer, and the
finding that is nearest to its limit. Errors are relative, or absolute where marked abs. The limits
are what the method promises: .1 % of a force with the automatic ε and ε₁, round-off where they do
not matter, and the mesh's error against formulas of unbounded bodies. References by *exact
inequalities* (`verification/hard/exact.py`) are solutions on the same mesh by an active-set method
that has neither penalty nor regularisation, nor any of the program's contact terms or solvers.
"""
_HEAD = (
    "| case | what is hard | expected | found | Newton | outer | quantity | value | reference | "
    "error | limit | |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n"
)


def page(outcomes: Sequence[HardOutcome]) -> str:
    """The page, in Markdown."""
    text = f"{_INTRODUCTION}\n{summary(outcomes)}\n"
    for theme, group in groupby(outcomes, key=lambda outcome: outcome.case.theme):
        members = list(group)
        text += f"\n## {theme}\n\n{_HEAD}"
        text += "".join(f"| {' | '.join(cells(outcome))} |\n" for outcome in members)
        text += "\nReferences:\n\n" + _sources(members)
        said = [outcome for outcome in members if outcome.decisive.exit_code or outcome.note]
        if said:
            text += "\nWhat the program says:\n\n"
            text += "".join(f"- `{o.case.name}`: {o.note or o.decisive.sentence}\n" for o in said)
    return text


def summary(outcomes: Sequence[HardOutcome]) -> str:
    """How many ended how."""
    passed = sum(outcome.passed for outcome in outcomes)
    wrong = sum(outcome.is_silently_wrong for outcome in outcomes)
    endings = [outcome.ending for outcome in outcomes]
    counts = ", ".join(f"{endings.count(ending)} {ending}" for ending in dict.fromkeys(endings))
    return (
        f"{passed} of {len(outcomes)} cases passed ({counts}); "
        f"{wrong or 'none'} {'is' if wrong == 1 else 'are'} silently wrong."
    )


def cells(outcome: HardOutcome) -> list[str]:
    """A case's row."""
    trial, worst = outcome.decisive, outcome.worst
    compared = ["", "", "", "", ""]
    if worst is not None:
        compared = [
            worst.quantity.replace("|", "\\|"),
            f"{worst.value:.6g}",
            f"{worst.reference:.6g}",
            f"{worst.error:.1e}",
            f"{worst.tolerance:.0e}{' abs' if worst.absolute else ''}",
        ]
    return [
        outcome.case.name,
        outcome.case.difficulty,
        " or ".join(outcome.case.expected),
        f"{outcome.ending} ({trial.exit_code})",
        str(trial.newton),
        str(trial.outer),
        *compared,
        outcome.judgement,
    ]


def _sources(outcomes: Sequence[HardOutcome]) -> str:
    """Of a theme: each source once, with its cases."""
    by_source: dict[str, list[str]] = {}
    for outcome in outcomes:
        by_source.setdefault(outcome.case.source, []).append(f"`{outcome.case.name}`")
    return "".join(f"- {', '.join(names)}: {source}\n" for source, names in by_source.items())


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
    console.print(f"\n{summary(outcomes)} In {sum(outcome.seconds for outcome in outcomes):.0f} s.")
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
        replace_file(table_file, page(outcomes).encode())
