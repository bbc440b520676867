"""The same problems by several programs side by side: error against CPU seconds.

``./bootstrap python benchmarks/peers/run.py [PROBLEM …] [--program NAME] [--json FILE] [--page]``

Installs what can be installed freely, each program in an environment of its own, and solves every
problem on every mesh with every setting, the programs by turns, twice, each in a process of its
own with one thread; of two runs the faster one counts. FILE keeps all rows: with a FILE that is
there, it goes on. ``docs/peers.md`` shows them.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[1]))

from environments import MissingError, python_of
from problems import PROBLEMS, problem_named
from programs import PROGRAMS, program_in
from rows import Row, key_of, merged

FOLDER = Path(__file__).resolve().parent
ROOT = FOLDER.parents[1]
MEASURED = FOLDER / "measured.json"
# A run that took longer is not made again, nor are finer meshes than one that took much longer.
_ONCE, _ENOUGH = 20.0, 150.0
_ONE_THREAD = {
    **{f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")},
    "CCX_NPROC_EQUATION_SOLVER": "1",
}


def measured(python: str, name: str, wanted: tuple[str, str, str, int]) -> Row:
    """A row of one run, in a process of its own.

    Args:
        python: That has the program.
        name: Of its file.
        wanted: Problem, program and setting by name, and the level of the mesh.
    """
    problem, program, setting, level = wanted
    command = [python, str(FOLDER / "worker.py"), name, problem, str(level), setting]
    process = subprocess.Popen(
        command,
        cwd=FOLDER,
        env={**os.environ, **_ONE_THREAD},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert process.stdout is not None
    lines = process.stdout.read().strip().splitlines()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    row: Row = {"problem": problem, "program": program, "setting": setting, "level": level}
    row |= {"process_seconds": round(used.ru_utime + used.ru_stime, 4), "runs": 1}
    if process.returncode:
        return row | {"failed": lines[-1] if lines else f"exit code {process.returncode}"}
    return row | json.loads(lines[-1])


class Series:
    """All runs that there are to be, and the rows so far, which a file keeps."""

    def __init__(self, path: Path, problems: list[str], programs: list[str]):
        self.path, self.problems = path, problems
        kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
        self.rows: dict[tuple[Any, ...], Row] = {key_of(row): row for row in kept}
        self.pythons: dict[str, str] = {}
        self.programs = {}
        for name in programs:
            program = program_in(name)
            try:
                self.pythons[name] = python_of(name, program.INSTALL)
            except MissingError as error:
                print(f"{program.NAME} is left out: {error}", flush=True)
                continue
            self.programs[name] = program

    def wanted(self) -> Iterator[tuple[str, tuple[str, str, str, int]]]:
        """File and run, the programs by turns."""
        for name in self.problems:
            for level in problem_named(name).levels:
                for file, program in self.programs.items():
                    for setting in program.SETTINGS.get(name, {}):
                        yield file, (name, program.NAME, setting, level)

    def is_enough(self, run: tuple[str, str, str, int], turn: int) -> bool:
        """Whether this turn of a run can be spared."""
        row = self.rows.get(run)
        if row is not None:
            return row["runs"] >= turn or row["process_seconds"] > _ONCE
        before = [level for level in problem_named(run[0]).levels if level < run[3]]
        coarser = self.rows.get((*run[:3], before[-1])) if before else None
        return coarser is not None and coarser["process_seconds"] > _ENOUGH

    def measure(self, turn: int) -> None:
        """All that have not been made as many times."""
        for file, run in self.wanted():
            if self.is_enough(run, turn):
                continue
            row = measured(self.pythons[file], file, run)
            self.rows[run] = merged(self.rows.get(run), row)
            said = row.get("failed") or f"{row['solve_seconds']:.2f} s"
            print(*run, f"{said}, {row['process_seconds']:.2f} s in all", flush=True)
            text = json.dumps(list(self.rows.values()), indent=1, ensure_ascii=False)
            self.path.write_text(text + "\n", encoding="utf-8")


def main() -> None:
    """Measure, then write the page if asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    known = [problem.name for problem in PROBLEMS]
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=f"of {', '.join(known)}")
    parser.add_argument("--program", action="append", choices=PROGRAMS, help="only these")
    parser.add_argument("--json", type=Path, default=MEASURED, metavar="FILE")
    parser.add_argument("--times", type=int, default=2, help="runs of each; 0: none")
    parser.add_argument("--page", action="store_true", help="write docs/peers.md and its pictures")
    options = parser.parse_args()
    for name in options.problems:
        if name not in known:
            parser.error(f"no problem '{name}'; there are {', '.join(known)}")
    if options.times:
        programs = options.program or list(PROGRAMS)
        series = Series(options.json, options.problems or known, programs)
        for turn in range(1, options.times + 1):
            series.measure(turn)
    if options.page:
        from page import write_page

        write_page(json.loads(options.json.read_text(encoding="utf-8")), ROOT / "docs")


if __name__ == "__main__":
    main()
