"""What a command does not need is not loaded: so it starts fast (benchmarks/start_up.py)."""

import subprocess
import sys

import pytest

from fenics_contact.cli import program
from tests.scenes import ROOT

pytestmark = pytest.mark.serial

FENICSX = {"dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "dolfinx_solver"}
LIBRARIES = {"numpy", "scipy", "pydantic", "rich", "tomlkit"}
PICTURES = {"pyvista", "vtk", "vtkmodules", "matplotlib", "plotly"}
# Of a slab on a mesh of Gmsh's, whose process is another.
NOT_OF_A_RUN = PICTURES | {
    *("gmsh", "scipy.optimize", "scipy.integrate"),
    *("rich.progress", "sympy", "hypothesis", "pytest"),
    *("fenics_contact.simulation.adaptive", "fenics_contact.report"),
    *("fenics_contact.verification", "fenics_contact.cli.new_scene"),
    *("fenics_contact.cli.completion", "fenics_contact.scene.schema"),
    "fenics_contact.scene.messages.toml_slips",
    "pint",
}


def loaded(code):
    """Modules that are loaded after some code, and its first line of output."""
    code = f"{code}\nimport sys; print(); print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    return set(lines[-1].split()), lines[0]


def test_the_package_and_its_version_load_nothing():
    found, said = loaded("import fenics_contact; print(fenics_contact.__version__)")
    assert said.startswith("0.")
    assert not found & (FENICSX | LIBRARIES | PICTURES)


def test_the_version_of_dolfinx_is_said_without_loading_it():
    found, said = loaded("from fenics_contact.cli.program import main; main(['--version'])")
    assert not found & (FENICSX | LIBRARIES | PICTURES)
    _, imported = loaded("from mpi4py import MPI; import dolfinx; print(dolfinx.__version__)")
    assert said.endswith(f", with dolfinx {imported}")


def test_the_version_of_dolfinx_may_stand_elsewhere(monkeypatch):
    """Debian's package reads it from metadata; in neither place, dolfinx itself is asked."""
    known = program.dolfinx_version()
    monkeypatch.setattr(program, "_ASSIGNED", program.re.compile("no such (line)"))
    monkeypatch.setattr("importlib.metadata.version", {"fenics-dolfinx": "0.9.0"}.__getitem__)
    assert program.dolfinx_version() == "0.9.0"
    monkeypatch.undo()
    monkeypatch.setattr(program, "_ASSIGNED", program.re.compile("no such (line)"))
    assert program.dolfinx_version() == known


def test_help_loads_nothing():
    code = "from fenics_contact.cli.program import main\ntry: main(['--help'])\n"
    found, _ = loaded(f"{code}except SystemExit: pass")
    assert not found & (FENICSX | LIBRARIES | PICTURES)


@pytest.mark.parametrize("words", [["schema"], ["materials"], ["completion", "bash"]], ids=" ".join)
def test_texts_are_printed_without_fenicsx(words):
    found, _ = loaded(f"from fenics_contact.cli.program import main; assert main({words}) == 0")
    assert not found & (FENICSX | PICTURES | {"scipy", "gmsh"})


def test_a_run_loads_only_what_it_needs(tmp_path):
    words = ["run", "demos/slab.toml", "--out", str(tmp_path), "--quiet"]
    found, _ = loaded(f"from fenics_contact import main; assert main({words}) == 0")
    assert found >= {"dolfinx", "scipy.sparse", "fenics_contact.simulation.scene_run"}
    assert not found & NOT_OF_A_RUN


@pytest.mark.parametrize("first", ["dolfinx", "petsc4py.PETSc", "fenics_contact.common.parallel"])
def test_the_wheel_s_own_order_of_imports_is_kept(first):
    """``dolfinx_solver``, where there is one, before dolfinx and PETSc."""
    found, _ = loaded(f"import fenics_contact, {first}, dolfinx")
    order = [name for name in found if name == "dolfinx_solver"]
    from importlib.util import find_spec

    assert bool(order) == (find_spec("dolfinx_solver") is not None)
