"""The memory that runs need, beside what the program says they will.

``python benchmarks/memory_use.py [--quick] [--json FILE] [--case TEXT] [--jobs N]
[--errors none]``.

Every scene is solved by a solver in a process of its own, on one or two ranks, as
``fenics-contact run`` does it, with error bars where they are made by default. Measured is the
peak of resident memory above that before there is a mesh, of all ranks together. The estimate is
that of ``fenics-contact check``. The exit code is 4 where one of a run above 200 MB is not between
.7 and 1.5 of what was measured.

The last table says by which factor the parts of the estimate would have to change to fit all runs
best: by these the constants of ``fenics_contact/solve/memory.py`` are set.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from cost_cases import FLAT, HALF_SPACE, PAIRS, SMALL_FLAT_PAIR, slab, square
from memory_cases import Seat
from rich.console import Console
from rich.table import Table
from scipy.optimize import nnls

HERE = Path(__file__).resolve().parent
LEAST, MOST = 0.7, 1.5  # of the estimate over what was measured
COUNTS_FROM = 200e6  # bytes

_QUICK = [
    (square(90), "condensed", 1),
    (slab("P2 tets", 24), "condensed", 1),
    (FLAT[0], "condensed", 1),
    (FLAT[2], "iterative", 1),
    (Seat(10), "full", 1),
]
_ALL = [
    *_QUICK,
    (square(180), "condensed", 1),
    (slab("P1 tets", 32), "condensed", 1),
    (slab("P1 tets", 32), "condensed", 2),
    (slab("P2 tets", 32), "condensed", 1),
    (slab("Q2 hexes", 24), "condensed", 1),
    (FLAT[1], "condensed", 1),
    (PAIRS[1], "condensed", 1),
    (PAIRS[3], "condensed", 1),
    (PAIRS[3], "condensed", 2),
    (PAIRS[4], "condensed", 1),
    (SMALL_FLAT_PAIR, "condensed", 1),
    (Seat(10), "condensed", 1),
    (Seat(16), "condensed", 1),
    (square(90), "full", 1),
    (slab("P2 tets", 24), "full", 1),
    (FLAT[0], "full", 1),
    (PAIRS[4], "full", 1),
    (SMALL_FLAT_PAIR, "full", 1),
    (Seat(16), "full", 1),
    (slab("P1 tets", 32), "iterative", 1),
    (slab("P1 tets", 48), "iterative", 1),
    (slab("P1 tets", 48), "iterative", 2),
    (slab("P2 tets", 32), "iterative", 1),
    (HALF_SPACE, "iterative", 1),
    (FLAT[1], "iterative", 1),
    (Seat(10), "iterative", 1),
    (SMALL_FLAT_PAIR, "iterative", 1),
]


def measured(case: str, solver: str, ranks: int, errors: str = "auto") -> dict[str, Any]:
    """A row, from a process of its own."""
    start = [sys.executable] if ranks == 1 else [str(HERE.parent / "bootstrap"), "mpi", str(ranks)]
    command = [*start, str(HERE / "memory_worker.py"), case, solver, errors]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{case} by {solver} failed:\n{done.stderr}")
    row: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return row


def is_right(row: dict[str, Any]) -> bool:
    """Whether an estimate is as near as the project asks for, where it counts."""
    share = row["estimate"] / row["measured"]
    return bool(row["measured"] < COUNTS_FROM or LEAST <= share <= MOST)


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
    chosen = [run for run in (_QUICK if options.quick else _ALL) if options.case in run[0].name]
    rows: list[dict[str, Any]] = []
    with ThreadPoolExecutor(options.jobs) as pool:
        for row in pool.map(lambda run: measured(run[0].name, *run[1:], options.errors), chosen):
            rows.append(row)
            print(f"{row['case']:45} {row['solver']:10} {row['ranks']}", flush=True)
            if options.json:
                options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    print_rows(rows)
    print_fit(rows)
    return 0 if all(is_right(row) for row in rows) else 4


if __name__ == "__main__":
    sys.exit(main())
