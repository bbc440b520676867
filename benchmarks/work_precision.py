"""Error against time, for the paper's slab and for Hertz's contact, by element and mesh.

``python benchmarks/work_precision.py [--quick] [--json FILE] [--plot DIR]``

Seconds are those of one process with all forms compiled: mesh, assembly, set-up and solve,
without compilation and output, the least of several runs. Errors are those of the
discretisation alone: the references are of the same domain. ``docs/benchmarks.md`` shows them.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from fenics_contact import Discretisation, Obstacle, Result, Scene
from fenics_contact.figures import new_figure, save
from fenics_contact.verification.case import solved
from fenics_contact.verification.point_cases import contact_radius, half_space_scene
from fenics_contact.verification.slab_cases import slab_scene

ELEMENTS = {
    "P1": ("triangle", 1),
    "Q1": ("quadrilateral", 1),
    "P2": ("triangle", 2),
    "Q2": ("quadrilateral", 2),
}

# Hertz: a paraboloid (R = 8, d = 1, so a ≈ 2.83) on a square of side 12 that stands for a
# half-space. Contact is possible on the first 4, in a square of uniform cells of side h. From
# there on 8/h more, about as small, are "uniform"; 2/h that grow geometrically are "graded".
EXTENT, FINE = 12.0, 4.0
OUTSIDE = {"uniform": 8.0, "graded": 2.0}

# Hertz: Q2 graded at h = 1/32 and 1/48, which agree to 1e-5 in force and peak. They are .17 %
# and .08 % below the formulas of the half-space, which is the domain's error. The radius is
# that of an ellipsoid of pressure with this force and peak, F = 2/3 π a² p₀.
# Slab: Q2 512 × 64; the energy extrapolated at second order from 256 × 32 and 512 × 64.
REFERENCES = {
    "hertz": {"normal_force": 4137.01, "max_contact_pressure": 247.140},
    "slab": {"friction_force": 209.9750961, "strain_energy": 352.713039},
}
REFERENCES["hertz"]["contact_radius"] = math.sqrt(
    1.5 * REFERENCES["hertz"]["normal_force"] / math.pi
    / REFERENCES["hertz"]["max_contact_pressure"]
)  # fmt: skip

COLOURS = {"P1": "#c0392b", "Q1": "#e67e22", "P2": "#2e86c1", "Q2": "#1b2631"}
MARKERS = {"P1": "^", "Q1": "s", "P2": "v", "Q2": "o"}
TARGETS = (1e-2, 1e-3)


def hertz(element: str, mesh: str, size: float) -> Scene:
    """Hertz's contact with cells of a given size in it."""
    extra = 1 if mesh == "uniform" else 0  # the geometry's ratio becomes 1 with one more
    scene = half_space_scene(
        Obstacle("paraboloid", radius=8, indentation=1),
        extent=EXTENT,
        fine=FINE,
        size=size,
        cells_outside=round(OUTSIDE[mesh] / size) + extra,
    )
    return of_element(scene, element)


def slab(element: str, size: float) -> Scene:
    """Example 1 with cells of a given size: 8 by 1."""
    return of_element(slab_scene(cells=(round(8 / size), round(1 / size))), element)


def of_element(scene: Scene, element: str) -> Scene:
    """The same scene with other elements."""
    cell, degree = ELEMENTS[element]
    assert scene.mesh is not None
    return dataclasses.replace(
        scene,
        mesh=dataclasses.replace(scene.mesh, cell=cell),
        discretisation=Discretisation(degree),
    )


def series(quick: bool) -> list[tuple[str, str, list[Scene]]]:
    """Case, method and scenes from coarse to fine; degree 1 goes one further, like its cost."""
    found = []
    for element, (_, degree) in ELEMENTS.items():
        finer = 1 if degree == 1 else 0
        levels = (4 if quick else 5) + finer
        found.append(
            ("slab", f"{element} uniform", [slab(element, 0.5**i) for i in range(1, levels)])
        )
        for mesh in ("uniform", "graded"):
            levels = (3 if quick else 4) + finer + (mesh == "graded")
            scenes = [hertz(element, mesh, 0.5**i) for i in range(levels)]
            found.append(("hertz", f"{element} {mesh}", scenes))
    return found


