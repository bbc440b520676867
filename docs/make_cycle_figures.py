"""The demos of many load steps: ``python docs/make_cycle_figures.py``.

Runs the two demos and draws into docs/pictures:

- cycle.png: the loop, beside its formula, and the friction traction on the way back;
- cattaneo.png: the stick radius beside Cattaneo's and Mindlin's, and the friction traction;
- cattaneo.gif: what sticks and slips step by step, as the report draws it.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fenics_contact import Run
from fenics_contact.analytic import contact as formulas
from fenics_contact.report.contacts.film import Film, draw_film
from fenics_contact.report.contacts.line import SurfaceLine
from fenics_contact.report.drawing.fields import read_series, times_of_fields
from fenics_contact.report.drawing.figures import new_figure, save_png, style
from fenics_contact.report.drawing.style import COLOURS, DOUBLE, FORMULA
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.result import read_result
from fenics_contact.scene.reading import load_scene
from fenics_contact.simulation.output import run_folder as files

DOCS = Path(__file__).resolve().parent
PRESSED = 1  # steps of the demos before anything moves sideways
TURNS = (5, 15, 25, 35, 45)  # steps of the cycle at which it turns, from 0


def filmed(demo: str, folder: Path) -> tuple[Any, dict[str, Any], Film]:
    """A demo's scene, its result, and its contact step by step."""
    scene = load_scene(DOCS.parent / "demos" / f"{demo}.toml", ())
    files.solve_and_write(Run(scene), folder)
    result, rows = read_result(folder), ContactTable.read(folder / "contact.csv")
    series = read_series(folder, range(len(times_of_fields(folder))))
    far = (", ".join(scene.half_space.on),)
    return scene, result, Film.of(series, rows, result.contacts[0], result, far)


def draw_cycle(scene: Any, film: Film) -> None:
    """Force against the displacement that slip adds to that of sticking, and the formula's."""
    material, contact = scene.material[0], scene.contact[0]
    modulus = formulas.plane_strain_modulus(material.youngs_modulus, material.poissons_ratio)
    most = contact.friction_coefficient * contact.obstacle.force
    moved, force = film.drive.x / (most / (np.pi * modulus)), film.drive.y / most

    def added(share: np.ndarray) -> np.ndarray:
        """δ − Q dδ/dQ(0) in partial slip, over μP/(πE*), for Q = share μP."""
        return (1 - share) * np.log(1 - share) + share

    turn = force[TURNS[2]]
    there = turn - np.linspace(0, 2 * turn, 201)
    back = added(np.array(turn)) - 2 * added((turn - there) / 2)
    # What displacement goes with sticking alone has no formula: it fits one turn to the other.
    ends = [TURNS[1], TURNS[2]]
    stiff = (np.diff(moved[ends]) - 2 * added(np.array(turn))) / np.diff(force[ends])
    slipped = moved - stiff * force
    figure, panels = new_figure("Parabola moved to and fro: the loop", (DOUBLE, 3.3), ncols=2)
    first, rest = slice(0, TURNS[0] + 1), slice(TURNS[0], None)
    panels[0].plot(back, there, label="formula", **FORMULA)
    panels[0].plot(-back, -there, **FORMULA)
    up = np.linspace(0, turn, 101)
    panels[0].plot(added(up), up, "--", label="formula, first quarter", **FORMULA)
    for part, key, size, label in (
        (first, "SLIP", 4, "first quarter"),
        (rest, "STICK", 3, "two cycles"),
    ):
        panels[0].plot(
            slipped[part], force[part], "o", color=COLOURS[key], markersize=size, label=label
        )
    panels[0].set_xlabel(r"displacement beyond sticking, $(\delta - C\,Q)\,\pi E^* / \mu P$")
    panels[0].set_ylabel(r"force along the surface, $Q / \mu P$")
    panels[0].legend(loc="upper left")
    shades = {15: "0.75", 19: "0.5", 22: "0.25", 25: "0"}
    for number, shade in shades.items():
        line = SurfaceLine.of(film.body, film.frames[number], film.contact)
        label = f"$Q = {force[number]:.2f}\\,\\mu P$"
        panels[1].plot(line.position, line.traction, ".-", color=shade, label=label)
    bound = contact.friction_coefficient * line.rows.numbers["contact_pressure"]
    for side in (1, -1):
        panels[1].plot(line.position, side * bound, "--", color=COLOURS["SLIP"], linewidth=1)
    panels[1].set_title(r"Friction on the way back, and $\pm\mu p$")
    panels[1].set_xlim(-1.3, 1.3)
    panels[1].set_ylim(top=1.6 * bound.max())
    panels[1].set_xlabel("position along the surface, $x$")
    panels[1].set_ylabel(r"friction traction on the body, $\sigma_T$")
    panels[1].legend(ncols=2, loc="upper center")
    save_png(figure, DOCS / "pictures" / "cycle.png")


