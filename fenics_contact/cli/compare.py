"""Action of ``fenics-contact compare``: what it shows and writes."""

from __future__ import annotations

import argparse
import logging
from collections.abc import Sequence

from rich import box
from rich.markup import escape
from rich.table import Table

from fenics_contact.common.errors import InputError
from fenics_contact.common.terminal import Terminal
from fenics_contact.common.wording import one_line
from fenics_contact.report.gallery import require
from fenics_contact.report.page.compare import LIBRARIES, write_comparison
from fenics_contact.results.compared_runs import read_runs
from fenics_contact.results.comparison import Comparison, QuantityGroup, QuantityRow

logger = logging.getLogger(__name__)

_WIDEST = 32  # letters of a key that are on one line


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
    try:
        require(*LIBRARIES)
    except InputError as error:  # the tables stand without it
        logger.warning("no page: %s", error)
        return 0
    write_comparison(comparison, page)
    if not options.quiet:
        print(f"Curves of all runs: {one_line(str(page))}")
    return 0


def _print(comparison: Comparison) -> None:
    """Print what matters first: outcomes, changed keys, and their effect."""
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
    table = _table(title, *names, is_named=True)
    for key, *values in rows:
        cells = (_marked(one_line(value)) for value in values)
        table.add_row(escape(_folded(one_line(key))), *cells)
    console.print(table)


def _marked(words: str) -> str:
    return escape(words).replace("FAILED", "[bold red]FAILED[/bold red]")


def _print_group(console: Terminal, names: Sequence[str], group: QuantityGroup) -> None:
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


def _table(*headers: str, is_named: bool = False) -> Table:
    """A table in which nothing is cut off: keys and numbers are to be copied.

    Args:
        *headers: Of the columns.
        is_named: Whether names of the first column are not broken.
    """
    table = Table(box=box.SIMPLE, pad_edge=False)
    for number, header in enumerate(headers):
        is_whole = is_named and number == 0
        table.add_column(escape(one_line(header)), overflow="fold", no_wrap=is_whole)
    return table


def _folded(key: str) -> str:
    """A key on several lines if it is long, broken behind its dots."""
    lines = [""]
    for part in key.split("."):
        if lines[-1] and len(lines[-1]) + len(part) > _WIDEST:
            lines.append("")
        lines[-1] += f"{part}."
    return "\n".join(lines).removesuffix(".")
