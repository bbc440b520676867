"""Kinds of loads: the program's own, and that one that a file registers has all that these have."""

import dataclasses
import sys
from pathlib import Path

import pytest
from mpi4py import MPI

from fenics_contact import (
    Load,
    Material,
    Run,
    Scene,
    Steps,
    Support,
    load_scene,
    main,
    run,
)
from fenics_contact.analyses.derivatives.means import driven
from fenics_contact.common.errors import SceneError
from fenics_contact.contact.laws import allowed
from fenics_contact.mesh.loading import load_body
from fenics_contact.problem.loads import LAWS
from fenics_contact.scene.loading.load_kinds import kinds_of
from fenics_contact.scene.reference import keys_of
from fenics_contact.scene.schema import scene_schema
from tests.messages import refused
from tests.problem import shear_load
from tests.report.page.pages import page_of
from tests.scenes import ROOT, box_body
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.simulation.sweeps.inline import inline, rows_of, swept

assert inline  # a fixture
pytestmark = [pytest.mark.serial, pytest.mark.errors]
KEY = "load.0.shear"
SCENE = """
kinematics = "plane strain"
[units]
length = "mm"
force = "N"
[mesh]
file = "{mesh}"
parameters = {{ length = 1, height = 1, cells_along = {cells}, cells_across = {cells} }}
[material]
youngs_modulus = 1000
poissons_ratio = 0.3
[[support]]
on = "bottom"
displacement = {{ x = 0, y = 0 }}
[[load]]
on = "right"
{load}
[[contact]]
on = "top"
[contact.obstacle]
shape = "parabola"
radius = 2
position = [0.6, 1.0]
indentation = 0.02
[steps]
number = {steps}
{more}
"""
WITHOUT_ERRORS = '[solver]\nerrors = "none"'
# The normal of the right side points along x, its left is y.
SHEAR, TRACTION = 'shear = "30 MPa"', "traction = [0, 30]"


@pytest.fixture(autouse=True)
def registered():
    shear_load.register()
    yield
    shear_load.unregister()


@pytest.fixture
def scene(tmp_path):
    def written(load, more="", cells=12, steps=1):
        path = tmp_path / "pressed.toml"
        mesh = ROOT / "meshes" / "slab.geo"
        path.write_text(SCENE.format(mesh=mesh, load=load, cells=cells, steps=steps, more=more))
        return path

    return written


def test_every_kind_of_the_scene_has_a_law_and_every_law_a_kind():
    assert list(kinds_of(Load)) == list(LAWS)
    assert [law.kind for law in LAWS.values()] == list(LAWS)


def test_it_is_the_traction_along_the_boundary_with_its_bars(scene):
    found, expected = (run(load_scene(scene(load))) for load in (SHEAR, TRACTION))
    assert found.exit_code == 0
    for name in ("normal_force", "strain_energy", "external_work", "max_contact_pressure"):
        assert found.quantities[name] == pytest.approx(expected.quantities[name], rel=1e-10)
        bar = found.errors[name]["total"]
        assert bar == pytest.approx(expected.errors[name]["total"], rel=1e-6) and bar > 0
    without = run(load_scene(scene("shear = 0", WITHOUT_ERRORS)))
    assert abs(without.quantities["normal_force"] / found.quantities["normal_force"] - 1) > 0.05


def test_a_bar_holds_what_a_finer_mesh_finds(scene):
    coarse = run(load_scene(scene(SHEAR)))
    fine = run(load_scene(scene(SHEAR, WITHOUT_ERRORS, cells=48))).quantities["normal_force"]
    bar = coarse.errors["normal_force"]["total"]
    assert abs(coarse.quantities["normal_force"] - fine) < bar < 0.1 * fine


def test_an_accuracy_is_reached_under_it(scene):
    found = run(load_scene(scene(SHEAR, "[accuracy]\nnormal_force = 2e-3", cells=6)))
    assert found.exit_code == 0 and len(found.levels) > 1
    assert found.errors["normal_force"]["total"] <= 2e-3 * found.quantities["normal_force"]


def test_it_has_the_derivatives_of_the_traction_and_of_runs(scene):
    asked = '[derivatives]\nof = ["normal_force"]\nby = ["{}"]\n' + WITHOUT_ERRORS
    found = run(load_scene(scene(SHEAR, asked.format(KEY)))).derivatives["normal_force"][KEY]
    key = "load.0.traction.1"
    like = run(load_scene(scene(TRACTION, asked.format(key)))).derivatives["normal_force"][key]
    for name in ("value", "discrete", "normalised"):
        assert getattr(found, name) == pytest.approx(getattr(like, name), rel=1e-6)
    path = scene(SHEAR, WITHOUT_ERRORS)
    ends = [run(load_scene(path, [f"{KEY}={size}"])) for size in (29.97, 30.03)]
    low, high = (end.quantities["normal_force"] for end in ends)
    assert found.discrete == pytest.approx((high - low) / 0.06, rel=1e-4)


