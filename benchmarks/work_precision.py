"""Error against time: the paper's slab, Hertz's contact and its like with friction.

``python benchmarks/work_precision.py [--quick] [--json FILE] [--plot DIR] [--strategy NAME]``

Seconds are those of one process with all forms compiled: mesh, assembly, set-up and solve,
without compilation and output, the least of several runs. Errors are those of the
discretisation alone: the references are of the same domain. ``docs/benchmarks.md`` shows them.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from fenics_contact import Discretisation, Obstacle, Result, Scene, SolverSettings
from fenics_contact.figures import new_figure, save
from fenics_contact.verification.case import solved
from fenics_contact.verification.friction_cases import with_friction
from fenics_contact.verification.point_cases import half_space_scene
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
COEFFICIENT = 0.6

COLOURS = {"P1": "#c0392b", "Q1": "#e67e22", "P2": "#2e86c1", "Q2": "#1b2631"}
MARKERS = {"P1": "^", "Q1": "s", "P2": "v", "Q2": "o"}
TARGETS = (1e-2, 1e-3)


@dataclasses.dataclass(frozen=True)
class Case:
    """A contact that is computed with all elements on finer and finer meshes.

    Attributes:
        name: In rows and file names.
        title: Of the picture.
        scene: By kind of mesh and size of the cells.
        meshes: The kinds of mesh.
        levels: The first and the last i of the sizes 1/2^i, with degree 2 on uniform meshes.
        references: By quantity.
    """

    name: str
    title: str
    scene: Callable[[str, float], Scene]
    meshes: tuple[str, ...]
    levels: tuple[int, int]
    references: dict[str, float]

    def series(self, quick: bool) -> list[tuple[str, list[Scene]]]:
        """Method and scenes from coarse to fine; what costs less goes one further."""
        first, last = self.levels
        found = []
        for element, (_, degree) in ELEMENTS.items():
            for mesh in self.meshes:
                finest = last + (degree == 1) + (mesh == "graded") - quick
                sizes = [0.5**i for i in range(first, finest + 1)]
                scenes = [of_element(self.scene(mesh, size), element) for size in sizes]
                found.append((f"{element} {mesh}", scenes))
        return found


def slab(mesh: str, size: float) -> Scene:
    """Example 1: 8 by 1."""
    return slab_scene(cells=(round(8 / size), round(1 / size)))


def hertz(mesh: str, size: float) -> Scene:
    """Hertz's contact with cells of a given size in it."""
    extra = 1 if mesh == "uniform" else 0  # the geometry's ratio becomes 1 with one more
    return half_space_scene(
        Obstacle("paraboloid", radius=8, indentation=1),
        extent=EXTENT,
        fine=FINE,
        size=size,
        cells_outside=round(OUTSIDE[mesh] / size) + extra,
    )


def of_element(scene: Scene, element: str) -> Scene:
    """The same scene with other elements."""
    cell, degree = ELEMENTS[element]
    return dataclasses.replace(
        scene,
        mesh=tuple(dataclasses.replace(mesh, cell=cell) for mesh in scene.mesh),
        discretisation=Discretisation(degree),
    )


def cases(settings: SolverSettings) -> list[Case]:
    """All cases, with how friction and pressure are brought together."""

    def rough(mesh: str, size: float) -> Scene:
        scene = with_friction(hertz(mesh, size), COEFFICIENT)
        return dataclasses.replace(scene, solver=settings)

    # Slab: Q2 512 × 64; the energy extrapolated at second order from 256 × 32 and 512 × 64.
    # Hertz: Q2 graded at h = 1/32 and 1/48, which agree to 1e-5 in force and peak. They are .17 %
    # and .08 % below the formulas of the half-space, which is the domain's error. The radius is
    # that of an ellipsoid of pressure with this force and peak, F = 2/3 π a² p₀.
    # Friction: Q2 graded at h = 1/64, monolithic. 1/32 and 1/48 agree with it to 1e-5 in force,
    # 2e-5 in peak and 4e-4 in stick radius: smaller errors say nothing.
    force, peak = 4137.01, 247.140
    radius = math.sqrt(1.5 * force / math.pi / peak)
    kinds = ("uniform", "graded")
    return [
        Case(
            "slab",
            "Slab",
            slab,
            ("uniform",),
            (1, 4),
            {"friction_force": 209.9750961, "strain_energy": 352.713039},
        ),
        Case(
            "hertz",
            "Hertz",
            hertz,
            kinds,
            (0, 3),
            {"normal_force": force, "max_contact_pressure": peak, "contact_radius": radius},
        ),
        Case(
            "friction",
            f"Hertz with friction, μ = {COEFFICIENT}",
            rough,
            kinds,
            (0, 2),
            {"normal_force": 4229.41, "max_contact_pressure": 268.059, "stick_radius": 2.1186},
        ),
    ]


