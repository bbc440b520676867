"""How fine a mesh has to be: ``python docs/make_element_sizes.py [--cells 2,4,8] [--write]``.

Solves Hertz's problem with cells of a/n under the contact, and writes the table of
``docs/howto/element_sizes.md``: from which n on the true errors stay below a bound.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fenics_contact import (
    Contact,
    Discretisation,
    HalfSpace,
    Material,
    MeshSource,
    Obstacle,
    Scene,
    SolverSettings,
    run,
)

DOCS = Path(__file__).resolve().parent
PAGE = DOCS / "howto" / "element_sizes.md"
RADIUS, DEPTH, YOUNGS, POISSON = 8.0, 1.0, 1000.0, 0.3
A = np.sqrt(RADIUS * DEPTH)
MODULUS = YOUNGS / (1 - POISSON**2)
# K. L. Johnson, Contact Mechanics (1985), (4.22)-(4.24).
EXACT = {
    "normal_force": 4 / 3 * MODULUS * np.sqrt(RADIUS) * DEPTH**1.5,
    "max_contact_pressure": 2 / np.pi * MODULUS * np.sqrt(DEPTH / RADIUS),
    "contact_radius": A,
}
ELEMENTS = {
    "P1": ("triangle", 1),
    "Q1": ("quadrilateral", 1),
    "P2": ("triangle", 2),
    "Q2": ("quadrilateral", 2),
}
CELLS = (2, 2.5, 3.2, 4, 5, 6.4, 8, 10, 12.8, 16, 20, 25.6, 32, 40)
BOUNDS = (1e-2, 1e-3)


def errors(element: str, cells: float) -> dict[str, float]:
    """Relative errors with so many cells along the contact radius."""
    cell, degree = ELEMENTS[element]
    scene = Scene(
        kinematics="axisymmetric",
        symmetry=("axis",),
        mesh=(
            MeshSource(
                str(DOCS.parent / "meshes" / "half_space.geo"),
                cell=cell,
                parameters={
                    "fine": 4,
                    "size": A / cells,
                    "extent": 60,
                    "cells_outside": round(1.5 * cells) + 4,
                },
            ),
        ),
        material=(Material(YOUNGS, POISSON),),
        discretisation=Discretisation(degree),
        half_space=HalfSpace(on=("outer",)),
        contact=(Contact("contact", obstacle=Obstacle("paraboloid", radius=8, indentation=1)),),
        solver=SolverSettings(errors="none"),
    )
    found = run(scene).quantities
    return {name: abs(found[name] / exact - 1) for name, exact in EXACT.items()}


def enough(cells: Sequence[float], found: Sequence[float], bound: float) -> str:
    """From how many cells on all errors are within a bound; of more than were tried, a dash."""
    beyond = [number for number, error in enumerate(found) if error > bound]
    first = beyond[-1] + 1 if beyond else 0
    return f"{cells[first]:g}" if first < len(cells) else f"> {cells[-1]:g}"


def table(cells: Sequence[float]) -> str:
    """The page's table."""
    names = ("force", "peak pressure", "radius")
    head = " | ".join(f"{name} to {100 * bound:g} %" for name in names for bound in BOUNDS)
    rows = [f"| cells in the contact radius | {head} |", "|---|" + "---|" * 6]
    for element in ELEMENTS:
        found = [errors(element, count) for count in cells]
        print(element, *zip(cells, (tuple(one.values()) for one in found), strict=True), sep="\n ")
        entries = [
            enough(cells, [one[name] for one in found], bound) for name in EXACT for bound in BOUNDS
        ]
        rows.append(f"| {element} | " + " | ".join(entries) + " |")
    return "\n".join(rows)


def main() -> None:
    """Measure, and print the table or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", help="numbers of cells, separated by commas")
    parser.add_argument("--write", action="store_true", help="into the page")
    options = parser.parse_args()
    cells = tuple(map(float, options.cells.split(","))) if options.cells else CELLS
    made = table(cells)
    print(made)
    if options.write:
        text = PAGE.read_text(encoding="utf-8")
        whole = re.compile(r"\| cells in the contact radius.*?(?=\n\n)", re.S)
        text = whole.sub(lambda _: made, text)
        PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
