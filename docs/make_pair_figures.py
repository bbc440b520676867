"""The demos of two bodies beside their formulas: ``python docs/make_pair_figures.py``.

Runs the two demos and draws into docs/pictures:

- cylinders.png: pressure and friction, Hertz's and Cattaneo's, and the deformed bodies;
- incline.png: the push against the motion of the rear face, its limit, and the deformed bodies.
"""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from make_figures import Solved, draw_cells, picture

from fenics_contact.analytic import contact as formulas
from fenics_contact.report.drawing.figures import new_figure, style
from fenics_contact.report.drawing.style import COLOURS, DOUBLE, FORMULA

TITLES = {
    "cylinders": "Two cylinders pressed together and shifted",
    "incline": "Block pushed up a deformable incline",
}
Window = tuple[float, float, float, float]


def draw_pair(
    name: str, window: Window, factor: float, draw: Callable[[Any, Solved], None]
) -> None:
    """Solve a demo, and draw its deformed bodies beside a panel of its own."""
    with TemporaryDirectory() as temporary:
        run = Solved.of(name, Path(temporary))
    with style():
        figure, panels = new_figure(TITLES[name], (DOUBLE, 3.3), ncols=2)
        draw(panels[0], run)
        draw_cells(panels[1], run, window, factor)
        times = "" if factor == 1 else f", displacements × {factor:g}"
        panels[1].set_title(f"Deformed{times}")
        panels[1].set_xlabel("$x$")
        panels[1].set_ylabel("$y$")
        picture(figure, name)


def draw_tractions(panel: Any, run: Solved) -> None:
    """Pressure and friction along the upper cylinder, and the formulas (Johnson, 4.2 and 7.2)."""
    material, friction = run.scene.material[0], run.scene.contact[0].friction_coefficient
    found, line = run.result.quantities, run.surface.line
    modulus = formulas.plane_strain_modulus(material.youngs_modulus, material.poissons_ratio) / 2
    radius = run.scene.mesh[0].parameters["radius"] / 2
    hertz = formulas.line_contact(modulus, radius, found["normal_force"])
    x = np.linspace(-1, 1, 401) * hertz.radius
    used = -found["friction_force"][0] / (friction * found["normal_force"])
    sticks = hertz.radius * np.sqrt(1 - used)
    pressure = hertz.peak * np.sqrt(1 - (x / hertz.radius) ** 2)
    relief = sticks / hertz.radius * np.sqrt(np.maximum(1 - (x / sticks) ** 2, 0))
    cattaneo = friction * (pressure - hertz.peak * relief)
    computed = {"pressure, $p$": line.rows.numbers["contact_pressure"]}
    computed["friction, $-\\sigma_T$"] = -line.traction
    for (label, values), key in zip(computed.items(), ("STICK", "SLIP"), strict=True):
        panel.plot(line.position, values, "o", color=COLOURS[key], markersize=3, label=label)
    panel.plot(x, pressure, label="Hertz", **FORMULA)
    panel.plot(x, cattaneo, "--", label="Cattaneo, Mindlin", **FORMULA)
    panel.set_xlabel("position along the surface, $x$")
    panel.set_ylabel("stress")
    panel.legend(loc="upper right", ncols=2)
    panel.set_ylim(0, 1.35 * hertz.peak)


def draw_push(panel: Any, run: Solved) -> None:
    """Horizontal push over weight in each load step, and where all slides."""
    friction, slope = run.scene.contact[0].friction_coefficient, 0.1
    steps = [step.quantities for step in run.result.steps]
    weight = steps[-1]["reaction"][1]
    lean = slope / np.sqrt(1 + slope**2)
    push = [step["normal_force"] * lean - step["friction_force"][0] for step in steps]
    motion = [0.02 * (step.load_factor - 1) for step in run.result.steps]
    panel.plot(motion, np.array(push) / weight, "o-", color=COLOURS["STICK"])
    limit = (friction + slope) / (1 - friction * slope)
    panel.axhline(limit, linestyle="--", color="0", linewidth=1)
    text = r"$(\mu + \tan\alpha)\,/\,(1 - \mu\,\tan\alpha)$ = " + f"{limit:.4f}"
    panel.text(0, limit, text, va="bottom")
    panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    panel.set_xlabel("displacement of the rear face")
    panel.locator_params(axis="x", nbins=5)
    panel.set_ylabel("push over weight, $F / G$")
    panel.set_ylim(top=1.12 * limit)


if __name__ == "__main__":
    draw_pair("cylinders", (-1.2, 1.2, -1.2, 1.2), 1, draw_tractions)
    draw_pair("incline", (-0.2, 4.4, -1.1, 1.8), 10, draw_push)
