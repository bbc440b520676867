"""Gaps along rays: every shape against its own equation."""

import numpy as np
import pytest
import ufl
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import Contact, Material, Obstacle, Profile, Scene, Support, run
from fenics_contact.contact.rigid_obstacle import RigidObstacle
from tests.messages import refused
from tests.scenes import box_body

RANDOM = np.random.default_rng(7)
UP = np.array([[0.0, 1.0]])
X2 = ufl.SpatialCoordinate(mesh.create_unit_square(MPI.COMM_SELF, 1, 1))
X3 = ufl.SpatialCoordinate(mesh.create_unit_cube(MPI.COMM_SELF, 1, 1, 1))


def gap_of(obstacle, points, normals, kinematics="3D"):
    points, normals = np.atleast_2d(points).astype(float), np.atleast_2d(normals).astype(float)
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    padded = np.zeros((len(points), 3))
    padded[:, : points.shape[1]] = points
    made = RigidObstacle(obstacle, kinematics, normals, "contact[0].obstacle")
    return made.gap(padded, normals, X3 if kinematics == "3D" else X2), padded, normals


def random_rays(count=200):
    """Points below the plane z = 0 and rays that go up, some of them sideways."""
    points = RANDOM.uniform(-1, 1, (count, 3)) - [0, 0, 2]
    normals = RANDOM.normal(size=(count, 3)) * 0.4 + [0, 0, 1]
    return points, normals


