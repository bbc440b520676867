"""The design study of the bolted joint: ``python docs/make_design_study.py [FOLDER]``; minutes.

Sweeps demos/joint.toml, or takes the folder of that sweep, and draws
docs/pictures/design_study.png: the slip in the lap, and what of it sticks, over the clamp force.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

from make_figures import picture

from fenics_contact import main as fenics_contact
from fenics_contact.report.drawing.figures import new_figure, style
from fenics_contact.report.drawing.style import DOUBLE, LINES

ROOT = Path(__file__).resolve().parent.parent
FORCE, MU = "preload.0.force", "contact.0.friction_coefficient"
VARIED = ("--vary", f"{FORCE}=4e3,6e3,8e3,10e3,12e3", "--vary", f"{MU}=0.1,0.15,0.2,0.3")


def draw(folder: Path) -> None:
    """From the table of the sweep."""
    with (folder / "sweep.csv").open(encoding="utf-8") as file:
        rows = [
            {name: float(value) for name, value in row.items() if value}
            for row in csv.DictReader(file)
            if row["exit_code"] == "0"
        ]
    with style():
        figure, (left, right) = new_figure("Clamp force, friction and slip", (DOUBLE, 3.3), ncols=2)
        coefficients = sorted({row[MU] for row in rows})
        for coefficient, (colour, dashes) in zip(coefficients, LINES, strict=False):
            mine = [row for row in rows if row[MU] == coefficient]
            force = [row[FORCE] / 1000 for row in mine]
            sticks = [row["lap.stick_area"] / row["lap.contact_area"] for row in mine]
            looks = {"color": colour, "ls": dashes, "marker": "o", "label": f"μ = {coefficient:g}"}
            left.semilogy(force, [row["lap.max_slip"] for row in mine], **looks)
            right.plot(force, sticks, **looks)
        left.set(xlabel="clamp force (kN)", ylabel="largest slip in the lap (mm)")
        right.set(xlabel="clamp force (kN)", ylabel="share of the lap that sticks")
        left.legend()
        picture(figure, "design_study")


def main() -> int:
    """Solve, unless a folder is given, and draw."""
    folder = ROOT / "results" / "joint_sweep"
    if len(sys.argv) > 1:
        folder = Path(sys.argv[1])
    else:
        scene = str(ROOT / "demos" / "joint.toml")
        settings = ("--set", "solver.errors=none", "--out", str(folder))
        code = fenics_contact(["sweep", scene, *VARIED, *settings])
        if code:
            return code
    draw(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
