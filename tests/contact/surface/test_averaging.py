"""Averages on contact surfaces: what is constant stays so, no force is lost, and moments are exact.

Moments of the kernel are found here by numerical integration of its formula alone.
"""

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI
from scipy.integrate import quad

from fenics_contact import Contact, Discretisation, Material, Run, Scene, Support
from fenics_contact.contact.surface.averaging import SurfaceAverage, bump
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
HEXAHEDRON, TETRAHEDRON = CellType.hexahedron, CellType.tetrahedron


def trace_of(body, on="y1", kinematics="plane strain", degree=2, symmetry=()):
    opposite = {"x1": "x0", "z1": "z0"}.get(on, "y0")
    scene = Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=(Support(opposite, dict.fromkeys("xyz"[: body.dimension], 0)),),
        discretisation=Discretisation(degree),
        contact=(Contact(on, pressure=1.0, friction_coefficient=0.1),),
        symmetry=symmetry,
    )
    return Run(scene, COMM, body).problem.contacts[0].trace


def moment(power, dimension):
    """∫ |x|^power k over ∫ k, of a kernel of radius 1."""

    def integral(extra):
        return quad(lambda r: r ** (dimension - 1 + extra) * np.exp(-1 / (1 - r * r)), 0, 1)[0]

    return integral(power) / integral(0)


def worst(values):
    return COMM.allreduce(np.abs(values).max(initial=0.0), op=MPI.MAX)


def bowl(body, depth=0.3):
    """The last axis' far side as a bowl, or a ridge."""
    points, dimension = body.mesh.geometry.x, body.dimension
    points[:, dimension - 1] += depth * (points[:, : dimension - 1] ** 2).sum(axis=1)
    return body


MODELS = {
    "line, degree 1": lambda: trace_of(box_body((16, 2)), degree=1),
    "line, degree 2": lambda: trace_of(bowl(box_body((9, 2)))),
    "symmetric line": lambda: trace_of(box_body((8, 2)), symmetry=("x0", "x1")),
    "axisymmetric, degree 1": lambda: trace_of(
        box_body((8, 2)), kinematics="axisymmetric", degree=1
    ),
    "axisymmetric, degree 2": lambda: trace_of(bowl(box_body((8, 2))), kinematics="axisymmetric"),
    "outside of a cylinder": lambda: trace_of(
        box_body((2, 8)), on="x1", kinematics="axisymmetric", symmetry=("y0",)
    ),
    "hexahedra": lambda: trace_of(bowl(box_body((4, 4, 1))), "z1", "3D", symmetry=("x0",)),
    "tetrahedra": lambda: trace_of(
        bowl(box_body((4, 4, 1), cell=TETRAHEDRON)), "z1", "3D", symmetry=("x0", "y0")
    ),
}


@pytest.mark.parametrize("radius", [0.15, 0.45, 3.0])
@pytest.mark.parametrize("model", MODELS)
def test_a_constant_stays_and_no_force_is_lost(model, radius):
    """Also at edges, and on parts of a surface; the transpose is that of the sum."""
    trace = MODELS[model]()
    average = SurfaceAverage(trace, radius)
    ones, uneven = np.ones(len(trace.weights)), 1 + np.sin(3 * trace.coordinates.sum(axis=1))
    assert worst(average.apply(ones) - 1) < 1e-12
    found = average.apply(uneven)
    assert found.min(initial=1.0) >= 0
    assert trace.integral(found) == pytest.approx(trace.integral(uneven), rel=1e-12)
    assert worst(found - uneven) > 0.01
    owned, other = trace.owned, trace.coordinates[:, 0]
    there = COMM.allreduce(float((other * found)[owned].sum()))
    assert COMM.allreduce(
        float((average.transposed(other) * uneven)[owned].sum())
    ) == pytest.approx(there, rel=1e-12)
    in_part = trace.coordinates[:, 0] < 0.6
    average.over(in_part)
    found = average.apply(np.where(in_part, uneven, 0.0))
    assert worst(average.apply(ones)[in_part] - 1) < 1e-12
    assert worst(found[~in_part]) == 0
    assert trace.integral(found) == pytest.approx(trace.integral(uneven * in_part), rel=1e-12)


@pytest.mark.parametrize("model", MODELS)
def test_a_radius_far_below_a_cell_averages_nothing(model):
    trace = MODELS[model]()
    average = SurfaceAverage(trace, 0.1 / 16)
    uneven = 1 + np.sin(3 * trace.coordinates.sum(axis=1))
    assert worst(average.apply(uneven) - uneven) < 1e-14


@pytest.mark.parametrize("model", MODELS)
def test_weights_of_pairs_are_the_average(model):
    trace = MODELS[model]()
    average = SurfaceAverage(trace, 0.4)
    uneven = 1 + np.sin(3 * trace.coordinates.sum(axis=1))
    parts = average.weights * average.gathered(uneven)[average.columns]
    summed = np.bincount(average.rows, parts, len(uneven))
    assert worst(summed - average.apply(uneven)) < 1e-13


