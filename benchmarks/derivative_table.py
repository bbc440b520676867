"""Derivatives of quantities by numbers of thirty scenes, beside central differences of whole runs.

``python benchmarks/derivative_table.py [NAME …] [--json FILE]``; on two ranks
``./bootstrap mpi 2 benchmarks/derivative_table.py``.

All laws, drivers and dimensions on small meshes, with automatic parameters given as they are
chosen. A derivative may be off by 1e-6 of itself, by what rounding leaves of the differences, or by
three times their scatter over two steps. Ends with 1 where one is further off.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

# The table stands with the tests, which run a part of it.
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from mpi4py import MPI
from rich.console import Console
from rich.table import Table

import fenics_contact  # noqa: F401  # loads what dolfinx needs
from tests.simulation.sensitivities.scenes import TABLE
from tests.simulation.sensitivities.table import errors, study_of

COMM = MPI.COMM_WORLD


def row_of(name: str) -> dict[str, Any]:
    """What was compared in a scene, and the pair that is furthest off; collective.

    Args:
        name: Of the scene in the table.
    """
    begun = time.process_time()
    found = errors(study_of(name), TABLE[name].of, TABLE[name].by)
    worst = max(found, key=lambda pair: found[pair])
    return {
        "scene": name,
        "ranks": COMM.size,
        "pairs": len(found),
        "largest": float(found[worst]),
        "quantity": worst[0],
        "key": worst[1],
        "seconds": time.process_time() - begun,
    }


def print_table(rows: list[dict[str, Any]]) -> None:
    """Errors over what is allowed."""
    table = Table(title="Derivatives by the adjoint less central differences, over what is allowed")
    for heading in ("scene", "pairs", "largest", "of", "by", "CPU s"):
        table.add_column(heading)
    for row in rows:
        table.add_row(
            row["scene"],
            str(row["pairs"]),
            f"{row['largest']:.2f}{' !' if row['largest'] > 1 else ''}",
            row["quantity"],
            row["key"],
            f"{row['seconds']:.1f}",
        )
    console = Console(width=160)
    console.print(table)
    console.print(f"{len(rows)} scenes, {sum(row['pairs'] for row in rows)} pairs")


def main() -> None:
    """Compare, print and, if asked, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "names", nargs="*", choices=[*TABLE, []], metavar="NAME", help="by default all"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    options = parser.parse_args()
    rows = []
    for name in options.names or TABLE:
        rows.append(row_of(name))
        if COMM.rank == 0:
            print(f"{name}: {rows[-1]['largest']:.2f} of what is allowed", flush=True)
    if COMM.rank == 0:
        print_table(rows)
        if options.json:
            options.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    sys.exit(any(row["largest"] > 1 for row in rows))


if __name__ == "__main__":
    main()
