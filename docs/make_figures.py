"""The paper's examples 2 to 4 with and without friction: ``python docs/make_figures.py``.

Runs the three demos and draws pressure, friction and the displacement of the surface of both runs
over one another, into docs/pictures/example2.png, example3.png and example4.png.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fenics_contact import Run, files
from fenics_contact.body_picture import read_body
from fenics_contact.contact_table import ContactTable
from fenics_contact.curves import cut_peaks
from fenics_contact.figures import new_figure, save
from fenics_contact.scene_file import load_scene
from fenics_contact.surface_displacement import SurfaceDisplacement

DOCS = Path(__file__).resolve().parent
EXAMPLES = {
    2: ("winkler", "a slab on a Winkler foundation"),
    3: ("sphere", "a sphere on a half-space"),
    4: ("annulus", "an annular punch"),
}
NAMES = {
    "pressure": "contact pressure, $p$",
    "friction": r"friction traction, $\sigma_T$",
    "normal": "normal, $u_n$",
    "tangential": "tangential, $u_T$",
}


@dataclass(frozen=True)
class Curves:
    """What happens along the contact surface of one run.

    Attributes:
        position: Coordinate along the surface (length).
        values: Keys of ``NAMES`` to values at the positions.
    """

    position: np.ndarray
    values: dict[str, np.ndarray]

    @classmethod
    def of(cls, demo: str, folder: Path, *overrides: str) -> "Curves":
        """Run a demo and read its files."""
        run = Run(load_scene(DOCS.parent / "demos" / f"{demo}.toml", overrides))
        files.write(run, run.solve(), folder)
        result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        table = ContactTable.read(folder / "contact.csv")
        found = SurfaceDisplacement.of(read_body(folder), table, result["contacts"][0])
        values = {
            "pressure": found.line.rows.numbers["contact_pressure"],
            "friction": found.line.traction,
            "normal": found.normal,
            "tangential": found.tangential,
        }
        return cls(found.line.position, values)


def draw(number: int, folder: Path) -> None:
    """Draw one example."""
    demo, title = EXAMPLES[number]
    rough = Curves.of(demo, folder / "rough")
    smooth = Curves.of(demo, folder / "smooth", "contact.0.friction_coefficient=0")
    figure, panels = new_figure(f"Example {number}: {title}", (9, 5.4), nrows=2, ncols=2)
    for (name, label), panel in zip(NAMES.items(), panels, strict=True):
        draw_panel(panel, name, rough, smooth)
        panel.set_ylabel(label)
        panel.set_xlabel("position along the surface")
    panels[0].legend(frameon=False, fontsize=9)
    save(figure, DOCS / "pictures" / f"example{number}.png")


def draw_panel(panel: Any, name: str, rough: Curves, smooth: Curves) -> None:
    """One quantity of both runs; pressures at the edges of a punch are cut off."""
    styles = {"with friction": (rough, "-", "0"), "without": (smooth, "--", "0.45")}
    for label, (curves, style, shade) in styles.items():
        panel.plot(curves.position, curves.values[name], style, color=shade, label=label)
    panel.axhline(0, color="black", linewidth=0.6)
    if name in ("pressure", "friction"):
        cut_peaks(panel, rough.values[name])


if __name__ == "__main__":
    for example in EXAMPLES:
        with TemporaryDirectory() as temporary:
            draw(example, Path(temporary))