SHAPES = {
    "plane": (Obstacle("plane", normal=(0.2, -0.1, -1)), lambda y: 0.2 * y[0] - 0.1 * y[1] - y[2]),
    "paraboloid": (
        Obstacle("paraboloid", radius=3, normal=(0, 0, -1)),
        lambda y: y[2] - (y[0] ** 2 + y[1] ** 2) / 6,
    ),
    "sphere": (
        Obstacle("sphere", radius=3, normal=(0, 0, -1), position=(0, 0, 0.5)),
        lambda y: y[0] ** 2 + y[1] ** 2 + (y[2] - 3.5) ** 2 - 9,
    ),
    "cylinder": (
        Obstacle("cylinder", radius=3, normal=(0, 0, -1), along=(0, 2, 0)),
        lambda y: y[0] ** 2 + (y[2] - 3) ** 2 - 9,
    ),
    "parabola": (
        Obstacle("parabola", radius=3, normal=(0, 0, -1), along=(1, 0, 0)),
        lambda y: y[2] - y[1] ** 2 / 6,
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_the_ray_meets_the_surface_and_not_before(shape):
    obstacle, surface = SHAPES[shape]
    points, normals = random_rays()
    gap, points, normals = gap_of(obstacle, points, normals)
    hit = np.isfinite(gap)
    assert hit.sum() > 100
    reached = points[hit] + gap[hit, None] * normals[hit]
    assert np.abs(surface(reached.T)).max() < 1e-9
    assert (gap[hit] > 0).all()  # all points start outside
    outside = np.sign(surface(points[hit].T))
    for share in np.linspace(0.05, 0.95, 19):
        between = points[hit] + share * gap[hit, None] * normals[hit]
        assert (np.sign(surface(between.T)) == outside).all()


@pytest.mark.parametrize("shape", SHAPES)
def test_points_inside_have_negative_gaps(shape):
    obstacle, surface = SHAPES[shape]
    points = np.array([[0.1, -0.2, 0.7], [0.3, 0.2, 0.6]])
    gap, points, normals = gap_of(obstacle, points, [[0.1, 0, 1], [0, 0, 1]])
    assert (gap < 0).all()
    assert np.abs(surface((points + gap[:, None] * normals).T)).max() < 1e-9


def test_flat_surface_gives_the_formulas():
    radii = np.array([[0.0, 0], [1, 0], [2.5, 0]])
    normals = np.repeat(UP, 3, axis=0)
    gap, *_ = gap_of(Obstacle("paraboloid", radius=8), radii, normals, "axisymmetric")
    assert gap == pytest.approx(radii[:, 0] ** 2 / 16, abs=1e-15)
    gap, *_ = gap_of(Obstacle("sphere", radius=8), radii, normals, "axisymmetric")
    assert gap == pytest.approx(8 - np.sqrt(64 - radii[:, 0] ** 2), abs=1e-15)
    ufl_gap = Obstacle(gap=lambda x: ufl.sqrt(1 + x[0] ** 2) - 1)
    gap, *_ = gap_of(ufl_gap, radii, normals, "axisymmetric")
    assert gap == pytest.approx(np.sqrt(1 + radii[:, 0] ** 2) - 1)
    profile = Obstacle(gap=Profile("x", (0.0, 2.0), (0.0, 1.0)))
    gap, *_ = gap_of(profile, radii, normals, "axisymmetric")
    assert gap.tolist() == [0, 0.5, 1]
    gap, *_ = gap_of(Obstacle(), radii, normals, "axisymmetric")
    assert gap.tolist() == [0, 0, 0]


def test_curved_body_on_a_plane_is_measured_along_its_own_normal():
    angle = 0.3
    point = 2 * np.array([np.sin(angle), 1 - np.cos(angle)])
    gap, *_ = gap_of(
        Obstacle("plane", normal=(0, 1)), [point], [[np.sin(angle), -np.cos(angle)]], "plane strain"
    )
    assert gap[0] == pytest.approx(point[1] / np.cos(angle))


def test_punches_end_at_their_edges():
    radii = np.array([[0.2, 0], [0.5, 0], [0.7, 0], [1.0, 0], [1.1, 0]])
    normals = np.repeat(UP, 5, axis=0)
    flat = Obstacle("flat punch", radius=1, position=(0, 0.25))
    gap, *_ = gap_of(flat, radii, normals, "axisymmetric")
    assert gap.tolist() == [0.25] * 4 + [np.inf]
    ring = Obstacle("annular punch", radius=1, inner_radius=0.5)
    gap, *_ = gap_of(ring, radii, normals, "axisymmetric")
    assert gap.tolist() == [np.inf, 0, 0, 0, np.inf]


def test_what_faces_away_or_misses_is_never_met():
    away = Obstacle("plane", normal=(0, 1))
    gap, *_ = gap_of(away, [[0.0, 0]], UP, "plane strain")
    assert gap[0] == np.inf
    gap, *_ = gap_of(Obstacle("cylinder", radius=1), [[3.0, 0]], UP, "plane strain")
    assert gap[0] == np.inf
    # A pin in a hole: the far side of the hole does not meet it through the body.
    pin = Obstacle("cylinder", radius=1, normal=(0, -1))  # its centre is (0, 1)
    points, normals = [[0.0, -0.1], [0, 2.1]], [[0, 1], [0, -1]]
    gap, *_ = gap_of(pin, points, normals, "plane strain")
    assert gap == pytest.approx([0.1, 0.1])
    gap, *_ = gap_of(pin, [[0.0, 2.1]], UP, "plane strain")
    assert gap[0] == np.inf


@pytest.mark.parametrize(
    ("obstacle", "kinematics", "normals", "message"),
    [
        (Obstacle("sphere", radius=1), "plane strain", UP, "no_sphere_in_plane_strain"),
        (Obstacle("cylinder", radius=1), "axisymmetric", UP, "no_cylinder_in_axisymmetric_models"),
        (Obstacle("cylinder", radius=1), "3D", [[0, 0, 1]], "along_is_needed_in_3d"),
        (
            Obstacle("cylinder", radius=1, along=(0, 1, 0), normal=(0, 0.3, -1)),
            "3D",
            [[0, 0, 1]],
            "along_not_at_right_angle",
        ),
        (Obstacle("plane", position=(1, 0)), "axisymmetric", UP, "position_off_the_axis"),
        (Obstacle("plane", normal=(0.1, -1)), "axisymmetric", UP, "axisymmetric_obstacle_tilted"),
        (Obstacle(displacement=(0.1, 0)), "axisymmetric", UP, "axisymmetric_obstacle_tilted"),
        (Obstacle(indentation=0.1), "axisymmetric", [[1, 0]], "axisymmetric_obstacle_tilted"),
        (Obstacle("plane"), "plane strain", [[0, 1], [0.1, 1]], "obstacle_needs_a_normal"),
        (Obstacle(indentation=1), "plane strain", [[0, 1], [0.1, 1]], "obstacle_needs_a_normal"),
        (Obstacle(gap=lambda x: np.sqrt(x[0])), "plane strain", UP, "gap_fails_with_numpy"),
        (Obstacle(gap=lambda x: x[5]), "plane strain", UP, "gap_fails_with_index"),
    ],
)
def test_bad_obstacles_give_one_sentence(obstacle, kinematics, normals, message):
    with refused(message):
        gap_of(obstacle, [[1.0] * len(normals[0])] * len(normals), normals, kinematics)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"shape": "plane", "gap": 0.0}, "shape_and_gap"),
        ({"indentation": 1, "force": 1}, "indentation_and_force"),
        ({"shape": "sphere"}, "sphere_without_radius"),
        ({"shape": "plane", "radius": 1}, "radius_of_a_plane"),
        ({"shape": "annular punch", "radius": 1}, "inner_radius_is_missing"),
        ({"shape": "annular punch", "radius": 1, "inner_radius": 2}, "inner_radius_exceeds_radius"),
        ({"shape": "sphere", "radius": 1, "along": (1, 0, 0)}, "along_of_a_sphere"),
        ({"position": (0, 5)}, "position_without_shape"),
        ({"normal": (0, 0)}, "normal_is_zero"),
        ({"force": -1}, "obstacle_force_is_negative"),
    ],
)
def test_contradictions_are_refused_when_the_obstacle_is_made(keys, message):
    with refused(message, ValueError):
        Obstacle(**keys)


