"""Without the folder of any one analysis the program runs scenes that do not ask for it."""

import ast
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from mpi4py import MPI

from fenics_contact.analyses import registry
from tests.project.test_house import FIELDS_OF_ANALYSES, PACKAGE
from tests.scenes import ROOT

pytestmark = [
    pytest.mark.serial,
    pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="starts programs; one rank will do"),
]

# What asks for each: after a scene, and the key that is not known without the folder.
ASKING = {
    "derivatives": ('derivatives = { of = ["friction_force"], by = ["load.0.traction.0"] }', ""),
    "fretting": ("fretting = { depth = 0.5 }", ""),
    "stress_lines": ('line = [{ name = "a", from = [0, 0], to = [1, 0] }]', "line"),
    "vibration": ("modes = { number = 2 }", "modes"),
    "stability": ("stability = { number = 2 }", ""),
    "wear_cycles": ("cycles = { begin = 1, end = 2, jumps = {} }", "cycles.jumps"),
}
# Says where the program is, loads every demo, says which of them are refused, and why a scene that
# asks for it is; and runs one.
PROGRAM = """
import pathlib
import fenics_contact
from fenics_contact import InputError, load_scene, main
print(fenics_contact.__file__)
for path in (*sorted(pathlib.Path("demos").glob("*.toml")), pathlib.Path("demos/asking.toml")):
    try:
        load_scene(path)
    except InputError as error:
        print(path.name, "refused:", error)
set_ = ["--set", "mesh.parameters.cells_along=4", "--set", 'solver.errors="none"']
assert main(["run", "demos/slab.toml", *set_, "--out", "out", "--quiet"]) == 0
"""


def without_fields(text: str, package: str) -> str:
    """A module without what it imports of a package, and without fields of these types."""
    tree = ast.parse(text)
    taken = [
        node
        for node in tree.body
        if isinstance(node, ast.ImportFrom) and f"{node.module}.".startswith(f"{package}.")
    ]
    names = {name.name for node in taken for name in node.names}
    fields = [
        field
        for kind in tree.body
        if isinstance(kind, ast.ClassDef)
        for field in kind.body
        if isinstance(field, ast.AnnAssign)
        and names & {name.id for name in ast.walk(field.annotation) if isinstance(name, ast.Name)}
    ]
    gone = {
        line
        for node in (*taken, *fields)
        for line in range(node.lineno, (node.end_lineno or node.lineno) + 1)
    }
    lines = text.splitlines(keepends=True)
    return "".join(line for number, line in enumerate(lines, start=1) if number not in gone)


def remove(analysis: str, copy: Path) -> None:
    """Take an analysis out of a copy of the program: folder, line in the list, typed fields."""
    package = f"fenics_contact.analyses.{analysis}"
    shutil.rmtree(copy / "analyses" / analysis)
    listed = copy / "analyses" / "registry.py"
    text = listed.read_text(encoding="utf-8")
    assert text.count(f'    "{package}",\n') == 1
    listed.write_text(text.replace(f'    "{package}",\n', ""), encoding="utf-8")
    for name in FIELDS_OF_ANALYSES:
        path = copy / name
        text = path.read_text(encoding="utf-8")
        path.write_text(without_fields(text, package), encoding="utf-8")


def test_every_analysis_is_tried() -> None:
    assert {one.package.rpartition(".")[2] for one in registry.every()} == {*ASKING}


@pytest.mark.parametrize("analysis", ASKING)
def test_without_an_analysis_other_scenes_run(analysis: str, tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "fenics_contact")  # with what Python has compiled of it
    for folder in ("demos", "meshes"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    slab = (tmp_path / "demos" / "slab.toml").read_text(encoding="utf-8")
    table, key = ASKING[analysis]
    (tmp_path / "demos" / "asking.toml").write_text(f"{table}\n{slab}", encoding="utf-8")
    remove(analysis, tmp_path / "fenics_contact")
    command = [sys.executable, "-c", PROGRAM]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    where, *refused = ran.stdout.splitlines()
    assert Path(where).is_relative_to(tmp_path)
    assert refused and all(f"unknown key '{key or analysis}'" in line for line in refused), refused
    assert any(line.startswith("asking.toml") for line in refused)
    assert (tmp_path / "out" / "result.json").exists()
