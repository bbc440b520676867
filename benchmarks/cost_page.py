"""The tables of docs/solve_cost.md."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import page_tables
from cost_heat import LIMIT_OF_HEAT
from cost_measure import LIMIT_OF_FURTHER_STEP, limit_of
from page_tables import markdown

Row = dict[str, Any]

# Which rows a table has, by its name.
TABLES: dict[str, Callable[[Row], bool]] = {
    "one body": lambda row: _is_alone(row) and row["solver"] in ("condensed", "full"),
    "two bodies": lambda row: (
        _is_one_step(row)
        and row["bodies"] > 1
        and not row["full_contact"]
        and "heat_ratio" not in row
    ),
    "full contact": lambda row: row["full_contact"],
    "iterative": lambda row: _is_alone(row) and row["solver"] in ("iterative", "auto"),
    "further steps": lambda row: row["steps"] > 1,
    "heat": lambda row: "heat_ratio" in row,
}


def filled(page: str, rows: list[Row]) -> str:
    """A page with the tables of these rows in place of those that it has.

    Raises:
        ValueError: A table that there is to be is missing on the page, or is not known.
    """
    tables = {}
    for name, belongs in TABLES.items():
        chosen = [row for row in rows if belongs(row)]
        tables[name] = {"further steps": _further_table, "heat": _heat_table}.get(name, _table)(
            chosen
        )
    return page_tables.filled(page, tables)


def _is_one_step(row: Row) -> bool:
    return bool(row["steps"] == 1)


def _is_alone(row: Row) -> bool:
    return _is_one_step(row) and row["bodies"] == 1 and not row["full_contact"]


def _table(rows: list[Row]) -> str:
    headings = ["case", "contact dofs", "slips", "solver", "linear solver", "linear", "frictional"]
    headings += ["ratio", "limit", "error bars", "Newton, passes", "memory", "over linear"]
    return markdown(headings, [_cells(row) for row in rows])


def _cells(row: Row) -> list[str]:
    chosen, linear = row["solver_chosen"], row["linear_seconds"]
    limit = limit_of(row)
    return [
        row["case"],
        f"{row['contact_dofs']:,} ({row['contact_dofs'] / row['dofs']:.1%})",
        f"{row['slip_share']:.0%}",
        row["solver"] if row["solver"] == chosen else f"{row['solver']}: {chosen}",
        row["linear_solver"],
        f"{linear:.3g} s",
        f"{row['frictional_seconds']:.3g} s",
        _against(row["ratio"], limit, 2),
        "" if limit is None else f"{limit:g}",
        f"{row['seconds_errors'] / linear:.2f}",
        f"{row['newton']}, {row['outer']}",
        f"{row['peak_memory_mb']:.0f} MB",
        f"{row['peak_memory_mb'] / row['linear_memory_mb']:.2f}",
    ]


def _further_table(rows: list[Row]) -> str:
    headings = ["case", "solver", "a step", "limit", "with results read", "Newton steps in all"]
    cells = [
        [
            row["case"],
            row["solver"],
            _against(row["further_step_ratio"], LIMIT_OF_FURTHER_STEP, 3),
            f"{LIMIT_OF_FURTHER_STEP:g}",
            f"{row['further_step_ratio_with_results']:.3f}",
            str(row["newton"]),
        ]
        for row in rows
    ]
    return markdown(headings, cells)


def _heat_table(rows: list[Row]) -> str:
    headings = ["case", "run", "with heat", "ratio", "limit"]
    cells = [
        [
            row["case"],
            *(f"{row[key]:.2f} s" for key in ("run_seconds", "heat_run_seconds")),
            _against(row["heat_ratio"], LIMIT_OF_HEAT, 2),
            f"{LIMIT_OF_HEAT:g}",
        ]
        for row in rows
    ]
    return markdown(headings, cells)


def _against(ratio: float, limit: float | None, digits: int) -> str:
    """A ratio, bold where it is above its limit."""
    said = f"{ratio:.{digits}f}"
    return said if limit is None or ratio <= limit else f"**{said}**"
