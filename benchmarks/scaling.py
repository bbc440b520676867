"""How runs by multigrid grow with the body and with the ranks, and what larger ones would take.

``python benchmarks/scaling.py --json FILE [--quick] [--page FILE]``

Every row is a run of ``large_block.toml`` as a user makes it, mesh and files included, in
processes of their own. Rows that the file of ``--json`` has already are kept, so that a long
benchmark can be interrupted and goes on. Half an hour where nothing else runs: wall times count.
``--page`` writes the tables of a page anew that has marks for them.

What is measured in a run is in ``scaling_worker.py``, what larger runs would take in
``scaling_forecast.py``.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from page_tables import filled, markdown
from scaling_forecast import Forecast

Row = dict[str, Any]
HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
# Cells along an edge, ranks, what presses: of a strong series two rows with the same cells, of a
# weak one rows with twice the unknowns on twice the ranks.
QUICK = [(8, 1, "punch"), (8, 2, "punch"), (10, 1, "punch"), (10, 2, "punch")]
RUNS = [
    (12, 1, "punch"),
    (16, 1, "punch"),
    (16, 2, "punch"),
    (20, 1, "punch"),
    (20, 2, "punch"),
    (25, 1, "punch"),
    (25, 2, "punch"),
    (32, 1, "punch"),
    (32, 2, "punch"),
    (40, 1, "punch"),
    (40, 2, "punch"),
    (20, 1, "plane"),
    (25, 1, "plane"),
    (25, 2, "plane"),
]
# The larger run that is foretold: cells along an edge, and ranks.
FORETOLD = 74, 64


def measured(cells: int, ranks: int, place: str) -> Row:
    """A row, from processes of its own."""
    start = [str(ROOT / "bootstrap"), *(["python"] if ranks == 1 else ["mpi", str(ranks)])]
    command = [*start, str(HERE / "scaling_worker.py"), str(cells), place]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{cells} cells on {ranks} ranks failed:\n{done.stderr}")
    row: Row = json.loads(done.stdout.splitlines()[-1])
    return row


def tables_of(rows: list[Row]) -> dict[str, str]:
    """The tables of the page, by name."""
    of_punch = [row for row in rows if row["place"] == "punch"]
    forecast = Forecast(of_punch, *FORETOLD)
    return {
        "runs": _runs(rows),
        "strong": _compared(of_punch, is_strong=True),
        "weak": _compared(of_punch, is_strong=False),
        "forecast": markdown(*forecast.table()),
        "ranks": markdown(*forecast.by_ranks()),
    }


def _runs(rows: list[Row]) -> str:
    headings = ["unknowns", "of them at the contact's face", "pressed by", "ranks", "mesh"]
    headings += ["K", "multigrid's set-up", "solve", "files", "wall", "CPU", "Newton steps"]
    headings += ["V-cycles", "memory of each rank"]
    cells = []
    for row in rows:
        seconds = row["seconds"]
        phases = ("mesh", "assemble", "factorise", "solve", "output", "total")
        cells.append(
            [
                f"{row['dofs']:,}",
                f"{row['contact_dofs']:,}",
                row["place"],
                str(row["ranks"]),
                *(f"{seconds[name]:.3g} s" for name in phases),
                f"{row['cpu_seconds']:.3g} s",
                str(row["newton"]),
                str(row["calls"]["V-cycles"]),
                " and ".join(f"{peak / 1e9:.2f}" for peak in row["peak_bytes"]) + " GB",
            ]
        )
    return markdown(headings, cells)


def _compared(rows: list[Row], is_strong: bool) -> str:
    """Rows on one rank beside those on two: of one body, or of one of twice the unknowns."""
    headings = ["unknowns on one rank", "on two", "wall on one rank", "on two", "efficiency"]
    headings += ["of a V-cycle", "of the set-up", "memory of a rank"]
    cells = []
    for one in (row for row in rows if row["ranks"] == 1):
        for two in (row for row in rows if row["ranks"] == 2):
            growth = two["dofs"] / one["dofs"]
            if not (growth == 1 if is_strong else 1.8 < growth < 2.2):
                continue
            shares = [
                growth * of_one / (2 * of_two)
                for of_one, of_two in (
                    (one["seconds"]["total"], two["seconds"]["total"]),
                    (_cycle(one), _cycle(two)),
                    (one["seconds"]["factorise"], two["seconds"]["factorise"]),
                )
            ]
            cells.append(
                [
                    f"{one['dofs']:,}",
                    f"{two['dofs']:,}",
                    f"{one['seconds']['total']:.3g} s",
                    f"{two['seconds']['total']:.3g} s",
                    *(f"{share:.0%}" for share in shares),
                    f"{max(two['peak_bytes']) / one['peak_bytes'][0]:.2f} of that on one",
                ]
            )
    return markdown(headings, cells)


def _cycle(row: Row) -> float:
    return float(row["parts"]["V-cycles"] / row["calls"]["V-cycles"])


def main() -> None:
    """Measure what is missing, and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, metavar="FILE", required=True, help="all rows")
    parser.add_argument("--quick", action="store_true", help="small bodies: about a minute")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write its tables anew")
    options = parser.parse_args()
    file = options.json
    rows: list[Row] = json.loads(file.read_text(encoding="utf-8")) if file.exists() else []
    known = {(row["cells"], row["ranks"], row["place"]) for row in rows}
    for run in QUICK if options.quick else RUNS:
        if run in known:
            continue
        rows.append(measured(*run))
        file.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
        print(f"{run}: {rows[-1]['seconds']['total']:.1f} s", file=sys.stderr, flush=True)
    tables = tables_of(sorted(rows, key=lambda row: (row["place"] != "punch", row["dofs"])))
    for name, table in tables.items():
        print(f"\n{name}\n\n{table}")
    if options.page:
        page = options.page.read_text(encoding="utf-8")
        options.page.write_text(filled(page, tables), encoding="utf-8")


if __name__ == "__main__":
    main()
