"""Where contact points lie: what is a line, in which order, and what is a surface."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.report.page.sweep_states import shape_of

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of arrays; one rank will do")
MIXED = np.random.default_rng(3)


def flat(x, y):
    return np.column_stack([x, y, 0 * x])


def test_a_line_is_followed_from_its_lower_end():
    x = np.linspace(0, 1, 30) ** 2
    mixed = MIXED.permutation(30)
    shape = shape_of(flat(x, 0.1 * x**2)[mixed], None)
    assert mixed[shape.order].tolist() == list(range(30))
    assert shape.labels == ("x",)
    assert shape.positions[0] == pytest.approx(x)
    steep = np.stack([np.ones(30), 0.2 * x], axis=1)  # the tangent of y = .1 x²
    exact = steep / np.linalg.norm(steep, axis=1, keepdims=True)
    assert shape.tangents[1:-1, :2] == pytest.approx(exact[1:-1], abs=0.02)
    assert len(shape.breaks) == 0


def test_a_line_that_turns_back_has_its_arc_length():
    angle = np.linspace(0, 1.5 * np.pi, 200)
    mixed = MIXED.permutation(200)
    shape = shape_of(3 * flat(np.cos(angle), np.sin(angle))[mixed], "plane strain")
    assert shape.labels == ("arc length s",)
    found = shape.positions[0]
    assert found.min() == 0 and np.all(np.diff(found) > 0)
    assert found[-1] == pytest.approx(3 * 1.5 * np.pi, rel=1e-4)
    steps = np.diff(mixed[shape.order])
    assert set(steps) in ({1}, {-1})


def test_two_pieces_are_parted():
    x = np.concatenate([np.linspace(0, 1, 20), np.linspace(5, 6, 30)])
    shape = shape_of(flat(x, 0 * x), "axisymmetric")
    assert shape.breaks.tolist() == [20]
    assert shape.labels == ("r",)


def test_one_point_and_points_in_the_same_place():
    assert shape_of(np.zeros((1, 3)), None).positions.shape == (1, 1)
    x = np.repeat(np.linspace(0, 1, 10), 2)
    assert shape_of(flat(x, 0 * x), None).positions[0] == pytest.approx(x)


@pytest.mark.parametrize("kinematics", [None, "3D"])
def test_a_surface_in_its_plane(kinematics):
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(9.0), np.arange(7.0)))
    shape = shape_of(flat(x, y), kinematics)
    assert shape.labels == ("x", "y") and shape.tangents is None
    shape = shape_of(np.column_stack([0 * x + 2, x, y]), kinematics)
    assert shape.labels == ("y", "z")
    assert shape.positions == pytest.approx(np.stack([x, y]))


def test_a_surface_that_lies_askew_keeps_its_distances():
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(9.0), np.arange(7.0)))
    points = np.column_stack([x, y, x + 0.5 * y])
    shape = shape_of(points, "3D")
    assert shape.positions.shape == (2, 63)
    exact = np.linalg.norm(points - points[0], axis=1)
    drawn = np.linalg.norm(shape.positions - shape.positions[:, :1], axis=0)
    assert drawn == pytest.approx(exact)


def test_a_curved_surface_is_drawn_in_space():
    angle, z = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 1, 9), np.arange(7.0)))
    points = np.column_stack([np.cos(angle), np.sin(angle), z])
    shape = shape_of(points, None)
    assert shape.labels == ("x", "y", "z")
    assert shape.positions == pytest.approx(points.T)
    middle = np.array([np.cos(0.5), np.sin(0.5), 0])
    assert abs(shape.normal @ middle) == pytest.approx(1, abs=1e-6)
