"""What averaging the pressure does to Coulomb's friction: the table of docs/nonlocal_friction.md.

A flat rigid punch on an elastic block, on finer and finer meshes: the pressure grows without a
bound at its edges. With Coulomb's law (ρ = 0) friction follows it; with a radius ρ it does not. The
punch is pressed down, and pressed and moved so far along that all of it slides.

    ./bootstrap python benchmarks/nonlocal_study.py [--quick] [--table FILE]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    NonlocalFriction,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.common.atomic_files import replace_file
from fenics_contact.verification.boxes import Box, boxes

RADII = (0.0, 0.1, 0.3, 1.0)
CELLS = (8, 16, 32, 64)
MODULUS, RATIO, INDENTATION = 1000.0, 0.3, 0.01
# Pressed, and sliding: where friction does much to the pressure, the loop on it is put to the test.
COEFFICIENT = {False: 0.3, True: 1.0}
SIDEWAYS = {False: 0.0, True: 0.1}


def scene(radius: float, slides: bool) -> Scene:
    """The punch, of half-width 1, on a block of half-width 3 and depth 2; half of it if pressed."""
    law = NonlocalFriction(kind="nonlocal", averaging_radius=radius) if radius else None
    punch = Obstacle(
        "flat punch",
        radius=1.0,
        position=(0.0, 0.0),
        normal=(0, -1),
        indentation=INDENTATION,
        displacement=(SIDEWAYS[slides], 0.0),
    )
    return Scene(
        kinematics="plane strain",
        material=Material(MODULUS, RATIO),
        discretisation=Discretisation(2),
        symmetry=() if slides else ("block.x0",),
        support=(Support("block.y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "block.y1",
                obstacle=punch,
                friction_coefficient=COEFFICIENT[slides],
                friction_law=law,
            ),
        ),
        solver=SolverSettings(strategy="lagged", errors="none"),
    )


def rows(cells: tuple[int, ...], slides: bool) -> Iterator[tuple[float, int, dict[str, float]]]:
    """Radius, cells on the punch's half-width, and what was found there."""
    left = -3.0 if slides else 0.0
    for radius in RADII:
        for count in cells:
            across = (6 if slides else 3) * count
            block = Box("block", (left, -2.0), (3.0, 0.0), (across, count))
            run = Run(scene(radius, slides), MPI.COMM_SELF, boxes((block,), comm=MPI.COMM_SELF))
            result = run.solve()
            if not result.passed:
                raise SystemExit(f"ρ = {radius}, {count} cells: {result.verdict}")
            traction = np.abs(run.solution.states[0].friction_traction).max()
            mean = result.quantities["normal_force"] / (2.0 if slides else 1.0)
            yield (
                radius,
                count,
                {
                    "peak pressure": result.quantities["max_contact_pressure"] / mean,
                    "peak traction": float(traction) / (COEFFICIENT[slides] * mean),
                    "slip": result.quantities["slip_area"] / result.quantities["contact_area"],
                    "contraction": run.solution.contraction or 0.0,
                    "limit": result.contacts[0].uniqueness_limit or np.nan,
                },
            )


def table(found: Iterator[tuple[float, int, dict[str, float]]]) -> str:
    """In Markdown."""
    lines = [
        "| ρ | cells | peak pressure / p̄ | peak traction / μp̄ | share that slips "
        "| contraction | limit of uniqueness |",
        "|---|---|---|---|---|---|---|",
    ]
    for radius, count, values in found:
        shown = " | ".join(f"{value:.3g}" for value in values.values())
        lines.append(f"| {radius:g} | {count} | {shown} |")
        print(lines[-1], flush=True)
    return "\n".join(lines) + "\n"


def main() -> None:
    """Solve, print and write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="the two coarsest meshes only")
    parser.add_argument("--table", type=Path, help="file to write the table to")
    arguments = parser.parse_args()
    cells = CELLS[:2] if arguments.quick else CELLS
    parts = [("Pressed", False, cells), ("Sliding", True, cells[:-1])]
    text = ""
    for title, slides, meshes in parts:
        heading = f"{title}, μ = {COEFFICIENT[slides]:g}:"
        print(heading)
        text += f"{heading}\n\n{table(rows(meshes, slides))}\n"
    if arguments.table is not None:
        replace_file(arguments.table, text.encode())


if __name__ == "__main__":
    main()
