"""An obstacle that a file registers has all that the program's own have."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    DerivativeRequest,
    Material,
    Obstacle,
    Run,
    Scene,
    Steps,
    Support,
    load_scene,
    main,
    run,
)
from fenics_contact.common.errors import SceneError
from fenics_contact.contact.rigid_obstacle import RigidObstacle
from fenics_contact.scene.reference import keys_of
from fenics_contact.scene.schema import scene_schema
from tests.contact.kinematics import ellipse
from tests.messages import refused
from tests.report.test_gallery import draw_coarsely
from tests.scenes import ROOT, box_body, with_solver
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.simulation.sweeps.inline import inline, rows_of, swept

assert inline  # a fixture
COMM = MPI.COMM_WORLD
HALF_AXIS = 0.5
DEPTH = 0.005
SCENE = """
kinematics = "plane strain"
[mesh]
file = "{mesh}"
parameters = {{ length = 1, height = 1, cells_along = {cells}, cells_across = {cells} }}
[material]
youngs_modulus = 1000
poissons_ratio = 0.3
[[support]]
on = "bottom"
displacement = {{ x = 0, y = 0 }}
[[contact]]
on = "top"
[contact.obstacle]
shape = "ellipse"
radius = 1.5
position = [0.5, 1.0]
indentation = 0.02
{more}
"""
WITHOUT_ERRORS = '[solver]\nerrors = "none"'
BY = ("contact.0.obstacle.indentation", "contact.0.obstacle.radius")


@pytest.fixture(autouse=True)
def registered():
    ellipse.register()
    yield
    ellipse.unregister()


def pressed(shape, radius, depth=DEPTH, **more):
    obstacle = Obstacle(shape, radius=radius, position=(0.5, 1), indentation=depth)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle),),
        **more,
    )
    return with_solver(scene, errors="none")


@pytest.fixture
def scene(tmp_path):
    """A file of a scene of the ellipse, wide enough for the cells of a slab that is remeshed."""

    def written(more="", cells=16):
        path = tmp_path / "pressed.toml"
        mesh = ROOT / "meshes" / "slab.geo"
        path.write_text(SCENE.format(mesh=mesh, cells=cells, more=more))
        return path

    return written


def square():
    return box_body((40, 20), (1, 1))


def test_gaps_are_those_of_an_ellipse():
    """y = b (1 − √(1 − x²/a²)) below the apex, from a surface beneath it."""
    across = np.linspace(-0.9, 0.9, 7) * HALF_AXIS
    points = np.stack([0.5 + across, np.full(7, 0.8), np.zeros(7)], axis=1)
    normals = np.tile([0.0, 1.0], (7, 1))
    obstacle = Obstacle("ellipse", radius=HALF_AXIS, position=(0.5, 1))
    found = RigidObstacle(obstacle, "plane strain", normals, "it").gap(points, normals, None)
    height = HALF_AXIS / ellipse.RATIO
    expected = 0.2 + height * (1 - np.sqrt(1 - (across / HALF_AXIS) ** 2))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_its_force_is_that_of_its_curvature():
    """The radius of curvature at the apex is a²/b; a contact as narrow as this sees no more."""
    found = run(pressed("ellipse", HALF_AXIS), COMM, square())
    like = run(pressed("parabola", ellipse.RATIO * HALF_AXIS), COMM, square())
    assert found.exit_code == 0
    force, expected = (one.quantities["normal_force"] for one in (found, like))
    assert force == pytest.approx(expected, rel=0.02) and force != expected


def test_forces_have_derivatives_by_its_numbers():
    asked = DerivativeRequest(of=("normal_force",), by=BY)
    found = run(pressed("ellipse", HALF_AXIS, derivatives=asked), COMM, square()).derivatives

    def force(radius, depth):
        scene = pressed("ellipse", radius, depth)
        return run(scene, COMM, square()).quantities["normal_force"]

    by_depth = force(HALF_AXIS, 1.001 * DEPTH) - force(HALF_AXIS, 0.999 * DEPTH)
    by_radius = force(1.001 * HALF_AXIS, DEPTH) - force(0.999 * HALF_AXIS, DEPTH)
    slopes = found["normal_force"]
    assert slopes[BY[0]].discrete == pytest.approx(by_depth / (0.002 * DEPTH), rel=2e-3)
    assert slopes[BY[1]].discrete == pytest.approx(by_radius / (0.002 * HALF_AXIS), rel=2e-2)


@pytest.mark.serial
@pytest.mark.errors
def test_it_has_a_bar_that_holds(scene):
    found = run(load_scene(scene(cells=24)))
    fine = run(load_scene(scene(WITHOUT_ERRORS, cells=64))).quantities["normal_force"]
    bar = found.errors["normal_force"]["total"]
    assert abs(found.quantities["normal_force"] - fine) < bar < 0.05 * fine


@pytest.mark.serial
@pytest.mark.errors
def test_an_accuracy_is_reached_under_it(scene):
    found = run(load_scene(scene("[accuracy]\nnormal_force = 3e-3", cells=8)))
    fine = run(load_scene(scene(WITHOUT_ERRORS, cells=64))).quantities["normal_force"]
    force, bar = found.quantities["normal_force"], found.errors["normal_force"]["total"]
    assert found.exit_code == 0 and len(found.levels) > 1
    assert abs(force - fine) < bar <= 3e-3 * force


@pytest.mark.serial
def test_sweeps_vary_its_numbers(scene, tmp_path, inline):
    """Wider ones are flatter, and press harder at the same depth."""
    path = scene(WITHOUT_ERRORS)
    swept(path, [f"{BY[1]}=1.2,1.5"], tmp_path / "out")
    found = [float(row["normal_force"]) for row in rows_of(tmp_path / "out")]
    runs = [run(load_scene(path, [f"{BY[1]}={size}"])) for size in (1.2, 1.5)]
    assert found == pytest.approx([one.quantities["normal_force"] for one in runs], rel=1e-8)
    assert found[0] < found[1]


@pytest.mark.serial
def test_the_page_of_a_run_has_it(scene, tmp_path, monkeypatch):
    draw_coarsely(monkeypatch)
    folder = tmp_path / "out"
    path = scene(WITHOUT_ERRORS, cells=8)
    assert main(["run", str(path), "--out", str(folder), "--quiet"]) in (0, 4)
    assert main(["report", str(folder), "--quiet"]) == 0
    (page,) = folder.glob("*.html")
    assert "ellipse" in page.read_text(encoding="utf-8")


@pytest.mark.serial
def test_runs_go_on_with_it(tmp_path):
    scene, body = pressed("ellipse", HALF_AXIS, steps=Steps(number=3)), square()
    whole = Run(scene, COMM, body).solve()
    stopped_after(scene, body, tmp_path, 1)
    found = resumed(scene, body, tmp_path)
    force, expected = (one.quantities["normal_force"] for one in (found, whole))
    assert force == pytest.approx(expected, rel=1e-8)


def test_editors_and_the_documentation_know_it():
    assert "ellipse" in str(scene_schema()["$defs"]["Obstacle"]["properties"]["shape"])
    shape = next(key for key in keys_of(Obstacle) if key.name == "shape")
    assert '`"ellipse"`' in shape.accepts


def test_it_is_refused_where_it_does_not_fit():
    scene = dataclasses.replace(pressed("ellipse", HALF_AXIS), kinematics="axisymmetric")
    with refused("no_ellipse_in_axisymmetric_models"):
        run(scene, COMM, square())
    with refused("no_such_shape_elipse", SceneError):
        Obstacle("elipse", radius=1)
    with refused("ellipse_without_radius", SceneError):
        Obstacle("ellipse")
    with refused("shape_is_there_already", ValueError):
        ellipse.register()
