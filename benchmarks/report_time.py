"""Seconds that the report of a run in space takes, by phase, beside those of its solution.

A rigid sphere on a quarter of a half-space, with friction, hexahedra of degree 2: 107,811 dofs, or
with --quick 14,739. ``python benchmarks/report_time.py [--quick] [--json FILE] [--keep DIR]``
"""

import argparse
import json
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fenics_contact import Contact, HalfSpace, Material, MeshSource, Obstacle, Run, Scene
from fenics_contact.report import report
from fenics_contact.simulation.output import run_folder as files

ROOT = Path(__file__).resolve().parent.parent
CELLS = {False: (8, 8), True: (4, 4)}  # along a side of the fine cube, and outside of it
# What the report consists of: functions of its module → phase.
PHASES = {
    "whole_body": "read",
    "make_view": "view",
    "view_html": "view",
    "draw_pictures": "pictures",
    "page": "page",
}


def scene(quick: bool) -> Scene:
    """The contact's radius is 1."""
    fine, outside = CELLS[quick]
    parameters = {"fine": 1.6, "size": 1.6 / fine, "extent": 10, "cells_outside": outside}
    return Scene(
        title="Sphere on a quarter of a half-space",
        kinematics="3D",
        mesh=MeshSource(
            str(ROOT / "meshes" / "quarter_space.geo"), parameters={**parameters, "hexahedra": 1}
        ),
        material=Material(1000, 0.3),
        symmetry=("symmetry_x", "symmetry_y"),
        half_space=HalfSpace(on=("outer",)),
        contact=(
            Contact(
                "contact",
                obstacle=Obstacle("paraboloid", 50, indentation=0.02),
                friction_coefficient=0.2,
            ),
        ),
    )


def timed(seconds: dict[str, float], phase: str, action: Callable[..., Any]) -> Callable[..., Any]:
    """An action whose seconds are added to those of a phase."""

    def measured(*arguments: Any) -> Any:
        started = time.perf_counter()
        try:
            return action(*arguments)
        finally:
            seconds[phase] = seconds.get(phase, 0.0) + time.perf_counter() - started

    return measured


def measure(folder: Path, quick: bool) -> dict[str, Any]:
    """Solve into a folder, and write its report."""
    started = time.perf_counter()
    result = files.solve_and_write(Run(scene(quick)), folder)
    solved = time.perf_counter() - started
    seconds: dict[str, float] = {}
    for name, phase in PHASES.items():
        setattr(report, name, timed(seconds, phase, getattr(report, name)))
    started, begun = time.perf_counter(), time.process_time()
    report.write_report(folder)
    page = folder / report.PAGE
    total, own = time.perf_counter() - started, time.process_time() - begun
    return {
        "dofs": result.model["dofs"],
        "passed": result.passed,
        "solve_seconds": solved,
        "report_seconds": total,
        "report_cpu_seconds": own,  # on a machine that others use, too, the better measure
        **{f"{phase}_seconds": value for phase, value in seconds.items()},
        "ratio": total / solved,
        "page_mb": page.stat().st_size / 1e6,
        "view_mb": len(page.read_text(encoding="utf-8").split('id="view-data">')[1].split("<")[0])
        / 1e6,
    }


def main() -> None:
    """Measure and print; 20 s for 100,000 dofs is what the project asks of itself."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--keep", type=Path, help="folder of the run, by default thrown away")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        row = measure(options.keep or Path(folder), options.quick)
    for name, value in row.items():
        print(f"{name:18} {value:.4g}" if isinstance(value, float) else f"{name:18} {value}")
    if options.json:
        options.json.write_text(json.dumps([row], indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
