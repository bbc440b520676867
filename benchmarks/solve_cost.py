"""What a solve with contact and friction costs, in linear elastic solves on the same mesh.

``python benchmarks/solve_cost.py [--quick] [--json FILE] [--plot DIR] [--case TEXT]``, also under
``mpirun -n N``.

An obstacle, or another block with a rounded foot, is pressed into a block and pulled sideways, so
that a part of the contact sticks and a part slips. Both solves of a row are timed in one process,
with all forms compiled, and each is the least of several: CPU time on one rank, wall time of the
slowest on several. Set ``OMP_NUM_THREADS=1``, as ``./bootstrap`` does. ``docs/solve_cost.md``
shows what came out.

Meshes and scenes are in ``cost_cases.py``, what is timed in ``cost_solves.py``, how a row comes
about in ``cost_measure.py``, the picture in ``cost_plot.py``; tables and command line are here.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from cost_cases import FURTHER, all_runs, quick_runs
from cost_measure import Measured, limit_of, measure
from cost_plot import plot
from mpi4py import MPI
from rich.console import Console
from rich.table import Table

ENOUGH, ENOUGH_QUICKLY = 6.0, 2.5  # seconds of a case


def print_table(found: list[Measured]) -> None:
    """Ratios beside their limits."""
    table = Table(title="What friction costs, in linear solves")
    for heading in ("case", "contact dofs", "solver", "linear", "frictional", "ratio"):
        table.add_column(heading, justify="left" if heading in ("case", "solver") else "right")
    for heading in ("limit", "Newton", "outer", "set-ups", "MB", "linear MB"):
        table.add_column(heading, justify="right")
    for one in found:
        row = one.row
        limit = limit_of(row)
        missed = limit is not None and row["ratio"] > limit
        table.add_row(
            row["case"],
            f"{row['contact_dofs']} ({row['contact_dofs'] / row['dofs']:.1%})",
            row["solver"],
            f"{row['linear_seconds']:.2f} s",
            f"{row['frictional_seconds']:.2f} s",
            f"{row['ratio']:.2f}{' !' if missed else ''}",
            "" if limit is None else f"{limit:g}",
            str(row["newton"]),
            str(row["outer"]),
            str(row["factorisations"] + row["preconditioner_setups"]),
            f"{row['peak_memory_mb']:.0f}",
            f"{one.linear_memory:.0f}",
        )
    Console(width=150).print(table)


def print_further(found: list[Measured]) -> None:
    """What load steps after the first cost, where there are any."""
    several = [one for one in found if one.further is not None]
    if not several:
        return
    table = Table(
        "case", "solver", "a step", "with results", f"{FURTHER} steps", title="Further load steps"
    )
    for one in several:
        assert one.further is not None
        alone, with_results = (seconds / one.row["linear_seconds"] for seconds in one.further)
        table.add_row(
            one.row["case"],
            one.row["solver"],
            f"{alone:.3f}{' !' if alone > 0.1 else ''} linear solves",
            f"{with_results:.3f}",
            f"{FURTHER * alone:.2f}; {FURTHER * with_results:.2f}",
        )
    Console(width=150).print(table)


def main() -> None:
    """Measure, print and, if asked, write and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer meshes: about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    parser.add_argument("--plot", type=Path, metavar="DIR", help="draw, with matplotlib")
    parser.add_argument("--case", default="", metavar="TEXT", help="only those with it in the name")
    options = parser.parse_args()
    comm = MPI.COMM_WORLD
    enough = ENOUGH_QUICKLY if options.quick else ENOUGH
    found = []
    for case, solver in quick_runs() if options.quick else all_runs():
        if options.case not in case.name:
            continue
        found.append(measure(case, solver, comm, enough))
        if comm.rank == 0:
            print(f"{case.name:35} {solver:10} {found[-1].row['ratio']:6.2f}", flush=True)
            if options.json:
                rows = json.dumps([one.row for one in found], indent=2)
                options.json.write_text(rows + "\n", encoding="utf-8")
    if comm.rank > 0:
        return
    print_table(found)
    print_further(found)
    if options.plot:
        options.plot.mkdir(parents=True, exist_ok=True)
        plot([one.row for one in found], options.plot / "solve_cost.png")


if __name__ == "__main__":
    main()