def value_of(quantity: str, result: Result) -> float:
    """A quantity of the references; radii are those of the circle that has the area."""
    if quantity.endswith("_radius"):
        return math.sqrt(result.quantities[quantity.replace("radius", "area")] / math.pi)
    found = result.quantities[quantity]
    return found[0] if quantity == "friction_force" else found


def measured(case: Case, method: str, scene: Scene, repeat: int) -> list[dict[str, Any]]:
    """A row a quantity, with the least time of several runs."""
    results = [solved(scene) for _ in range(repeat)]
    seconds = min(
        result.timings["total"] - result.timings["compile"] - result.timings["output"]
        for result in results
    )
    rows = []
    for quantity, reference in case.references.items():
        value = value_of(quantity, results[0])
        rows.append(
            {
                "case": case.name,
                "method": method,
                "dofs": results[0].model["dofs"],
                "newton_iterations": results[0].steps[-1]["newton_iterations"],
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


def select(rows: list[dict[str, Any]], **keys: Any) -> list[dict[str, Any]]:
    """Rows with given entries."""
    return [row for row in rows if all(row[key] == value for key, value in keys.items())]


def methods(rows: list[dict[str, Any]]) -> list[str]:
    """Those of some rows, each once."""
    return list(dict.fromkeys(row["method"] for row in rows))


def print_table(case: Case, rows: list[dict[str, Any]]) -> None:
    """What every method takes to the targets."""
    table = Table("quantity", "method", *(f"to {t:.1%}" for t in TARGETS), title=case.title)
    for quantity in case.references:
        chosen = select(rows, case=case.name, quantity=quantity)
        for method in methods(chosen):
            one = select(chosen, method=method)
            table.add_row(quantity, method, *(reached(one, target) for target in TARGETS))
    Console().print(table)


def print_cost(rows: list[dict[str, Any]]) -> None:
    """What friction costs on the finest mesh of every method."""
    table = Table("method", "dofs", "smooth", "rough", "ratio", title="Friction costs")
    for method in methods(select(rows, case="friction")):
        rough = select(rows, case="friction", method=method)[-1]
        smooth = select(rows, case="hertz", method=method, dofs=rough["dofs"])[0]
        table.add_row(
            method,
            str(rough["dofs"]),
            *(f"{r['seconds']:.2f} s, {r['newton_iterations']} steps" for r in (smooth, rough)),
            f"{rough['seconds'] / smooth['seconds']:.1f}",
        )
    Console().print(table)


def plot(case: Case, rows: list[dict[str, Any]], path: Path) -> None:
    """A panel a quantity: error against seconds."""
    from matplotlib.ticker import LogLocator

    names = list(case.references)
    figure, panels = new_figure("", (3.6 * len(names), 4.6), ncols=len(names), sharey=True)
    figure.suptitle(case.title, fontsize=11)
    for panel, quantity in zip(panels, names, strict=True):
        chosen = select(rows, case=case.name, quantity=quantity)
        for method in methods(chosen):
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
    parser.add_argument("--strategy", default="auto", metavar="NAME", help="for friction")
    options = parser.parse_args()
    measured_cases = cases(SolverSettings(strategy=options.strategy))
    rows: list[dict[str, Any]] = []
    for case in measured_cases:
        for method, scenes in case.series(options.quick):
            solved(scenes[0])  # compiles the forms
            for scene in scenes:
                rows += measured(case, method, scene, repeat=2 if options.quick else 3)
            print(f"{case.name:8} {method:11} to {rows[-1]['dofs']:6} dofs", flush=True)
    for case in measured_cases:
        print_table(case, rows)
    print_cost(rows)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    if options.plot:
        options.plot.mkdir(parents=True, exist_ok=True)
        for case in measured_cases:
            plot(case, rows, options.plot / f"work_precision_{case.name}.png")


if __name__ == "__main__":
    main()
