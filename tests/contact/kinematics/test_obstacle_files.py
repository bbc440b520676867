"""Rigid obstacles from files: against the formulas of the same shapes."""

import dataclasses
import struct
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    DerivativeRequest,
    InputError,
    Material,
    MeshSource,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
    Units,
    load_scene,
    run,
)
from fenics_contact.analytic.obstacle_shapes import Sizes, shape_of
from fenics_contact.contact.facet_obstacle import FacetObstacle
from fenics_contact.mesh import rigid_surface
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.rigid_surface import load_surface
from fenics_contact.scene.writing import text_beside
from fenics_contact.simulation import fingerprint
from tests.mesh.test_loading import with_gmsh
from tests.messages import refused
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
RADIUS = 8.0
DOWN = Sizes(np.array([0.0, 0.0, -1.0]), RADIUS, 0.0)
BOX = np.array([[x, y, z] for z in (0, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
SIDES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


@pytest.fixture
def ball(folder):
    """A sphere that touches z = 0 from above, as STEP."""
    path = folder / "ball.step"

    def save(gmsh):
        gmsh.model.occ.addSphere(0, 0, RADIUS, RADIUS)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))

    with_gmsh(save)
    return str(path)


def write_stl(path, corners, inwards=False):
    """Triangles (triangles, 3, 3) as a binary STL file."""
    if COMM.rank == 0:
        rows = corners[:, ::-1] if inwards else corners
        parts = [struct.pack("<12fH", 0, 0, 0, *row.ravel(), 0) for row in rows]
        path.write_bytes(b" " * 80 + struct.pack("<I", len(rows)) + b"".join(parts))
    COMM.barrier()
    return str(path)


def box():
    """Triangles of a box above z = 0, 2 by 2 wide."""
    return np.array([BOX[list(c)] for a, b, *rest in SIDES for c in ((a, b, rest[0]), (a, *rest))])


def strips(pieces, length):
    """A cylinder along y in long triangles, as CAD programs export it."""
    angles = np.linspace(0, 2 * np.pi, pieces + 1)
    ring = RADIUS * np.stack([np.cos(angles), np.zeros(pieces + 1), np.sin(angles)], axis=1)
    end = np.array([0, length / 2, 0])
    near, far = ring - end, ring + end
    found = []
    for i in range(pieces):
        found += [(near[i], near[i + 1], far[i]), (far[i], near[i + 1], far[i + 1])]
        found += [(near[i], -end, near[i + 1]), (far[i], far[i + 1], end)]
    return np.array(found)


def rays(count, slant):
    """Points below, and unit vectors upwards that are off the vertical by about a slant."""
    random = np.random.default_rng(5)
    points = np.c_[random.uniform(-3, 3, (count, 2)), random.uniform(-0.7, -0.2, count)]
    directions = np.c_[random.normal(0, slant, (count, 2)), np.ones(count)]
    return points, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def gaps(file, points, directions):
    return FacetObstacle(load_surface(file, "file", COMM)).gaps(points, directions, DOWN)


def test_gaps_to_a_ball_of_a_step_file_are_those_of_a_sphere(ball):
    """To 1e-6 of its radius, with slopes as the place and the ray move."""
    points, directions = rays(200, 0.1)
    found = gaps(ball, points, directions)
    np.testing.assert_allclose(
        found, shape_of("sphere").gaps(points, directions, DOWN), atol=1e-6 * RADIUS
    )
    moved = (points + 1j * np.array([0.3, -0.2, 0.5]), directions + 0.1j * directions[:, [1, 2, 0]])
    slopes = gaps(ball, *moved).imag
    step = 1e-20
    exact = shape_of("sphere").gaps(
        *(np.real(part) + step * 1j * np.imag(part) for part in moved), DOWN
    )
    np.testing.assert_allclose(slopes, exact.imag / step, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("inwards", [False, True])
def test_what_long_triangles_of_a_cylinder_miss_is_made_up_for(folder, inwards):
    """Straight ones miss .38 % of the radius, R (1 − cos(π/36)); less than a fifth is left."""
    file = write_stl(folder / "strips.stl", strips(36, 40.0), inwards)
    points, directions = rays(200, 0.0)
    points[:, 2] -= RADIUS
    exact = -np.sqrt(RADIUS**2 - points[:, 0] ** 2) - points[:, 2]
    missed = RADIUS * (1 - np.cos(np.pi / 36))
    assert np.abs(gaps(file, points, directions) - exact).max() < missed / 5


def brick(obstacle, cells=5) -> Scene:
    return Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        mesh=MeshSource(
            str(ROOT / "meshes" / "brick.geo"),
            parameters={"cells_along": cells, "cells_across": 3},
        ),
        support=(Support("bottom", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("top", friction_coefficient=0.3, obstacle=obstacle),),
        solver=SolverSettings(errors="none"),
    )


PLACE = {"position": (0.5, 0.5, 1.0), "normal": (0.0, 0.0, -1.0)}


def test_a_flat_side_of_a_file_presses_as_a_plane(folder):
    """Its edges are beyond the brick; as a punch of half the width it is smaller."""
    file = write_stl(folder / "box.stl", box())
    found = run(brick(Obstacle(file=file, indentation=0.02, **PLACE)))
    plane = run(brick(Obstacle(shape="plane", indentation=0.02, **PLACE)))
    assert found.passed
    force = plane.quantities["normal_force"]
    assert found.quantities["normal_force"] == pytest.approx(force, rel=1e-9)
    small = write_stl(folder / "small.stl", 0.3 * box())
    less = run(brick(Obstacle(file=small, indentation=0.02, **PLACE)))
    assert less.quantities["contact_area"] == pytest.approx(0.36, rel=0.01)
    assert less.quantities["normal_force"] < 0.9 * force


def test_a_ball_of_a_file_presses_as_a_sphere(ball):
    """By a force, which brings it up first; moved aside, it slides."""
    aside = {"force": 20.0, "displacement": (0.02, 0.0, 0.0), **PLACE}
    found = run(brick(Obstacle(file=ball, **aside)))
    sphere = run(brick(Obstacle(shape="sphere", radius=RADIUS, **aside)))
    assert found.passed
    for name in ("contact_area", "max_contact_pressure", "friction_force", "strain_energy"):
        expected = sphere.quantities[name]
        assert found.quantities[name] == pytest.approx(expected, rel=1e-4, abs=1e-5), name
    assert found.contacts[0].quantities["indentation"] == pytest.approx(
        sphere.contacts[0].quantities["indentation"], rel=1e-4
    )


def test_derivatives_by_its_place_are_those_of_finite_differences(ball):
    def placed(x, asked=None):
        obstacle = Obstacle(file=ball, indentation=0.03, normal=(0, 0, -1), position=(x, 0.5, 1.0))
        return dataclasses.replace(brick(obstacle, cells=4), derivatives=asked)

    key = "contact.0.obstacle.position.0"
    request = DerivativeRequest(of=("normal_force",), by=(key,))
    found = run(placed(0.3, request)).derivatives["normal_force"][key].discrete
    step = 1e-4
    sides = [run(placed(0.3 + sign * step)).quantities["normal_force"] for sign in (1, -1)]
    assert abs(found) > 0.1
    assert found == pytest.approx((sides[0] - sides[1]) / (2 * step), rel=1e-3)


def test_paths_are_from_the_folder_of_the_scene(folder, ball, monkeypatch):
    file = folder / "scene.toml"
    scene = brick(Obstacle(file=ball, indentation=0.02, **PLACE))
    if COMM.rank == 0:
        file.write_text(text_beside(scene, folder), encoding="utf-8")
    COMM.barrier()
    monkeypatch.chdir(folder)
    obstacle = load_scene(file).contact[0].obstacle
    assert load_surface(obstacle.file, "file", COMM).order == 2


def test_a_state_belongs_to_the_content_of_a_file_wherever_it_lies(folder):
    here, there = folder / "here.stl", folder / "there.stl"
    scenes = [
        brick(Obstacle(file=write_stl(path, box()), indentation=0.02, **PLACE))
        for path in (here, there)
    ]
    body = load_body(scenes[0].mesh, 3, COMM)
    first = fingerprint.of_scene(scenes[0], body)
    assert fingerprint.of_scene(scenes[1], body) == first
    write_stl(there, 0.3 * box())
    other = fingerprint.of_scene(scenes[1], body)
    assert fingerprint.differences(first, other) == ["contact"]


def test_numbers_of_a_file_in_another_unit_stay_and_scenes_with_units_refuse_it(folder, ball):
    """As of bodies; with units they would be others than the scene says."""
    metres = folder / "metres.step"
    if COMM.rank == 0:
        text = Path(ball).read_text(encoding="utf-8")
        assert text.count("SI_UNIT(.MILLI.,.METRE.)") == 1
        metres.write_text(text.replace(".MILLI.,.METRE.", "$,.METRE."), encoding="utf-8")
    COMM.barrier()
    points = load_surface(str(metres), "file", COMM).points
    assert points[:, 2].max() == pytest.approx(2 * RADIUS, rel=1e-6)
    scene = brick(Obstacle(file=str(metres), indentation=0.02, **PLACE))
    with refused("step_file_in_metres_beside_units"):
        Run(dataclasses.replace(scene, units=Units("mm", "N")))
    meshed = dataclasses.replace(scene, mesh=MeshSource(str(metres), size=4), contact=())
    with refused("step_file_in_metres_beside_units"):
        Run(dataclasses.replace(meshed, units=Units("mm", "N")))


def test_what_is_no_surface_is_refused(folder, ball):
    with refused("obstacle_file_missing"):
        Run(brick(Obstacle(file="nothing.stl", indentation=0.1, **PLACE)))
    with refused("obstacle_file_of_a_mesh"):
        Run(brick(Obstacle(file=str(ROOT / "meshes" / "brick.geo"), indentation=0.1, **PLACE)))
    damaged = folder / "damaged.step"
    empty = write_stl(folder / "empty.stl", np.zeros((0, 3, 3)))
    if COMM.rank == 0:
        damaged.write_text("no STEP file", encoding="utf-8")
    COMM.barrier()
    for name in (str(damaged), empty):
        with pytest.raises(Exception, match=r"obstacle\.file = '"):
            Run(brick(Obstacle(file=name, indentation=0.1, **PLACE)))
    flat = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        mesh=MeshSource(str(ROOT / "meshes" / "block.geo")),
        support=(Support("bottom", {"x": 0, "y": 0}),),
        contact=(Contact("top", obstacle=Obstacle(file=ball, indentation=0.1, normal=(0, -1))),),
    )
    with refused("obstacle_file_in_the_plane"):
        Run(flat)


def test_a_surface_that_takes_too_long_is_refused_without_a_key_for_more_time(ball, monkeypatch):
    monkeypatch.setattr(rigid_surface, "_TIME_LIMIT", 0.01)
    with pytest.raises(InputError, match=r"is not done after 0\.01 s.*; simplify the surface"):
        load_surface(ball, "contact[0].obstacle.file", COMM)


def test_a_file_is_given_in_place_of_a_shape():
    with refused("obstacle_file_and_shape", Exception):
        Obstacle(shape="plane", file="tool.stl")
