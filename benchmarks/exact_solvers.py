"""Run solvers on problems in FCLIB's format: steps, seconds and failures.

``python benchmarks/exact_solvers.py FOLDER [--json FILE] [--sweeps-of 10]``.

The exact solver from the adhesive start on every problem, where failed tries and sweeps count as
steps; semismooth Newton without the rules that keep it from cycling; and Gauss-Seidel alone, to
1e-8 of the forces, on every tenth problem. Residuals are those of the
natural map over the largest force. Ends with 1 where the exact solver fails.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from exact_format import read_problem
from exact_plain import plain_newton
from rich.console import Console
from rich.table import Table

from fenics_contact.solve.exact import LocalProblem, solve
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.sweeps import Sweeps

# Gauss-Seidel ends at a residual below, or after so many sweeps.
SWEEPS_END, MOST_SWEEPS = 1e-8, 2000


def exact(problem: LocalProblem) -> dict[str, Any]:
    """One answer of the exact solver."""
    begun = time.process_time()
    answer = solve(problem)
    return {
        "method": "exact",
        "steps": answer.steps + answer.sweeps,
        "residual": answer.residual,
        "failed": not answer.converged,
        "seconds": time.process_time() - begun,
        "way": answer.way,
    }


def plain(problem: LocalProblem) -> dict[str, Any]:
    """One try of Newton's method, without any rules."""
    begun = time.process_time()
    steps, residual, converged = plain_newton(problem)
    return {
        "method": "plain Newton",
        "steps": steps,
        "residual": residual,
        "failed": not converged,
        "seconds": time.process_time() - begun,
        "way": "",
    }


def gauss_seidel(problem: LocalProblem) -> dict[str, Any]:
    """Sweeps until the residual is small."""
    begun, steps = time.process_time(), 0
    equations = NaturalMap(problem)
    sweeps, forces = Sweeps(equations), np.zeros(len(problem.free))
    residual = np.inf
    while residual > SWEEPS_END and steps < MOST_SWEEPS:
        forces = sweeps.run(forces, 10)
        steps += 10
        state = equations.at(forces)
        scale = equations.scale(state)
        residual = state.error / scale if scale > 0 else state.error
    return {
        "method": "Gauss-Seidel",
        "steps": steps,
        "residual": residual,
        "failed": residual > SWEEPS_END,
        "seconds": time.process_time() - begun,
        "way": "",
    }


def measured(folder: Path, sweeps_of: int) -> Iterator[dict[str, Any]]:
    """A row for each problem and method.

    Args:
        folder: With files of FCLIB's.
        sweeps_of: Gauss-Seidel runs on every so many-th problem.
    """
    for count, path in enumerate(sorted(folder.rglob("*.hdf5"))):
        problem, _, title = read_problem(path)
        known = {"file": path.name, "family": title, "points": problem.points}
        yield known | exact(problem)
        yield known | plain(problem)
        if sweeps_of and count % sweeps_of == 0:
            yield known | gauss_seidel(problem)


def print_rows(rows: list[dict[str, Any]]) -> None:
    """A line for each family and method."""
    groups = defaultdict(list)
    for row in rows:
        groups[row["method"], row["family"]].append(row)
        groups[row["method"], "all"].append(row)
    table = Table(title="Steps, with failed tries and sweeps, and CPU")
    for heading in ("method", "family", "problems", "points", "median", "95 %", "most"):
        table.add_column(heading)
    for heading in ("failed", "largest residual", "ms"):
        table.add_column(heading)
    for (method, family), found in sorted(groups.items()):
        steps = [row["steps"] for row in found]
        residuals = [row["residual"] for row in found if not row["failed"]]
        table.add_row(
            *(method, family, str(len(found)), str(max(row["points"] for row in found))),
            *(f"{np.median(steps):g}", f"{np.percentile(steps, 95):.0f}", str(max(steps))),
            str(sum(row["failed"] for row in found)),
            f"{max(residuals, default=np.nan):.0e}",
            f"{1e3 * np.mean([row['seconds'] for row in found]):.1f}",
        )
    Console(width=140).print(table)


def main() -> int:
    """Run and print; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--sweeps-of", type=int, default=10, metavar="N", help="0: no Gauss-Seidel")
    given = parser.parse_args()
    rows = list(measured(given.folder, given.sweeps_of))
    print_rows(rows)
    if given.json is not None:
        given.json.write_text(json.dumps(rows, indent=1), encoding="utf-8")
    return int(any(row["failed"] for row in rows if row["method"] == "exact"))


if __name__ == "__main__":
    sys.exit(main())
