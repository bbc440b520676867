"""Pictures of README and docs that are those of a run: ``python docs/make_run_figures.py``.

Runs five scenes and draws into docs/pictures what ``fenics-contact report`` draws of them:

- slab_friction.png, slab_deformed.png: example 1;
- sphere_pressure.png, sphere_deformed.png: example 3;
- adapted_mesh.png: example 3 to an accuracy of a thousandth;
- bracket.png: the bracket of docs/bracket.md;
- joint.png, joint_lap.png: the bolted joint.
"""

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

from fenics_contact.cli.program import main
from fenics_contact.report.gallery import draw_pictures
from fenics_contact.results.result import read_result

DOCS = Path(__file__).resolve().parent
DEMOS = DOCS.parent / "demos"
# Scene, what is set in it, and its pictures by the names that they get.
RUNS: tuple[tuple[Path, tuple[str, ...], dict[str, str]], ...] = (
    (DEMOS / "slab.toml", (), {"contact_0": "slab_friction", "deformed": "slab_deformed"}),
    (DEMOS / "sphere.toml", (), {"contact_0": "sphere_pressure", "deformed": "sphere_deformed"}),
    (DEMOS / "sphere.toml", ("accuracy=1e-3",), {"mesh": "adapted_mesh"}),
    (DOCS / "bracket.toml", (), {"deformed": "bracket"}),
    (
        DEMOS / "joint.toml",
        ("solver.errors=none",),
        {"deformed": "joint", "contact_0": "joint_lap"},
    ),
)


def draw(path: Path, settings: tuple[str, ...], names: dict[str, str]) -> None:
    """Solve a scene, draw it and keep some of the pictures."""
    with TemporaryDirectory() as temporary:
        folder = Path(temporary)
        changes = [word for setting in settings for word in ("--set", setting)]
        code = main(["run", str(path), "--out", str(folder), *changes])
        if code != 0:
            raise SystemExit(code)
        draw_pictures(folder, read_result(folder))
        for drawn, kept in names.items():
            shutil.copy(folder / f"{drawn}.png", DOCS / "pictures" / f"{kept}.png")


if __name__ == "__main__":
    for run in RUNS:
        draw(*run)
