"""What assemblies of solids cost: bolts, fits, and parts that friction alone holds.

``python benchmarks/assemblies.py [--quick] [--large] [--json FILE] [--case TEXT] [--errors none]
[--seconds N] [--calculix]``.

Each case of ``assembly_scenes.py`` is solved in a process of its own, with error bars where they
are made by default. Its seconds are of the processor, with the mesh and the compilation of forms
that no run before it had; its memory is the peak of the process. Of the contact dofs there are
those that take part at the end beside all of the contact surfaces, and of the Newton steps those of
each load step. With ``--large`` flanges of up to 300,000 unknowns are solved without forming their
stiffness between jumps, and without error bars; the exit code is 4 where the estimate of memory is
off by more than a fifth of what a run took above the program at rest. With ``--calculix`` three
scenes without bolts are solved by ``ccx``, too, on the same cells, with several settings of its
contacts (``assembly_calculix.py``).
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from assembly_scenes import BESIDE, CASES, LARGE, QUICK, Case
from rich.console import Console
from rich.table import Table

from fenics_contact import Run

# So long a process may take (s), for a case is to be solved in 3 minutes.
SECONDS = 600.0
# Characters of a verdict that are printed.
LONGEST = 160
# Of an estimate of memory over what was measured, that is near enough.
NEAR = 0.2


def measure(case: Case, errors: str) -> dict[str, Any]:
    """A row: the case solved in this process."""
    from dataclasses import replace

    from fenics_contact import FenicsContactError
    from fenics_contact.solve import solver_choice
    from fenics_contact.solve.condensed.condensed_system import CondensedSystem

    sizes: list[int] = []
    take_body = CondensedSystem._take_body

    def counted(system: CondensedSystem, body: Any) -> None:
        take_body(system, body)
        sizes.append(len(system.dofs.numbers))

    CondensedSystem._take_body = counted  # type: ignore[method-assign]
    if case.applies:
        solver_choice._MOST_JUMPS = 0
    before = resident_mb("VmRSS")
    started, scene = time.process_time(), case.make()
    scene = replace(scene, solver=replace(scene.solver, errors=errors))
    row: dict[str, Any] = {"case": case.name}
    try:
        run = Run(scene)
        row |= {"dofs": 3 * run.problem.spaces.displacement_space.dofmap.index_map.size_global}
        row |= {"contact_dofs": solver_choice.contact_unknowns(run.problem)}
        row |= {"estimate_mb": run.choice.memory / 1e6}
        result = run.solve()
        row |= {"solver": result.model.solver, "exit_code": result.exit_code}
        row |= {"newton": [step.newton_iterations for step in result.steps]}
        row |= {"words": result.verdict}
        row |= {"moved": moved(run)}
    except FenicsContactError as error:
        row |= {"exit_code": error.exit_code, "words": f"{type(error).__name__}: {error}"}
    peak = resident_mb("VmHWM")
    return row | {
        "present_dofs": sizes,
        "seconds": time.process_time() - started,
        "peak_memory_mb": peak,
        "own_memory_mb": peak - before,
    }


def resident_mb(key: str) -> float:
    """Memory of this process (MB): ``VmRSS`` now, ``VmHWM`` at the peak."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return 1.024e-3 * int(re.search(rf"{key}:\s+(\d+)", status)[1])  # type: ignore[index]


def moved(run: Run) -> float:
    """How far the surface of the last load has moved, as the mean of its nodes (length)."""
    assert run.solution is not None
    spaces, name = run.problem.spaces, run.scene.load[-1].on
    nodes = spaces.nodes(spaces.body.groups[name])
    return float(np.linalg.norm(run.solution.displacement[nodes].mean(axis=0)))


def measured(case: Case, errors: str, seconds: float) -> dict[str, Any]:
    """The same in a process of its own."""
    command = [sys.executable, __file__, "--alone", case.name, "--errors", errors]
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, timeout=seconds, check=True)
    except subprocess.TimeoutExpired:
        return {"case": case.name, "exit_code": None, "words": f"not solved in {seconds:g} s"}
    except subprocess.CalledProcessError as error:
        return {"case": case.name, "exit_code": error.returncode, "words": "crashed"}
    row: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return row


