"""CPU seconds, user and system, of the commands that are to start fast, from warm caches.

Each is the least of several runs of a process of its own with all that it starts (Gmsh),
interleaved, since machines are shared. Beside them stands what ``import dolfinx`` takes, which no
run can do without. ``python benchmarks/start_up.py [--repeat N] [--json FILE]``
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = [sys.executable, "-m", "fenics_contact"]
SLAB = [*PROGRAM, "run", str(ROOT / "demos" / "slab.toml"), "--out"]
# What the project asks of itself (s); of what is given, nothing.
LIMITS = {"import dolfinx": None, "--help": 0.3, "--version": 0.3, "run demos/slab.toml": 1.4}


def commands(folder: str) -> dict[str, list[str]]:
    """Those of ``LIMITS``; results go to a folder."""
    # mpi4py first: without ./bootstrap, dolfinx of the wheel does not find MPI by itself
    given = [sys.executable, "-c", "from mpi4py import MPI; import dolfinx"]
    words = ([*PROGRAM, "--help"], [*PROGRAM, "--version"], [*SLAB, folder])
    return dict(zip(LIMITS, (given, *words), strict=True))


def cpu_seconds(command: list[str]) -> float:
    """Of a process and those that it waited for."""
    # compiled Python is kept, as it is where the program is installed
    surroundings = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    surroundings["PYTHONPATH"] = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    quiet = {"stdin": subprocess.DEVNULL, "capture_output": True}
    before = os.times()
    subprocess.run(command, check=True, env=surroundings, **quiet)
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        every = commands(folder)
        for command in every.values():
            cpu_seconds(command)  # fills the caches, of compiled forms and of Python
        rounds = [{name: cpu_seconds(every[name]) for name in every} for _ in range(options.repeat)]
    rows = [
        {"command": name, "cpu_seconds": min(one[name] for one in rounds), "limit": limit}
        for name, limit in LIMITS.items()
    ]
    for row in rows:
        limit = "" if row["limit"] is None else f" (at most {row['limit']:g} s)"
        print(f"{row['command']}: {row['cpu_seconds']:.2f} s of CPU{limit}")
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
