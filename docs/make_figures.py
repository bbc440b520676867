"""The paper's examples 2 to 4 with and without friction: ``python docs/make_figures.py``.

Runs the three demos and draws into docs/pictures, of example N, with and without friction:

- exampleN.png: pressure, friction and the displacement of the surface;
- exampleN_deformed.png: the deformed bodies;
- example3_axis.png: the stresses on the axis, beside Hertz's.
"""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fenics_contact import Run, Scene
from fenics_contact.analytic import contact as formulas
from fenics_contact.report.contacts.curves import cut_peaks
from fenics_contact.report.contacts.depth_curves import AxisStress, SurfaceDisplacement
from fenics_contact.report.drawing.fields import read_body
from fenics_contact.report.drawing.figures import new_figure, save_png, style
from fenics_contact.report.drawing.style import COLUMN, DOUBLE, LINES
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.result import read_result
from fenics_contact.scene.reading import load_scene
from fenics_contact.simulation.output import run_folder as files

DOCS = Path(__file__).resolve().parent
NAMES = {
    "pressure": "contact pressure, $p$",
    "friction": r"friction traction, $\sigma_T$",
    "normal": "normal, $u_n$",
    "tangential": "tangential, $u_T$",
}
STYLES = {"with friction": dict(zip(("color", "linestyle"), LINES[0], strict=True))}
STYLES["without"] = dict(zip(("color", "linestyle"), LINES[1], strict=True))
AROUND = [0, 4, 1, 5, 2, 6, 3, 7, 0]  # VTK's nodes around a quadrilateral of degree 2
DEPTH = 3.0  # of the axis that is shown, in Hertz's radii


@dataclass(frozen=True)
class Example:
    """How an example is drawn.

    Attributes:
        demo: Name of its scene.
        title: What it is.
        window: What is shown of the deformed body: left, right, bottom and top (length).
        factor: Magnification of its displacements.
        layout: Rows and columns, width and height of the picture of the deformed body.
    """

    demo: str
    title: str
    window: tuple[float, float, float, float]
    factor: float
    layout: tuple[int, int, float, float] = (1, 2, DOUBLE, 3.8)


EXAMPLES = {
    2: Example(
        "winkler", "a slab on a Winkler foundation", (0, 10.2, -0.5, 2.6), 5, (2, 1, DOUBLE, 4.6)
    ),
    3: Example("sphere", "a sphere on a half-space", (0, 5, -4.4, 0.6), 1),
    4: Example("annulus", "an annular punch", (0, 2, -1.7, 0.3), 20),
}


@dataclass(frozen=True)
class Solved:
    """One run, from its files.

    Attributes:
        scene: What was solved.
        result: The content of its ``result.json``.
        body: A pyvista grid with the run's fields.
        surface: Displacement of the contact's points.
    """

    scene: Scene
    result: RunRecord
    body: Any
    surface: SurfaceDisplacement

    @classmethod
    def of(cls, demo: str, folder: Path, *overrides: str) -> "Solved":
        """Run a demo and read its files."""
        scene = load_scene(DOCS.parent / "demos" / f"{demo}.toml", overrides)
        run = Run(scene)
        files.write(run, run.solve(), folder)
        result = read_result(folder)
        body, rows = read_body(folder), ContactTable.read(folder / "contact.csv")
        return cls(scene, result, body, SurfaceDisplacement.of(body, rows, result.contacts[0]))

    def curve(self, name: str, end: float) -> tuple[np.ndarray, np.ndarray]:
        """Positions and values of one of ``NAMES``; displacements also beyond the contact."""
        line = self.surface.line
        if name == "pressure":
            return line.position, line.rows.numbers["contact_pressure"]
        if name == "friction":
            return line.position, line.traction
        points, (x, y) = self.body.points, self.body["displacement"][:, :2].T
        height, up = line.rows.numbers["y"][0], line.rows.numbers["ny"][0]
        on_surface = np.flatnonzero((abs(points[:, 1] - height) < 1e-9) & (points[:, 0] <= end))
        nodes = on_surface[np.argsort(points[on_surface, 0])]
        return points[nodes, 0], (up * y if name == "normal" else x)[nodes]


def picture(figure: Any, name: str) -> None:
    """Write one of docs/pictures."""
    save_png(figure, DOCS / "pictures" / f"{name}.png")


