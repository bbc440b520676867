"""Points at which the displacement is a quantity: exact for fields that the elements hold."""

import dataclasses

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    MeshSource,
    Point,
    Run,
    Scene,
    Support,
)
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.probe_points import DisplacementPoints
from fenics_contact.body.spaces import Spaces
from tests.messages import refused
from tests.scenes import ROOT, box_body

COMM = MPI.COMM_WORLD
SIDES = ("x0", "x1", "y0", "y1", "z0", "z1")
# u = G x, which every element holds.
GRADIENT = np.array([[3e-3, -1e-3, 2e-3], [4e-3, 1e-3, -2e-3], [-1e-3, 5e-3, 2e-3]])


def linear_scene(dimension, degree, points):
    """A body whose boundary moves by a linear field."""
    components = {
        axis: (lambda x, row=GRADIENT[number]: row @ x)
        for number, axis in enumerate("xyz"[:dimension])
    }
    return Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=tuple(Support(side, components) for side in SIDES[: 2 * dimension]),
        point=tuple(Point(f"p{number}", at) for number, at in enumerate(points)),
    )


def twisted(body, size):
    """The body with the nodes inside moved, so that its quadrilaterals are no parallelograms."""
    x = body.mesh.geometry.x
    inside = np.all((x[:, :2] > 1e-9) & (x[:, :2] < np.array(size[:2]) - 1e-9), axis=1)
    x[inside, 0] += 0.04 * np.sin(7 * x[inside, 1])
    x[inside, 1] += 0.04 * np.sin(9 * x[inside, 0])
    return body


@pytest.mark.parametrize(
    ("cells", "cell", "degree"),
    [
        ((5, 4), mesh.CellType.quadrilateral, 1),
        ((5, 4), mesh.CellType.triangle, 2),
        ((3, 3, 2), mesh.CellType.hexahedron, 2),
        ((3, 3, 2), mesh.CellType.tetrahedron, 1),
    ],
)
def test_displacement_at_any_point_of_a_linear_field(cells, cell, degree):
    size = (1.0, 0.8, 0.5)[: len(cells)]
    inside = np.array([0.37, 0.61, 0.23])[: len(cells)]
    # Inside a cell, on a side that cells share, on a node, at a corner of the body.
    points = [tuple(map(float, p)) for p in (inside, (0.5, *inside[1:]), (0.6, 0.4, 0.25), size)]
    points = [point[: len(cells)] for point in points]
    body = twisted(box_body(cells, size, cell), size)
    result = Run(linear_scene(len(cells), degree, points), COMM, body).solve()
    gradient = GRADIENT[: len(cells), : len(cells)]
    for number, point in enumerate(points):
        found = result.quantities[f"displacement_p{number}"]
        assert found == pytest.approx(gradient @ point, rel=1e-10, abs=1e-14), point
    assert len(set(COMM.allgather(str(result.quantities)))) == 1


def test_a_quadratic_field_is_found_between_the_nodes():
    """Bending without shear at ν = 0: u_x = x y, u_y = −x²/2, by its displacements around."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.0),
        support=tuple(
            Support(side, {"x": lambda x: x[0] * x[1], "y": lambda x: -(x[0] ** 2) / 2})
            for side in SIDES[:4]
        ),
        point=(Point("a", (0.37, 0.61)),),
    )
    for cell in (mesh.CellType.triangle, mesh.CellType.quadrilateral):
        found = Run(scene, COMM, box_body((4, 3), (1, 1), cell)).solve()
        expected = [0.37 * 0.61, -(0.37**2) / 2]
        assert found.quantities["displacement_a"] == pytest.approx(expected, rel=1e-10)


def test_where_two_bodies_touch_the_point_is_of_the_first_mesh():
    """Two blocks under a uniform pressure with different supports sideways."""

    def block(name, bottom, cells):
        return MeshSource(
            str(ROOT / "meshes" / "sloped_block.geo"),
            cell="quadrilateral",
            name=name,
            parameters={
                "length": 1,
                "bottom": bottom,
                "top": bottom + 1,
                "cells_along": cells,
                "cells_across": 3,
            },
        )

    scene = Scene(
        kinematics="plane strain",
        mesh=(block("lower", 0, 4), block("upper", 1, 3)),
        material=Material(1000, 0.0),
        support=(
            Support("lower.bottom", {"x": 0, "y": 0}),
            Support("upper.top", {"x": 0.25}),  # the upper one moves as a whole
        ),
        load=(Load("upper.top", pressure=1.0),),
        contact=(Contact("upper.bottom", against="lower.top"),),
        point=(Point("between", (0.4, 1.0)), Point("above", (0.4, 1.5))),
    )
    for meshes, aside in ((scene.mesh, 0.0), (scene.mesh[::-1], 0.25)):
        found = Run(dataclasses.replace(scene, mesh=meshes)).solve().quantities
        # By the penalty the upper one sinks in by 3e-4 of what a cell of 1/3 gives way.
        assert found["displacement_between"] == pytest.approx([aside, -1e-3], rel=2e-4, abs=1e-9)
        assert found["displacement_above"] == pytest.approx([0.25, -1.5e-3], rel=2e-4)


@pytest.mark.parametrize("at", [(1.1, 0.5), (0.5, -0.01), (5.0, 5.0)])
def test_a_point_outside_is_refused_in_one_sentence(at):
    body = box_body((4, 3), (1, 0.8))
    with refused("point_is_outside", at=list(at)):
        Run(linear_scene(2, 2, [(0.5, 0.5), at]), COMM, body)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ((Point("a", (0.0, 0.0, 0.0)),), "point_has_3_entries"),
        ((Point("a", (0, 0.0)), Point("a", (1.0, 0.0))), "two_points_of_one_name"),
    ],
)
def test_points_that_make_no_sense_are_refused(points, message):
    scene = linear_scene(2, 1, [])
    with refused(message, ValueError):
        dataclasses.replace(scene, point=points)
    with refused("point_name_has_a_comma", ValueError):
        Point("a,b", (0.0, 0.0))


def test_as_many_points_as_one_likes():
    """50,000, some on sides that cells share: in seconds, not the hours of comparing each pair."""
    size = 1.0, 0.8
    places = np.random.default_rng(3).integers(0, 97, (50_000, 2)) / 96.0 * size
    scene = linear_scene(2, 1, [tuple(place) for place in places.tolist()])
    spaces = Spaces(BodyDescription.of(scene), twisted(box_body((5, 4), size), size))
    points = DisplacementPoints(scene.point, spaces)
    found = points.quantities(spaces.coordinates[:, :2] @ GRADIENT[:2, :2].T)
    values = np.array([found[f"displacement_{point.name}"] for point in scene.point])
    assert np.abs(values - places @ GRADIENT[:2, :2].T).max() < 1e-14


def test_steps_have_it_too(tmp_path):
    from fenics_contact.simulation.output.tables import row_of

    run = Run(linear_scene(2, 1, [(0.3, 0.3)]), COMM, box_body((4, 3), (1, 0.8)))
    result = run.solve()
    row = row_of(result.steps[0])
    assert row["displacement_p0_x"] == result.quantities["displacement_p0"][0]
