"""Kinds of surfaces from points and normals, wherever they lie, against their formulas."""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from fenics_contact.mesh.surface_shapes import shape_of

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of arrays; one rank will do")

TURN = Rotation.from_euler("xyz", [0.3, -0.7, 1.1])
AT = np.array([3.0, -20.0, 7.0])
U, V = (x.ravel() for x in np.meshgrid(np.linspace(0.1, 2.4, 6), np.linspace(-0.4, 1.3, 5)))
ROUND = np.column_stack([np.cos(U), np.sin(U), 0 * U])
UP = np.array([0.0, 0.0, 1.0])


def plane():
    return np.column_stack([U, V, 0 * U]), np.tile(UP, (len(U), 1))


def cylinder(radius=2.0):
    return radius * ROUND + np.outer(V, UP), ROUND


def cone(angle=0.3):
    along = V + 2
    points = (along * np.tan(angle))[:, None] * ROUND + np.outer(along, UP)
    return points, np.cos(angle) * ROUND - np.sin(angle) * UP


def sphere(radius=4.0):
    normals = np.cos(V)[:, None] * ROUND + np.outer(np.sin(V), UP)
    return radius * normals, -normals


def torus(ring=5.0, radius=0.5):
    normals = np.cos(V)[:, None] * ROUND + np.outer(np.sin(V), UP)
    return ring * ROUND + radius * normals, normals


def ellipsoid():
    points, normals = sphere(1.0)
    normals = -normals / np.array([1.0, 1.2, 1.5])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return points * np.array([1.0, 1.2, 1.5]), normals


def found(points, normals, tolerance=1e-6):
    return shape_of(TURN.apply(points) + AT, TURN.apply(normals), tolerance)


def test_shapes_wherever_they_lie():
    axis = TURN.apply(UP)
    for make, kind in ((plane, "plane"), (cylinder, "cylinder"), (cone, "cone"), (torus, "torus")):
        shape = found(*make())
        assert shape.kind == kind
        assert abs(np.dot(shape.axis, axis)) == pytest.approx(1)
    assert found(*cylinder()).radius == pytest.approx(2)
    assert np.cross(np.array(found(*cylinder()).centre) - AT, axis) == pytest.approx(0, abs=1e-9)
    assert found(*cone()).centre == pytest.approx(AT)
    assert found(*cone()).angle == pytest.approx(np.degrees(0.3))
    assert (found(*torus()).ring, found(*torus()).radius) == pytest.approx((5, 0.5))
    assert found(*torus()).centre == pytest.approx(AT)
    ball = found(*sphere())
    assert (ball.kind, ball.radius, ball.axis) == ("sphere", pytest.approx(4), ())
    assert ball.centre == pytest.approx(AT)


def test_what_is_none_of_them_is_of_free_form():
    assert found(*ellipsoid()).kind == "free form"
    points, normals = cylinder()
    assert found(points * [1.0, 1.001, 1.0], normals).kind == "free form"
    points, normals = plane()
    assert found(points + 1e-4 * np.outer(U**2, UP), normals).kind == "free form"


def test_facets_of_a_mesh_are_rough():
    points, normals = cylinder()
    rough = np.random.default_rng(1).normal(size=points.shape)
    shape = found(points + 0.01 * rough, normals + 0.01 * rough, 0.05)
    assert (shape.kind, shape.radius) == ("cylinder", pytest.approx(2, rel=0.02))


def test_curves_in_the_plane():
    points, normals = 3 * ROUND, ROUND
    circle = shape_of(points, normals, 1e-6, in_plane=True)
    assert (circle.kind, circle.radius, circle.axis) == ("circle", pytest.approx(3), ())
    line = shape_of(np.outer(U, [1.0, 2, 0]), np.tile([2.0, -1, 0], (30, 1)) / 5**0.5, 1e-6, True)
    assert line.kind == "straight line"
    oval = shape_of(points * [1, 1.2, 1], normals, 1e-6, in_plane=True)
    assert oval.kind == "curve"
