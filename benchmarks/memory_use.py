"""The memory that runs need, beside what the program says they will.

``python benchmarks/memory_use.py [--quick] [--json FILE] [--case TEXT] [--jobs N]
[--errors none]``.

Every scene is solved by a solver in a process of its own, on one or two ranks, as
``fenics-contact run`` does it, with error bars where they are made by default: the scenes, and what
is compared, are those of ``fenics-contact verify memory``, and runs on two ranks besides. The exit
code is 4 where an estimate is not near enough.

The last table says by which factor the parts of the estimate would have to change to fit all runs
best: by these the constants of ``fenics_contact/solve/solver_choice.py`` are set.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.optimize import nnls

from fenics_contact.verification.memory_check import ALL, FEW, compared, measured

BOOTSTRAP = Path(__file__).resolve().parents[1] / "bootstrap"


def measured_on(ranks: int, case: str, solver: str, errors: str) -> dict[str, Any]:
    """A row, from a process of its own or several."""
    start = [sys.executable] if ranks == 1 else [str(BOOTSTRAP), "mpi", str(ranks)]
    return measured(case, solver, errors, start)


def is_right(row: dict[str, Any]) -> bool:
    """Whether an estimate is as near as the project asks for, where it counts."""
    finding = compared(row)
    return finding is None or finding.passed


def print_rows(rows: list[dict[str, Any]]) -> None:
    """Estimates beside what was measured, and their parts."""
    parts = list(dict.fromkeys(name for row in rows for name in row["terms"]))
    table = Table(title="Memory (MB)")
    for heading in ("case", "solver", "ranks", "contact dofs", "measured", "estimate", "ratio"):
        table.add_column(heading, justify="left" if heading in ("case", "solver") else "right")
    for part in parts:
        table.add_column(part, justify="right")
    for row in rows:
        table.add_row(
            row["case"],
            row["solver"],
            str(row["ranks"]),
            str(row["contact_dofs"]),
            f"{row['measured'] / 1e6:.0f}",
            f"{row['estimate'] / 1e6:.0f}",
            f"{row['estimate'] / row['measured']:.2f}{'' if is_right(row) else ' !'}",
            *(f"{row['terms'].get(part, 0.0) / 1e6:.0f}" for part in parts),
        )
    Console(width=190).print(table)


def print_fit(rows: list[dict[str, Any]]) -> None:
    """Factors ≥ 0 of the parts of each solver with the least squares of relative errors."""
    table = Table("solver", "factors of the parts", "ratios", title="What would fit best")
    for solver in sorted({row["solver"] for row in rows}):
        own = [row for row in rows if row["solver"] == solver]
        parts = list(dict.fromkeys(p for row in own for p, size in row["terms"].items() if size))
        shares = [[row["terms"].get(p, 0.0) / row["measured"] for p in parts] for row in own]
        matrix = np.array(shares)
        factors, _ = nnls(matrix, np.ones(len(own)))
        ratios = matrix @ factors
        said = ", ".join(f"{p} {factor:.2f}" for p, factor in zip(parts, factors, strict=True))
        table.add_row(solver, said, f"{ratios.min():.2f} to {ratios.max():.2f}")
    Console(width=190).print(table)


def main() -> int:
    """Measure, print and, if asked, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer scenes: about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    parser.add_argument("--case", default="", metavar="TEXT", help="only those with it in the name")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="so many runs at once")
    parser.add_argument("--errors", default="auto", metavar="none", help="without error bars")
    options = parser.parse_args()
    chosen = [run for run in (FEW if options.quick else ALL) if options.case in run[0].name]
    rows: list[dict[str, Any]] = []
    with ThreadPoolExecutor(options.jobs) as pool:
        found = pool.map(
            lambda run: measured_on(run[2], run[0].name, run[1], options.errors), chosen
        )
        for row in found:
            rows.append(row)
            print(f"{row['case']:45} {row['solver']:10} {row['ranks']}", flush=True)
            if options.json:
                options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    print_rows(rows)
    print_fit(rows)
    return 0 if all(is_right(row) for row in rows) else 4


if __name__ == "__main__":
    sys.exit(main())
