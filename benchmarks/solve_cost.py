"""What a solve with contact and friction costs, in linear elastic solves on the same mesh.

``python benchmarks/solve_cost.py [--quick] [--json FILE] [--plot DIR] [--page FILE]
[--case TEXT]``, also under ``mpirun -n N``.

An obstacle, or another block with a rounded foot, is pressed into a block and pulled sideways, so
that a part of the contact sticks and a part slips; in *full contact* it is flat, and all of the
face touches. The linear solve is by what is fastest for the case. Both solves of a row are timed in
one process, with all forms compiled, and each is the least of several: CPU time on one rank, wall
time of the slowest on several. Set ``OMP_NUM_THREADS=1``, as ``./bootstrap`` does.
``docs/solve_cost.md`` shows what came out.

Rows with *heat* also have what a run costs with conduction across the contact, in runs without.

Cases are in ``cost_cases.py``, their meshes and scenes in ``verification/memory_worker.py``, what
is timed in ``cost_solves.py``, how a row comes about in ``cost_measure.py``, what heat adds in
``cost_heat.py``, the picture in ``cost_plot.py``, tables of the page in ``cost_page.py``; command
line and the tables of a terminal are here.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from cost_cases import all_runs, quick_runs
from cost_heat import HEAT_CASES, LIMIT_OF_HEAT, QUICK_HEAT_CASES, heat_row
from cost_measure import LIMIT_OF_FURTHER_STEP, limit_of, measure
from cost_page import filled
from cost_plot import plot
from mpi4py import MPI
from rich.console import Console
from rich.table import Table

ENOUGH, ENOUGH_QUICKLY = 6.0, 2.5  # seconds of a case


def print_table(rows: list[dict[str, Any]]) -> None:
    """Ratios beside their limits; what error bars cost, in linear solves, beside."""
    table = Table(title="What friction costs, in linear solves")
    left = ("case", "solver", "linear solver")
    for heading in (*left[:1], "contact dofs", "slips", *left[1:], "linear", "frictional", "ratio"):
        table.add_column(heading, justify="left" if heading in left else "right")
    for heading in ("limit", "errors", "Newton", "outer", "set-ups", "MB", "linear MB"):
        table.add_column(heading, justify="right")
    for row in rows:
        limit = limit_of(row)
        missed = limit is not None and row["ratio"] > limit
        own = "" if row["solver"] == row["solver_chosen"] else f": {row['solver_chosen']}"
        table.add_row(
            row["case"],
            f"{row['contact_dofs']} ({row['contact_dofs'] / row['dofs']:.1%})",
            f"{row['slip_share']:.0%}",
            row["solver"] + own,
            row["linear_solver"],
            f"{row['linear_seconds']:.2f} s",
            f"{row['frictional_seconds']:.2f} s",
            f"{row['ratio']:.2f}{' !' if missed else ''}",
            "" if limit is None else f"{limit:g}",
            f"{row['seconds_errors'] / row['linear_seconds']:.2f}",
            str(row["newton"]),
            str(row["outer"]),
            str(row["factorisations"] + row["preconditioner_setups"]),
            f"{row['peak_memory_mb']:.0f}",
            f"{row['linear_memory_mb']:.0f}",
        )
    Console(width=190).print(table)


def print_further(rows: list[dict[str, Any]]) -> None:
    """What load steps after the first cost, where there are any."""
    several = [row for row in rows if row["steps"] > 1]
    if not several:
        return
    table = Table("case", "solver", "a step", "limit", "with results", title="Further load steps")
    for row in several:
        missed = " !" if row["further_step_ratio"] > LIMIT_OF_FURTHER_STEP else ""
        table.add_row(
            row["case"],
            row["solver"],
            f"{row['further_step_ratio']:.3f}{missed} linear solves",
            f"{LIMIT_OF_FURTHER_STEP:g}",
            f"{row['further_step_ratio_with_results']:.3f}",
        )
    Console(width=150).print(table)


def print_heat(rows: list[dict[str, Any]]) -> None:
    """What conduction costs that follows the pressures, where that was measured."""
    hot = [row for row in rows if "heat_ratio" in row]
    if not hot:
        return
    table = Table("case", "run", "with heat", "ratio", "limit", title="Heat by the pressure")
    for row in hot:
        missed = " !" if row["heat_ratio"] > LIMIT_OF_HEAT else ""
        seconds = (f"{row[key]:.2f} s" for key in ("run_seconds", "heat_run_seconds"))
        table.add_row(row["case"], *seconds, f"{row['heat_ratio']:.2f}{missed}", f"{LIMIT_OF_HEAT}")
    Console(width=150).print(table)


def main() -> None:
    """Measure, print and, if asked, write and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer meshes: about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    parser.add_argument("--plot", type=Path, metavar="DIR", help="draw, with matplotlib")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write its tables anew")
    parser.add_argument("--case", default="", metavar="TEXT", help="only those with it in the name")
    options = parser.parse_args()
    comm = MPI.COMM_WORLD
    enough = ENOUGH_QUICKLY if options.quick else ENOUGH
    rows: list[dict[str, Any]] = []
    runs = [(case, solver, "") for case, solver in (quick_runs() if options.quick else all_runs())]
    hot = QUICK_HEAT_CASES if options.quick else HEAT_CASES
    for case, solver, more in [*runs, *((case, "condensed", ", heat") for case in hot)]:
        name = case.name + more
        if options.case not in name:
            continue
        row = measure(case, solver, comm, enough).row
        rows.append(row | {"case": name} | (heat_row(case, comm, enough) if more else {}))
        if comm.rank == 0:
            ratio = rows[-1].get("heat_ratio", row["ratio"])
            print(f"{name:50} {solver:10} {ratio:6.2f}", flush=True)
            if options.json:
                text = json.dumps(rows, indent=2)
                options.json.write_text(text + "\n", encoding="utf-8")
    if comm.rank > 0:
        return
    print_table(rows)
    print_further(rows)
    print_heat(rows)
    if options.plot:
        options.plot.mkdir(parents=True, exist_ok=True)
        plot(rows, options.plot / "solve_cost.png")
    if options.page:
        page = options.page.read_text(encoding="utf-8")
        options.page.write_text(filled(page, rows), encoding="utf-8")


if __name__ == "__main__":
    main()