def quantities(case: str, result: Result) -> dict[str, float]:
    """Those of ``REFERENCES``."""
    found = result.quantities
    if case == "slab":
        return {
            "friction_force": found["friction_force"][0],
            "strain_energy": found["strain_energy"],
        }
    return {
        "normal_force": found["normal_force"],
        "max_contact_pressure": found["max_contact_pressure"],
        "contact_radius": contact_radius(result),
    }


def measured(case: str, method: str, scene: Scene, repeat: int) -> list[dict[str, Any]]:
    """A row a quantity, with the least time of several runs."""
    results = [solved(scene) for _ in range(repeat)]
    seconds = min(
        result.timings["total"] - result.timings["compile"] - result.timings["output"]
        for result in results
    )
    rows = []
    for quantity, value in quantities(case, results[0]).items():
        reference = REFERENCES[case][quantity]
        rows.append(
            {
                "case": case,
                "method": method,
                "dofs": results[0].model["dofs"],
                "seconds": seconds,
                "quantity": quantity,
                "value": value,
                "reference": reference,
                "error": abs(value / reference - 1),
                "estimated_error": None,
            }
        )
    return rows


def reached(rows: list[dict[str, Any]], target: float) -> str:
    """Seconds and dofs from which on the error of a series stays within a target."""
    first = len(rows)
    while first > 0 and rows[first - 1]["error"] <= target:
        first -= 1
    if first == len(rows):
        return "-"
    return f"{rows[first]['seconds']:.2f} s, {rows[first]['dofs']}"


def select(rows: list[dict[str, Any]], **keys: str) -> list[dict[str, Any]]:
    """Rows with given entries."""
    return [row for row in rows if all(row[key] == value for key, value in keys.items())]


def print_table(rows: list[dict[str, Any]]) -> None:
    """What every method takes to the targets."""
    table = Table("case", "quantity", "method", *(f"to {target:.1%}" for target in TARGETS))
    for case, references in REFERENCES.items():
        for quantity in references:
            chosen = select(rows, case=case, quantity=quantity)
            for method in dict.fromkeys(row["method"] for row in chosen):
                one = select(chosen, method=method)
                table.add_row(case, quantity, method, *(reached(one, t) for t in TARGETS))
    Console().print(table)


def plot(rows: list[dict[str, Any]], case: str, title: str, path: Path) -> None:
    """A panel a quantity: error against seconds."""
    from matplotlib.ticker import LogLocator

    names = list(REFERENCES[case])
    figure, panels = new_figure(title, (3.6 * len(names), 4.4), ncols=len(names), sharey=True)
    for panel, quantity in zip(panels, names, strict=True):
        chosen = select(rows, case=case, quantity=quantity)
        for method in dict.fromkeys(row["method"] for row in chosen):
            element, mesh = method.split()
            graded = mesh == "graded"
            one = select(chosen, method=method)
            panel.loglog(
                [row["seconds"] for row in one],
                [row["error"] for row in one],
                color=COLOURS[element],
                marker=MARKERS[element],
                markersize=5,
                markerfacecolor=COLOURS[element] if graded else "white",
                linestyle="-" if graded else "--",
                linewidth=1.2,
                label=method,
            )
        for target in TARGETS:
            panel.axhline(target, color="0.75", linewidth=0.8, zorder=0)
        panel.set_title(quantity.replace("_", " "), fontsize=10)
        panel.set_xlabel("seconds")
        panel.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        panel.xaxis.set_major_formatter("{x:g}")
        panel.xaxis.set_minor_formatter("")
    panels[0].set_ylabel("relative error of the discretisation")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    save(figure, path)


def main() -> None:
    """Measure, print and, if asked, write and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="coarser: about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    parser.add_argument("--plot", type=Path, metavar="DIR", help="draw, with matplotlib")
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for case, method, scenes in series(options.quick):
        solved(scenes[0])  # compiles the forms
        for scene in scenes:
            rows += measured(case, method, scene, repeat=2 if options.quick else 3)
        print(f"{case:6} {method:11} to {rows[-1]['dofs']:6} dofs", flush=True)
    print_table(rows)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    if options.plot:
        options.plot.mkdir(parents=True, exist_ok=True)
        for case, title in (("hertz", "Hertz"), ("slab", "Slab")):
            plot(rows, case, title, options.plot / f"work_precision_{case}.png")


if __name__ == "__main__":
    main()
