"""Scenes as files: what is written is read as the same scene, whatever it holds."""

import dataclasses
import json
import pathlib
import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    HalfSpace,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Path,
    Point,
    Profile,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    load_scene,
    main,
)
from fenics_contact.common.parallel import on_root
from fenics_contact.mesh.loading import load_body
from fenics_contact.report.page.templates import html
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.writing import scene_text, write_scene
from fenics_contact.simulation.output import run_folder as files
from tests.random.scenes import draw
from tests.scenes import ROOT, SLAB, slab

COMM = MPI.COMM_WORLD
DEMOS = sorted((ROOT / "demos").glob("*.toml"))


def again(scene, folder):
    """The scene that is read from what is written of one."""
    path = folder / "scene.toml"
    path.write_text(scene_text(scene), encoding="utf-8")
    read = load_scene(path)
    assert len(read.mesh) == len(scene.mesh)
    for found, meant in zip(read.mesh, scene.mesh, strict=True):
        assert found.file == str(folder / meant.file)
    return dataclasses.replace(read, mesh=scene.mesh)


@pytest.mark.serial
@pytest.mark.parametrize("demo", DEMOS, ids=lambda path: path.stem)
def test_demos_are_read_as_they_were(demo, tmp_path):
    scene = load_scene(demo)
    write_scene(scene, tmp_path)
    read = load_scene(tmp_path / "scene.toml")
    for found, meant in zip(read.mesh, scene.mesh, strict=True):
        assert (ROOT / found.file).resolve() == (ROOT / meant.file).resolve()
    assert dataclasses.replace(read, mesh=scene.mesh) == scene


@pytest.mark.serial
def test_scenes_at_random_are_read_as_they_were(tmp_path):
    kinds = set()
    for number in range(150):
        random = draw(11, number)
        scene = dataclasses.replace(random.scene, mesh=MeshSource("box.msh"))
        assert again(scene, tmp_path) == scene, scene_text(scene)
        kinds.add(random.kind)
    assert len(kinds) > 4


@pytest.mark.serial
def test_every_kind_of_value_is_read_as_it_was(tmp_path):
    """Keys of all tables, with signs, lengths and numbers that are easily written wrongly."""
    odd = 'a "quoted" \\ back\nslash\ttab\x7f\x01 é 中 # [x]'
    profile = Profile("x", tuple(np.linspace(0, 1, 40)), tuple(np.linspace(0.1, 3, 40)))
    obstacle = Obstacle(shape="sphere", radius=0.1 + 0.2, normal=(0, -0.0, -1), force=1e-12)
    scene = Scene(
        title=odd,
        kinematics="3D",
        mesh=(
            MeshSource("a b.geo", name="one", parameters={"odd key": 1e20, "n": 3}, curvature=7),
            MeshSource("c.msh", name="two", groups={"held": (3, 4), "free": ()}),
        ),
        material=(
            Material(1000, 0.3, on="one"),
            Material(stiffness=np.diag([5.0, 5, 5, 1, 1, 1 / 3]), on="two"),
        ),
        support=(Support("two.held", {"x": 0, "z": profile}, path=Path((0, 2), (1, -1))),),
        load=(Load("one.s", traction=(profile, 0, -0.5)), Load("two.s", pressure=-3)),
        contact=(
            Contact("one.c", obstacle=obstacle, friction_coefficient=profile, name=odd),
            Contact("two.c", foundation_stiffness=2, regularisation_parameter=5e-324 + 1e-9),
            Contact("one.d", against="two.d", slave="on", law="incremental", contact="bonded"),
        ),
        point=(Point("tip", (0, 1, 1 / 3)),),
        accuracy=Accuracy(main=1e-3, contact_area=1e-2, max_dofs=1234),
        steps=Steps(number=10, automatic=True, area_change=0.1),
        solver=SolverSettings(branches=True, tolerance=1e-9, errors="none"),
    )
    assert again(scene, tmp_path) == scene
    half_space = dataclasses.replace(scene, load=(), half_space=HalfSpace(on=("one.far",)))
    assert again(half_space, tmp_path) == half_space


@pytest.mark.serial
@settings(max_examples=200, deadline=None)
@given(
    title=st.text(st.characters(exclude_categories=["Cs"])),
    numbers=st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=2, max_size=40),
)
def test_any_text_and_any_number_are_read_as_they_were(title, numbers):
    scene = dataclasses.replace(
        slab(), title=title, load=tuple(Load("s", body_force=(x, -x)) for x in numbers)
    )
    read = tomllib.loads(scene_text(scene))
    assert read.get("title", "") == title
    assert [load["body_force"] for load in read["load"]] == [[x, -x] for x in numbers]


def test_what_toml_cannot_hold_is_said(folder):
    scene = Scene(
        title="was it made in Python?",
        kinematics="plane stress",
        mesh=MeshSource(SLAB),
        material=Material(1000, 0.3),
        load=(Load("right", pressure=lambda x: x[0]),),
    )
    text = scene_text(scene)
    assert text.startswith("# This file cannot be run")
    assert tomllib.loads(text)["load"][0]["pressure"] == "<lambda>, made in Python"
    without = dataclasses.replace(scene, load=())
    assert not scene_text(without).startswith("# This file cannot be run")
    of_python = scene_text(dataclasses.replace(without, mesh=()))
    assert of_python.startswith("# This file cannot be run")
    assert tomllib.loads(of_python)["mesh"] == "made in Python"


