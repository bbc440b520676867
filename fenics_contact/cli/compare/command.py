"""What ``fenics-contact compare`` shows and writes."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from rich import box
from rich.markup import escape
from rich.table import Table

from fenics_contact.common.errors import InputError
from fenics_contact.common.plain_text import one_line
from fenics_contact.common.terminal import Terminal
from fenics_contact.report.compare.page import write_comparison
from fenics_contact.results.comparison.comparison import Comparison, Group, QuantityRow
from fenics_contact.results.comparison.runs import read_runs


def compare(options: argparse.Namespace) -> int:
    """Read the runs, show what differs, and write the page.

    Args:
        options: As ``options.describe`` has them, and ``quiet``.

    Returns:
        The exit code: 0, however much the runs differ.

    Raises:
        InputError: A run cannot be read, or the page cannot be where it is asked for.
    """
    page = options.out
    if page.suffix != ".html" or page.is_dir():
        raise InputError(f"compare --out '{page}': must be the name of a page, such as runs.html")
    comparison = Comparison(read_runs(options.folders), options.all)
    if not options.quiet:
        _print(comparison)
    write_comparison(comparison, page)
    if not options.quiet:
        print(f"Curves of all runs: {one_line(str(page))}")
    return 0


def _print(comparison: Comparison) -> None:
    """What matters first: outcomes, what was changed, what came of it."""
    console, names = Terminal(), comparison.names
    groups = comparison.groups()
    console.print(f"\n[bold]{escape(' · '.join(names))}[/bold]", highlight=False)
    for run in comparison.runs:
        colour = "green" if run.result.passed else "bold red"
        said = escape(f"  {run.name}: ")
        console.print(f"{said}[{colour}]{run.outcome}[/{colour}]", highlight=False, soft_wrap=True)
    for note in comparison.notes():
        console.print(one_line(note), markup=False, highlight=False, soft_wrap=True)
    scene = comparison.scene_rows()
    _print_rows(console, "scene", names, scene, "The scenes do not differ.")
    console.print(comparison.headline(groups), markup=False, highlight=False, soft_wrap=True)
    for group in groups:
        _print_group(console, names, group)
    _print_rows(console, "check", names, comparison.check_rows())
    _print_rows(console, "model", names, comparison.model_rows())


def _print_rows(
    console: Terminal, title: str, names: Sequence[str], rows: list[list[str]], otherwise: str = ""
) -> None:
    """Names and the value in each run."""
    if not rows:
        if otherwise:
            console.print(otherwise)
        return
    table = _table(title, *names)
    for row in rows:
        table.add_row(*(_marked(one_line(cell)) for cell in row))
    console.print(table)


def _marked(words: str) -> str:
    return escape(words).replace("FAILED", "[bold red]FAILED[/bold red]")


def _print_group(console: Terminal, names: Sequence[str], group: Group) -> None:
    """Quantities, their differences and how many error bars these are."""
    units = ["unit"] * any(row.unit for row in group.rows)
    _, *others = names
    apart = ["difference", "share", "bars"] if len(others) == 1 else [f"bars {n}" for n in others]
    table = _table(group.title, *names, *units, *(apart if group.rows else ()))
    for row in group.rows:
        cells = [row.name, *row.values, *([row.unit] if units else []), *_apart(row)]
        table.add_row(*map(escape, cells), style="bold" if _is_beyond(row) else None)
    for setting in group.settings:
        table.add_row(*map(escape, setting))
    console.print(table)


def _apart(row: QuantityRow) -> list[str]:
    if len(row.differences) > 1:
        return ["" if found is None else found.bars for found in row.differences]
    (found,) = row.differences
    return ["", "", ""] if found is None else [found.words, found.share, found.bars]


def _is_beyond(row: QuantityRow) -> bool:
    return any(found is not None and found.is_beyond_bars for found in row.differences)


def _table(*headers: str) -> Table:
    table = Table(box=box.SIMPLE, pad_edge=False)
    for header in headers:
        table.add_column(escape(one_line(header)))
    return table