@pytest.mark.parametrize("model", MODELS)
def test_its_derivative_in_the_radius_is_that_of_differences(model):
    trace, radius = MODELS[model](), 0.43
    uneven = 1 + np.sin(3 * trace.coordinates.sum(axis=1))
    counted = uneven < 1.9

    def average(size):
        found = SurfaceAverage(trace, size)
        found.over(counted)
        return found

    step = 1e-3 * radius
    near, far = (
        (average(radius + h).apply(uneven) - average(radius - h).apply(uneven)) / (2 * h)
        for h in (step, 2 * step)
    )
    found = average(radius).radius_slope(uneven)
    assert worst(found - (4 * near - far) / 3) < 1e-7 * worst(found)
    assert worst(found[~counted]) == 0


@pytest.mark.parametrize("degree", [1, 2])
def test_squares_on_a_line_grow_by_the_kernels_second_moment(degree):
    trace = trace_of(box_body((120, 1)), degree=degree)
    radius, x = 0.1, trace.coordinates[:, 0]
    found = SurfaceAverage(trace, radius).apply(x**2)
    # The scale that edges have decays over some radii.
    inner = (x > 0.4) & (x < 0.6)
    expected = x**2 + radius**2 * moment(2, 1)
    assert worst((found - expected)[inner]) < 2e-3 * radius**2


def test_squares_on_a_plane_and_around_the_axis_grow_likewise():
    expected = moment(2, 2)
    plane = trace_of(box_body((20, 20, 1)), "z1", "3D", 2, symmetry=("x0", "y0"))
    rings = trace_of(box_body((40, 1)), kinematics="axisymmetric", degree=2)
    for trace, axes, near in ((plane, slice(0, 2), 1e-2), (rings, slice(0, 1), 3e-3)):
        radius = 0.3
        squares = (trace.coordinates[:, axes] ** 2).sum(axis=1)
        found = SurfaceAverage(trace, radius).apply(squares)
        inner = squares < 0.35**2
        assert worst((found - squares - radius**2 * expected)[inner]) < near * radius**2


def test_distance_is_measured_along_a_line():
    """On an arc cos(s/R) is multiplied by the mean of cos(d/R) over the kernel."""
    body = box_body((160, 1), (3.0, 0.3))
    points = body.mesh.geometry.x
    angle, size = points[:, 0].copy(), 1 + points[:, 1]
    points[:, 0], points[:, 1] = size * np.cos(angle), size * np.sin(angle)
    trace = trace_of(body, degree=2)
    outer, radius = 1.3, 0.6
    angle = np.arctan2(trace.coordinates[:, 1], trace.coordinates[:, 0])
    found = SurfaceAverage(trace, radius).apply(np.cos(angle))

    def integral(function):
        return quad(lambda d: function(d) * np.exp(-1 / (1 - (d / radius) ** 2)), 0, radius)[0]

    share = integral(lambda d: np.cos(d / outer)) / integral(lambda d: 1.0)
    inner = (angle > 1.1) & (angle < 1.9)
    assert worst((found - share * np.cos(angle))[inner]) < 4e-5
    chords = integral(lambda d: np.cos(2 * np.arcsin(d / 2 / outer))) / integral(lambda d: 1.0)
    assert abs(chords - share) > 8e-5


@pytest.mark.parametrize("cell", [HEXAHEDRON, TETRAHEDRON])
def test_a_half_and_its_mirror_image_are_the_whole(cell):
    """The areas of vertices of tetrahedra are not mirror images: these agree more or less."""
    whole = trace_of(box_body((6, 6, 1), (2, 2, 1), cell), "z1", "3D", 1)
    half = trace_of(box_body((3, 6, 1), (1, 2, 1), cell), "z1", "3D", 1, symmetry=("x0",))
    found = []
    for trace, middle in ((whole, 1.0), (half, 0.0)):
        apart = np.abs(trace.coordinates[:, 0] - middle)
        height = trace.coordinates[:, 1]
        average = SurfaceAverage(trace, 0.8)
        values = average.apply(np.exp(-apart) * (1 + height))
        rows = np.concatenate(COMM.allgather(np.column_stack([apart, height, values])[trace.owned]))
        found.append({(round(a, 6), round(h, 6)): value for a, h, value in rows})
    near = 1e-12 if cell == HEXAHEDRON else 0.1
    assert len(found[1]) == 28
    assert all(abs(value - found[0][place]) < near for place, value in found[1].items())


def test_parts_that_the_surface_does_not_connect_are_not_averaged_together():
    apart = {"two": ("y1", lambda x: np.abs(x[0] - 0.5) > 0.1)}
    trace = trace_of(box_body((20, 1), patches=apart), on="two", degree=1)
    on_left = np.where(trace.coordinates[:, 0] < 0.5, 1.0, 0.0)
    found = SurfaceAverage(trace, 2.0).apply(on_left)
    assert worst(found - on_left) < 1e-12


def test_the_kernel_vanishes_at_its_rim_without_a_trace():
    ratio = np.array([0.0, 0.5, 1 - 1e-3, 1 - 1e-16, 1.0, 1 + 1e-16, 2.0, np.inf])
    with np.errstate(all="raise", under="ignore"):
        found = bump(ratio)
    assert found[0] == pytest.approx(np.exp(-1))
    assert found[1] == pytest.approx(np.exp(-4 / 3))
    assert (np.diff(found) <= 0).all() and (found[3:] == 0).all()