def test_a_mesh_that_was_passed_is_not_that_of_the_scene(folder):
    scene = slab(held=False)
    body = load_body(scene.mesh, 2, COMM)
    files.solve_and_write(Run(scene, COMM, body), folder)
    text = on_root(COMM, lambda: (folder / "scene.toml").read_text())
    assert text.startswith("# This file cannot be run")
    assert tomllib.loads(text)["mesh"] == "made in Python"


@pytest.mark.serial
def test_a_run_is_made_again_from_its_folder(tmp_path, monkeypatch):
    """With what ``--set`` changed, from another folder, though the first was moved."""
    (tmp_path / "project").mkdir()
    (tmp_path / "project/slab.geo").write_text((ROOT / "meshes/slab.geo").read_text())
    demo = (ROOT / "demos/slab.toml").read_text().replace("../meshes/", "")
    (tmp_path / "project/mine.toml").write_text(demo)
    monkeypatch.chdir(tmp_path / "project")
    settings = ["--set", "contact.0.friction_coefficient=0.2", "--quiet"]
    assert main(["run", "mine.toml", "--out", "deep/er", *settings]) == 0
    (tmp_path / "project").rename(tmp_path / "moved")
    monkeypatch.chdir(tmp_path)
    made = "moved/deep/er/scene.toml"
    assert main(["run", made, "--out", "again", "--quiet"]) == 0
    first, second = (
        json.loads((tmp_path / place / "result.json").read_text())
        for place in ("moved/deep/er", "again")
    )
    assert first["quantities"] == second["quantities"]
    assert load_scene(made).contact[0].friction_coefficient == 0.2


@pytest.mark.serial
def test_a_file_of_the_user_is_never_lost(tmp_path):
    own = tmp_path / "scene.toml"
    write_scene(load_scene(ROOT / "demos/slab.toml"), tmp_path)
    text = own.read_text().split("\n", 1)[1] + "# my own words\n"
    own.write_text(text)
    write_scene(load_scene(own), tmp_path)  # the same scene
    said = write_scene(load_scene(own, ["contact.0.pressure=200"]), tmp_path)
    assert own.read_text() == text
    assert tomllib.loads(said)["contact"][0]["pressure"] == 200
    own.write_text("[not a scene")
    write_scene(load_scene(ROOT / "demos/slab.toml"), tmp_path)
    assert own.read_text() == "[not a scene"


@pytest.mark.serial
def test_what_was_solved_is_known_whatever_becomes_of_the_file(tmp_path):
    """A scene.toml of the user's in the run's folder, changed on the command line, then edited."""
    own = tmp_path / "scene.toml"
    demo = (ROOT / "demos/slab.toml").read_text().replace("../meshes", str(ROOT / "meshes"))
    own.write_text(demo)
    run = ["run", str(own), "--out", str(tmp_path), "--quiet"]
    assert main([*run, "--set", "contact.0.pressure=200"]) == 0
    assert own.read_text() == demo
    assert main([*run, "--set", "contact.0.pressure=200", "--set", "steps.end=2", "--resume"]) == 0
    own.write_text(demo.replace("pressure = 300", "pressure = 900"))
    assert main(["report", str(tmp_path), "--quiet"]) == 0
    result = json.loads((tmp_path / "result.json").read_text())
    assert scene_of_text(result["scene"], own).contact[0].pressure == 200
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert html(result["scene"]) in page and "pressure = 900" not in page
    assert "Save the scene above as solved.toml" in page
    (tmp_path / "solved.toml").write_text(result["scene"], encoding="utf-8")
    solved, said = load_scene(tmp_path / "solved.toml"), load_scene(own, ["contact.0.pressure=200"])
    assert pathlib.Path(solved.mesh[0].file).resolve() == ROOT / "meshes/slab.geo"
    ours = dataclasses.replace(said, steps=solved.steps, mesh=solved.mesh)
    assert solved == ours and solved.steps.end == 2


def test_levels_have_the_scene_of_the_user(folder):
    """Its paths are from the folder of the run, not from that of a level."""
    text = (ROOT / "demos/slab.toml").read_text().replace("../meshes", str(ROOT / "meshes"))
    on_root(COMM, lambda: (folder / "mine.toml").write_text("accuracy = 0.5\n" + text))
    scene = load_scene(folder / "mine.toml")
    files.solve_levels_and_write(Run(scene, COMM), folder / "out")
    read = on_root(COMM, lambda: load_scene(folder / "out/scene.toml"))
    assert read.accuracy == scene.accuracy
    kept = on_root(COMM, lambda: json.loads((folder / "out/result.json").read_text())["scene"])
    assert kept == on_root(COMM, lambda: (folder / "out/scene.toml").read_text())
    found = on_root(COMM, lambda: str(pathlib.Path(read.mesh[0].file).resolve()))
    assert found == str(ROOT / "meshes/slab.geo")