def measured_by_calculix(case: Case, seconds: float) -> Iterator[dict[str, Any]]:
    """Rows of the same scene by CalculiX, one for each setting."""
    from assembly_calculix import SETTINGS
    from assembly_calculix import measure as by_calculix

    scene = case.make()
    for setting in SETTINGS:
        found = by_calculix(scene, setting, seconds)
        failed = found.pop("failed", None)
        yield found | {
            "case": case.name,
            "solver": "CalculiX",
            "newton": [found["newton"]],
            "exit_code": 0 if failed is None else 4,
            "words": found["setting"] + ("" if failed is None else f": {failed}"),
        }


def shortened(words: str) -> str:
    """The first sentence of a verdict, or the beginning of a long one."""
    first = re.split(r"(?<=[a-z])[.;] ", words)[0]
    return first if len(first) <= LONGEST else first[:LONGEST] + " …"


def print_rows(rows: list[dict[str, Any]]) -> None:
    """Sizes, costs and verdicts of all cases."""
    table = Table(title="Assemblies of solids")
    for heading in ("case", "unknowns", "contact dofs", "solver", "Newton steps", "CPU", "memory"):
        table.add_column(heading, justify="left" if heading in ("case", "solver") else "right")
    table.add_column("its own; estimate (MB)", justify="right")
    table.add_column("moved", justify="right")
    table.add_column("exit")
    table.add_column("verdict", max_width=50)
    for row in rows:
        present = row.get("present_dofs") or [""]
        table.add_row(
            row["case"],
            f"{row.get('dofs', 0):,}",
            f"{present[-1]} of {row.get('contact_dofs', '')}",
            row.get("solver", ""),
            "; ".join(map(str, row.get("newton", []))),
            f"{row.get('seconds', float('nan')):.1f} s",
            f"{row.get('peak_memory_mb', float('nan')):.0f} MB",
            "; ".join(
                f"{row.get(key, float('nan')):.0f}" for key in ("own_memory_mb", "estimate_mb")
            ),
            f"{row['moved']:.4g}" if "moved" in row else "",
            str(row["exit_code"]),
            shortened(row["words"]),
        )
    Console(width=190).print(table)


def is_foreseen(row: dict[str, Any]) -> bool:
    """Whether the estimate of memory is near what a run took."""
    return abs(row.get("estimate_mb", np.inf) / row.get("own_memory_mb", 1.0) - 1) <= NEAR


def main() -> int:
    """Measure, print and, if asked, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="coarser meshes: about a minute")
    parser.add_argument("--large", action="store_true", help="contacts without S, and memory")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    parser.add_argument("--case", default="", metavar="TEXT", help="only those with it in the name")
    parser.add_argument("--errors", default="auto", metavar="none", help="without error bars")
    parser.add_argument("--seconds", type=float, default=SECONDS, metavar="N", help="of each case")
    parser.add_argument("--calculix", action="store_true", help="others beside ccx")
    parser.add_argument("--alone", default="", metavar="CASE", help="a row as JSON: for processes")
    options = parser.parse_args()
    if options.alone:
        every = (*CASES, *QUICK, *LARGE, *BESIDE)
        (case,) = [case for case in every if case.name == options.alone]
        print(json.dumps(measure(case, options.errors)))
        return 0
    rows: list[dict[str, Any]] = []
    plain = LARGE if options.large else QUICK if options.quick else CASES
    errors = "none" if options.large else options.errors
    for case in BESIDE if options.calculix else plain:
        if options.case not in case.name:
            continue
        beside = measured_by_calculix(case, options.seconds) if options.calculix else ()
        for row in chain([measured(case, errors, options.seconds)], beside):
            rows.append(row)
            words = f"{row.get('seconds', 0):6.1f} s  exit {row['exit_code']}"
            print(f"{case.name:30} {row.get('solver', ''):10} {words}", flush=True)
            if options.json:
                options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    print_rows(rows)
    own = [row for row in rows if row.get("solver") != "CalculiX"]
    if options.large:  # on coarse cells what is resolved is not asked
        return 0 if all(is_foreseen(row) for row in own) else 4
    return 0 if all(row["exit_code"] == 0 for row in own) else 4


if __name__ == "__main__":
    sys.exit(main())