@pytest.mark.parametrize("obstacle", [None, Obstacle(gap=-0.002)])
def test_cylinder_in_a_bore(obstacle):
    """Under ε_r = ε_θ = ε, ε_z = 0 its wall carries p = −E ε/((1 + ν)(1 − 2ν)) (Hooke), exactly.

    Without an obstacle it stands where the surface is, and pressing the ends bulges the cylinder:
    ε_r = 0, and p = −ν E ε_z/((1 + ν)(1 − 2ν)).
    """
    height = 0.0 if obstacle else -0.01
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}), Support("y1", {"y": height})),
        contact=(Contact("x1", obstacle=obstacle),),
    )
    result = run(scene, MPI.COMM_WORLD, box_body((4, 4), (1, 1)))
    pressure = 1000 / (1.3 * 0.4) * (0.002 if obstacle else 0.3 * 0.01)
    assert result.passed
    assert result.quantities["pressure_integral"] == pytest.approx(2 * np.pi * pressure, rel=1e-3)
    assert result.quantities["normal_force"] is None  # it pushes all around


@pytest.mark.parametrize("radius", [1e10, 1e15, 1e60])
@pytest.mark.parametrize("shape", ["paraboloid", "sphere", "parabola", "cylinder"])
def test_of_a_large_radius_a_surface_is_its_plane(shape, radius):
    """Where rays meet it, it is off that by ρ²/2R, over the cosine to the rays."""
    along = (0, 1, 0) if shape in ("parabola", "cylinder") else None
    points, normals = random_rays()
    place = (0.2, 0, 0.5)
    curved = Obstacle(shape, radius=radius, normal=(0, 0, -1), position=place, along=along)
    found = gap_of(curved, points, normals)[0]
    flat = gap_of(Obstacle("plane", normal=(0, 0, -1), position=place), points, normals)[0]
    steep = normals[:, 2] / np.linalg.norm(normals, axis=1) > 0.3
    assert steep.sum() > 150
    assert found[steep] == pytest.approx(flat[steep], rel=1e-14, abs=1e3 / radius)


@pytest.mark.parametrize("shape", ["cylinder", "parabola"])
def test_under_a_surface_of_a_large_radius_a_block_is_pressed_as_under_a_plane(shape):
    def force(obstacle):
        scene = Scene(
            kinematics="plane strain",
            material=Material(1000, 0.3),
            support=(Support("y0", {"x": 0, "y": 0}),),
            contact=(Contact("y1", obstacle=obstacle),),
        )
        return run(scene, body=box_body((3, 2), (1, 1))).quantities["normal_force"]

    where = {"position": (0.5, 1), "normal": (0, -1), "indentation": 0.01}
    curved = force(Obstacle(shape, radius=1e15, **where))
    assert curved == pytest.approx(force(Obstacle("plane", **where)), rel=1e-9)
    assert curved > 1
