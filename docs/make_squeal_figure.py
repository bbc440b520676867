"""Modes of a pad that slides: ``python docs/make_squeal_figure.py``; half a minute.

Solves the scene of howto/squeal.md and draws docs/pictures/squeal.png.
"""

import re
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

from fenics_contact import load_scene
from fenics_contact.analyses.stability.page import draw_stability
from fenics_contact.report.drawing.figures import style
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output.run_folder import solve_and_write
from fenics_contact.simulation.scene_run import Run

DOCS = Path(__file__).resolve().parent


def main() -> None:
    """Solve and draw."""
    text = (DOCS / "howto" / "squeal.md").read_text(encoding="utf-8")
    found = re.search(r"```toml\n(.*?)```", text, re.DOTALL)
    assert found is not None
    with TemporaryDirectory() as folder:
        scene, out = Path(folder, "squeal.toml"), Path(folder, "out")
        scene.write_text(found[1].replace("../meshes", str(DOCS.parent / "meshes")))
        solve_and_write(Run(load_scene(scene)), out)
        with style():
            (picture,) = draw_stability(out, read_result(out))
        copyfile(picture.path, DOCS / "pictures" / "squeal.png")


if __name__ == "__main__":
    main()
