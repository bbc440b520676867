"""CalculiX: contact of two bodies by its penalty from face to face, from an input file."""

from __future__ import annotations

import re
import subprocess
import tempfile
from itertools import product
from pathlib import Path
from typing import Any

from answers import Answer, cpu_seconds
from problems import Pair, Problem

NAME = "CalculiX"
INSTALL = ("apt", ("calculix-ccx",))
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    "pair": {f"slope {slope:g} E": {"slope": slope} for slope in (50.0, 5000.0)},
}
ABOUT = (
    "Plane strain elements of eight nodes (`CPE8`), a contact pair `SURFACE TO SURFACE` with a "
    "linear pressure-overclosure of the slope that its manual recommends, 50 E a unit of length, "
    "and a stiffer one. Newton's method with its own control of increments; SPOOLES as Debian "
    "builds it. "
    "Seconds of solve are of all of the program, which reads an input file and writes text. It has "
    "no rigid obstacles of a given shape and no given pressure with friction, so it solves one of "
    "the problems."
)
# Sides of an element: below, right, above, left.
_BELOW, _RIGHT, _ABOVE, _LEFT = 1, 2, 3, 4


def solve(problem: Problem, level: int, setting: dict[str, Any]) -> Answer:
    """Write the input, run, read."""
    assert isinstance(problem, Pair)
    model = _Model()
    _lower(model, problem, level)
    _upper(model, problem, level)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "pair.inp").write_text(model.text(problem, setting["slope"]), "utf-8")
        start = cpu_seconds()
        command = ["ccx", "-i", "pair"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        seconds = cpu_seconds() - start
        found = Path(folder, "pair.dat")
        text = found.read_text("utf-8") if found.exists() else ""
    if "Job finished" not in done.stdout or "contact stress" not in text:
        raise RuntimeError((re.findall(r"\*ERROR.*", done.stdout) or ["no answer"])[0])
    newton = len(re.findall(r"^ *iteration +\d+", done.stdout, re.MULTILINE))
    return Answer(
        version=_version(),
        dofs=2 * len(model.nodes),
        solve_seconds=seconds,
        newton=newton,
        factorisations=newton,
        values=_values(text),
    )


class _Model:
    """Nodes, elements and sets of an input file."""

    def __init__(self) -> None:
        self.nodes: list[tuple[float, float]] = []
        self.elements: list[list[int]] = []
        self.sets: dict[str, list[int]] = {"axis": [], "held": [], "top": []}
        self.sides: dict[str, list[tuple[int, int]]] = {"upper": [], "lower": []}

    def grid(self, across: int, up: int, place: Any) -> dict[tuple[int, int], int]:
        """Elements of a rectangle; numbers of the nodes by twice the cells along both axes."""
        numbers: dict[tuple[int, int], int] = {}
        for i, j in product(range(2 * across + 1), range(2 * up + 1)):
            if i % 2 == 0 or j % 2 == 0:
                self.nodes.append(place(i / 2, j / 2))
                numbers[i, j] = len(self.nodes)
        for i, j in product(range(0, 2 * across, 2), range(0, 2 * up, 2)):
            ring = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
            self.elements.append([numbers[i + a, j + b] for a, b in ring])
        return numbers

    def text(self, problem: Pair, slope: float) -> str:
        """Of the input file."""
        lines = ["*NODE, NSET=ALL"]
        lines += [f"{n}, {x:.12g}, {y:.12g}, 0" for n, (x, y) in enumerate(self.nodes, 1)]
        lines += ["*ELEMENT, TYPE=CPE8, ELSET=BODY"]
        lines += [f"{n}, {', '.join(map(str, e))}" for n, e in enumerate(self.elements, 1)]
        for name, nodes in self.sets.items():
            lines += [f"*NSET, NSET={name}", *(f"{node}," for node in nodes)]
        for name, sides in self.sides.items():
            lines += [f"*SURFACE, NAME={name}, TYPE=ELEMENT"]
            lines += [f"{element}, S{side}" for element, side in sides]
        E, nu = problem.youngs_modulus, problem.poissons_ratio
        lines += f"""*MATERIAL, NAME=M
*ELASTIC
{E}, {nu}
*SOLID SECTION, ELSET=BODY, MATERIAL=M
1.
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{slope * E:g}, {1e-6 * E:g}
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
upper, lower
*BOUNDARY
axis, 1, 1
held, 1, 2
top, 1, 1
*STEP
*STATIC
1., 1.
*BOUNDARY
top, 2, 2, {-problem.pushed}
*NODE PRINT, NSET=top, TOTALS=ONLY
RF
*CONTACT PRINT
CSTR
*END STEP""".splitlines()
        return "\n".join(lines) + "\n"


def _lower(model: _Model, problem: Pair, level: int) -> None:
    lines = problem.lines(level)
    count = len(lines) - 1

    def line(number: float) -> float:
        whole = int(number)
        return lines[whole] if number == whole else (lines[whole] + lines[whole + 1]) / 2

    first = len(model.elements)
    numbers = model.grid(count, count, lambda i, j: (line(i), -line(count - j)))
    near = sum(place < problem.width * (1 - 1e-9) for place in lines)
    model.sides["lower"] = [(first + i * count + count, _ABOVE) for i in range(near)]
    ends = range(2 * count + 1)
    model.sets["axis"] += [numbers[0, j] for j in ends]
    held = {numbers[place] for k in ends for place in ((k, 0), (2 * count, k)) if place in numbers}
    model.sets["held"] += sorted(held)


def _upper(model: _Model, problem: Pair, level: int) -> None:
    along, up = problem.upper_cells(level)
    first = len(model.elements)
    numbers = model.grid(along, up, lambda i, j: problem.upper_place(i / along, j / up))
    model.sides["upper"] = [(first + i * up + 1, _BELOW) for i in range(along)]
    model.sets["axis"] += [numbers[0, j] for j in range(2 * up + 1)]
    model.sets["top"] += [numbers[i, 2 * up] for i in range(2 * along + 1)]


def _values(text: str) -> dict[str, float]:
    """Of the last increment."""
    force = re.findall(r"total force.*?\n\s*\n\s*(.*)", text)[-1].split()[1]
    stresses = text.rsplit("contact stress", 1)[1].splitlines()[1:]
    rows = [line.split() for line in stresses if re.match(r"\s*-?\d", line)]
    return {"force": -2 * float(force), "peak pressure": max(float(row[-3]) for row in rows)}


def _version() -> str:
    said = subprocess.run(["ccx", "-v"], capture_output=True, text=True).stdout
    return said.split("Version")[-1].strip()