def draw_stick(scene: Any, result: RunRecord, film: Film) -> None:
    """c/a against Q/μP, and the friction traction on the plane of symmetry at the end."""
    contact = scene.contact[0]
    most = contact.friction_coefficient * contact.obstacle.force
    steps = [step.quantities for step in result.steps][PRESSED:]
    used = np.array([step["friction_force"][0] for step in steps]) / most
    found = np.sqrt([step["stick_area"] / step["contact_area"] for step in steps])
    figure, panels = new_figure("Sheared sphere: what sticks", (DOUBLE, 3.2), ncols=2)
    share = np.linspace(0, 1, 201)
    panels[0].plot(share, np.cbrt(1 - share), label="Cattaneo, Mindlin", **FORMULA)
    panels[0].plot(used, found, "o", color=COLOURS["STICK"], label="from the areas")
    panels[0].set_xlabel(r"force along the surface, $Q / \mu P$")
    panels[0].set_ylabel("stick radius, $c / a$")
    panels[0].set_ylim(0, 1.05)
    panels[0].legend()
    material = scene.material[0]
    modulus = formulas.plane_strain_modulus(material.youngs_modulus, material.poissons_ratio)
    depth = result.quantities["indentation"]
    hertz = formulas.paraboloid(modulus, contact.obstacle.radius, depth)
    x = np.linspace(-1.2, 1.2, 481) * hertz.radius
    for number, key in ((3, "0.6"), (6, "0.35"), (10, "0")):
        rows = film.frames[number]
        rows = rows.rows(np.abs(rows.numbers["y"]) < 1e-9)
        order = np.argsort(rows.numbers["x"])
        at, traction = (rows.numbers[name][order] for name in ("x", "traction_x"))
        now = used[number - PRESSED]
        label = f"$Q = {now:.2f}\\,\\mu P$"
        panels[1].plot(at, traction, "o", color=key, label=label)
        sticks = hertz.radius * np.cbrt(1 - now)
        full, relief = (np.sqrt(np.maximum(1 - (x / c) ** 2, 0)) for c in (hertz.radius, sticks))
        formula = full - sticks / hertz.radius * relief
        peak = contact.friction_coefficient * hertz.peak
        panels[1].plot(x, peak * formula, color=key, linewidth=1)
    panels[1].set_title("Friction traction along y = 0, and formulas")
    panels[1].set_xlabel("$x$")
    panels[1].set_ylabel(r"friction traction on the body, $\sigma_{T,x}$")
    panels[1].legend()
    save_png(figure, DOCS / "pictures" / "cattaneo.png")


if __name__ == "__main__":
    with TemporaryDirectory() as temporary:
        scene, _, film = filmed("cycle", Path(temporary) / "cycle")
        with style():
            draw_cycle(scene, film)
        scene, result, film = filmed("cattaneo", Path(temporary) / "cattaneo")
        with style():
            draw_stick(scene, result, film)
        draw_film(film, False, "xyz", DOCS / "pictures" / "cattaneo.gif")