def draw_curves(number: int, runs: dict[str, Solved]) -> None:
    """Pressure, friction and displacements along the surface; peaks at edges are cut off."""
    example = EXAMPLES[number]
    figure, panels = new_figure("", (DOUBLE, 4.2), nrows=2, ncols=2)
    figure.suptitle(f"Example {number}: {example.title}", x=0.01, ha="left", fontsize=8.5)
    for (name, label), panel in zip(NAMES.items(), panels, strict=True):
        for run, look in STYLES.items():
            panel.plot(*runs[run].curve(name, example.window[1]), label=run, **look)
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
        if name in ("pressure", "friction"):
            cut_peaks(panel, runs["with friction"].curve(name, example.window[1])[1])
        panel.set_ylabel(label)
        panel.set_xlabel(f"position along the surface, ${'x' if number == 2 else 'r'}$")
    panels[0].legend()
    picture(figure, f"example{number}")


def draw_cells(
    panel: Any, run: Solved, window: tuple[float, float, float, float], factor: float
) -> None:
    """The deformed cells in a window, and the points in contact."""
    from matplotlib.collections import LineCollection

    body, found = run.body, run.surface
    cells = body.cell_connectivity.reshape(body.n_cells, -1)[:, AROUND]
    moved = body.points + factor * body["displacement"]
    panel.add_collection(LineCollection(moved[cells, :2], colors="0.5", linewidths=0.3))
    points = found.line.rows.vectors("x", "y") + factor * found.vectors
    for mark in found.line.marks:
        mine = np.isin(found.line.rows.status, mark.status) & found.line.rows.closed
        if mine.any():
            panel.plot(*points[mine].T, **mark.look | {"markersize": 3})
    panel.legend(frameon=True, framealpha=0.9, edgecolor="white", loc="upper left", ncols=2)
    panel.set_aspect("equal")
    panel.set_xlim(window[:2])
    panel.set_ylim(window[2:])


def draw_deformed(number: int, runs: dict[str, Solved]) -> None:
    """The deformed bodies, their contact points, and where the bodies were."""
    example = EXAMPLES[number]
    rows, columns, *size = example.layout
    title = f"Example {number}, displacements x {example.factor:g}: without friction"
    figure, panels = new_figure(title, tuple(size), nrows=rows, ncols=columns)
    panels[1].set_title("with friction")
    for panel, run in zip(panels, ("without", "with friction"), strict=True):
        left, right, bottom, top = runs[run].body.bounds[:4]
        outline = [left, right, right, left, left], [bottom, bottom, top, top, bottom]
        panel.plot(*outline, "--", color="0.35", linewidth=0.7)
        draw_cells(panel, runs[run], example.window, example.factor)
        axes = "xy" if number == 2 else "rz"
        panel.set_xlabel(f"${axes[0]}$")
        panel.set_ylabel(f"${axes[1]}$")
    picture(figure, f"example{number}_deformed")


def draw_axis(number: int, runs: dict[str, Solved]) -> None:
    """The stresses on the axis of both runs, and Hertz's."""
    scene = runs["without"].scene
    material, obstacle = scene.material[0], scene.contact[0].obstacle
    modulus = formulas.plane_strain_modulus(material.youngs_modulus, material.poissons_ratio)
    hertz = formulas.paraboloid(modulus, obstacle.radius, obstacle.indentation)
    title = f"Example {number}: stresses on the axis"
    figure, (panel,) = new_figure(title, (COLUMN, 3.4))
    for run, look in STYLES.items():
        stress = AxisStress.of(runs[run].body, runs[run].surface.line.rows)
        values = np.stack([stress.axial, stress.radial], axis=1) / hertz.peak
        first, _ = panel.plot(values, stress.depth / hertz.radius, **look)
        first.set_label(run)
    depth = np.linspace(0, DEPTH, 25)
    formula = formulas.axis_stress(hertz, depth * hertz.radius, material.poissons_ratio)
    values = np.stack(formula, axis=1) / hertz.peak
    first, _ = panel.plot(values, depth, "o", color="0", markerfacecolor="white")
    first.set_label("Hertz's formula")
    panel.text(-0.93, 0.12, r"$\sigma_{zz}$", va="bottom")
    panel.text(-0.3, 0.12, r"$\sigma_{rr}$", va="bottom")
    panel.axvline(0, color="black", linewidth=0.5, zorder=0)
    panel.set_ylim(1.02 * DEPTH, -0.03 * DEPTH)
    panel.set_xlabel("stress over Hertz's peak of the pressure, $p_0$")
    panel.set_ylabel("depth over Hertz's radius, $z / a$")
    panel.legend()
    picture(figure, f"example{number}_axis")


if __name__ == "__main__":
    for number, example in EXAMPLES.items():
        with TemporaryDirectory() as temporary:
            smooth = "contact.0.friction_coefficient=0"
            runs = {
                "with friction": Solved.of(example.demo, Path(temporary) / "rough"),
                "without": Solved.of(example.demo, Path(temporary) / "smooth", smooth),
            }
            with style():
                draw_curves(number, runs)
                draw_deformed(number, runs)
                if number == 3:
                    draw_axis(number, runs)