def test_a_small_one_is_varied_by_as_much_as_pressures(scene):
    """Windows of means would be empty if it were varied by itself, or by a length."""
    asked = '[derivatives]\nof = ["normal_force"]\nby = ["{}"]\n' + WITHOUT_ERRORS
    loads = {KEY: "shear = 1e-6", "load.0.traction.1": "traction = [0, 1e-6]"}
    found, like = (
        run(load_scene(scene(load, asked.format(key)))).derivatives["normal_force"][key]
        for key, load in loads.items()
    )
    assert found.value == pytest.approx(like.value, rel=1e-6) and found.value != 0


def test_a_multiple_of_all_loads_has_it(scene):
    assert driven(load_scene(scene(SHEAR)), 1.5).load == (Load("right", shear=45),)


def test_sweeps_vary_it(scene, tmp_path, inline):
    swept(scene(SHEAR, WITHOUT_ERRORS), [f"{KEY}=10,20 MPa"], tmp_path / "out")
    for row, size in zip(rows_of(tmp_path / "out"), (10, 20), strict=True):
        like = run(load_scene(scene(TRACTION, WITHOUT_ERRORS), [f"load.0.traction.1={size}"]))
        expected = like.quantities["normal_force"]
        assert float(row["normal_force"]) == pytest.approx(expected, rel=1e-9)


def test_commands_and_the_processes_of_a_sweep_import_it(scene, tmp_path, monkeypatch, capsys):
    path = scene(SHEAR, WITHOUT_ERRORS, cells=6)
    expected = run(load_scene(path, [f"{KEY}=20"])).quantities["normal_force"]
    text = Path(shear_load.__file__).read_text(encoding="utf-8")
    (tmp_path / "own_shear.py").write_text(f"{text}\n\nregister()\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setattr(allowed, "_modules", {})
    command = ["sweep", str(path), "--vary", f"{KEY}=20", "--out", "out", "--quiet"]
    shear_load.unregister()
    try:
        assert main(command) == 2
        assert main([*command, "--laws", "own_shear"]) == 0
        capsys.readouterr()
        assert main(["schema", "--laws", "own_shear"]) == 0
        schema = capsys.readouterr()
        shear_load.unregister()
    finally:
        shear_load.register()
        sys.modules.pop("own_shear", None)
    assert '"shear"' in schema.out
    (row,) = rows_of(tmp_path / "out")
    assert float(row["normal_force"]) == pytest.approx(expected, rel=1e-9)


def test_runs_go_on_with_it_and_beyond_their_end(scene, tmp_path):
    asked = load_scene(scene(SHEAR, WITHOUT_ERRORS, steps=2))
    body = load_body(asked.mesh, 2, MPI.COMM_SELF)
    longer = dataclasses.replace(asked, steps=Steps(times=(0.5, 1.0, 1.5)))
    whole = Run(longer, body.mesh.comm, body).solve()
    stopped_after(asked, body, tmp_path, 1)
    found = resumed(longer, body, tmp_path)
    forces = [[step.quantities["normal_force"] for step in one.steps] for one in (whole, found)]
    assert forces[1] == pytest.approx(forces[0], rel=1e-8) and len(forces[0]) == 3
    other = dataclasses.replace(longer, load=(Load("right", shear=31),))
    with refused("resume_with_another_load"):
        resumed(other, body, tmp_path)


def test_a_run_from_before_it_was_known_goes_on(scene, tmp_path):
    shear_load.unregister()
    try:
        asked = load_scene(scene(TRACTION, WITHOUT_ERRORS, steps=2))
        body = load_body(asked.mesh, 2, MPI.COMM_SELF)
        stopped_after(asked, body, tmp_path, 1)
    finally:
        shear_load.register()
    found = resumed(load_scene(scene(TRACTION, WITHOUT_ERRORS, steps=2)), body, tmp_path)
    assert found.exit_code == 0 and len(found.steps) == 2


def test_the_page_names_it(scene):
    found = run(load_scene(scene(SHEAR, WITHOUT_ERRORS)))
    assert "shear on right" in found.model.terms
    assert "shear on right" in page_of(found.as_dict())


def test_editors_and_the_documentation_know_it():
    said = scene_schema()["$defs"]["Load"]["properties"]["shear"]
    assert said["description"].startswith("Along a straight boundary in the plane (stress)")
    key = next(key for key in keys_of(Load) if key.name == "shear")
    assert key.accepts == "number or a profile"


def test_what_it_does_not_take_is_refused_in_a_sentence(scene):
    with refused("load_gives_none_with_shear", SceneError):
        Load("right", shear=3, pressure=1)
    with refused("unknown_key_sheer"):
        load_scene(scene("sheer = 3"))
    with refused("shear_in_mm"):
        load_scene(scene('shear = "3 mm"'))
    with refused("load_key_is_there_already", ValueError):
        shear_load.register()


def test_a_body_without_such_a_place_is_refused():
    solid = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("x0", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("x1", shear=3),),
    )
    with refused("shear_needs_a_plane_model"):
        run(solid, MPI.COMM_SELF, box_body((2, 2, 2), (1, 1, 1)))
