"""Resultants and rotations in what runs do with loads: sweeps, resuming, accuracy, exploring."""

import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import Run, Steps, Study, load_scene, run
from fenics_contact.explore.keys import moved_keys
from fenics_contact.mesh.loading import load_body
from tests.messages import refused
from tests.problem.test_load_kinds import SCENE, WITHOUT_ERRORS
from tests.scenes import ROOT
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.simulation.sweeps.inline import inline, rows_of, swept

assert inline  # a fixture
pytestmark = [pytest.mark.serial, pytest.mark.errors]
LOAD = "force = [3, 4]\nmoment = 2\nat = [1.5, 0.5]"
SPIN = 'on = "slab"\nrotation = { at = [0, 0.5], speed = 30 }'


@pytest.fixture
def scene(tmp_path):
    def written(load, more="", cells=12, steps=1):
        path = tmp_path / "pressed.toml"
        mesh = ROOT / "meshes" / "slab.geo"
        text = SCENE.format(mesh=mesh, load=load, cells=cells, steps=steps, more=more)
        if load is SPIN:
            text = text.replace('on = "right"\n', "").replace("= 0.3", "= 0.3\ndensity = 1e-3", 1)
        path.write_text(text)
        return path

    return written


def test_sweeps_vary_them(scene, tmp_path, inline):
    path = scene(LOAD, WITHOUT_ERRORS)
    key = "load.0.moment"
    swept(path, [f"{key}=1,3"], tmp_path / "out")
    forces = [float(row["normal_force"]) for row in rows_of(tmp_path / "out")]
    for force, size in zip(forces, (1, 3), strict=True):
        like = run(load_scene(path, [f"{key}={size}"])).quantities["normal_force"]
        assert force == pytest.approx(like, rel=1e-9)
    assert forces[0] != pytest.approx(forces[1], rel=1e-3)


def test_sweeps_vary_speeds_and_densities(scene, tmp_path, inline):
    path = scene(SPIN, WITHOUT_ERRORS)
    keys = ["load.0.rotation.speed=20,40", "material.density=1e-3,2e-3"]
    swept(path, keys, tmp_path / "out")
    for row in rows_of(tmp_path / "out"):
        changes = [f"{key}={row[key]}" for key in ("load.0.rotation.speed", "material.density")]
        like = run(load_scene(path, changes)).quantities["normal_force"]
        assert float(row["normal_force"]) == pytest.approx(like, rel=1e-9)


@pytest.mark.parametrize("load", [LOAD, SPIN], ids=["force", "rotation"])
def test_runs_go_on_with_them(scene, tmp_path, load):
    asked = load_scene(scene(load, WITHOUT_ERRORS, steps=2))
    body = load_body(asked.mesh, 2, MPI.COMM_SELF)
    longer = dataclasses.replace(asked, steps=Steps(times=(0.5, 1.0, 1.5)))
    whole = Run(longer, body.mesh.comm, body).solve()
    stopped_after(asked, body, tmp_path, 1)
    found = resumed(longer, body, tmp_path)
    forces = [[step.quantities["normal_force"] for step in one.steps] for one in (whole, found)]
    assert forces[1] == pytest.approx(forces[0], rel=1e-8) and len(forces[0]) == 3
    with refused("resume_with_another_load"):
        resumed(dataclasses.replace(longer, load=(longer.load[0].times(2.0),)), body, tmp_path)


@pytest.mark.parametrize("load", [LOAD, SPIN], ids=["force", "rotation"])
def test_an_accuracy_is_reached_under_them(scene, load):
    found = run(load_scene(scene(load, "[accuracy]\nnormal_force = 2e-3", cells=6)))
    assert found.exit_code == 0 and len(found.levels) > 1
    assert found.errors["normal_force"]["total"] <= 2e-3 * abs(found.quantities["normal_force"])
    fine = run(load_scene(scene(load, WITHOUT_ERRORS, cells=48))).quantities["normal_force"]
    assert abs(found.quantities["normal_force"] - fine) < 3e-3 * abs(fine)


def test_pages_move_their_numbers(scene):
    keys = {one.key for one in moved_keys(Study(load_scene(scene(LOAD, WITHOUT_ERRORS))))}
    assert {"load.0.force.0", "load.0.force.1", "load.0.moment"} <= keys
    assert not any(key.startswith("load.0.at") for key in keys)  # places have no scale
