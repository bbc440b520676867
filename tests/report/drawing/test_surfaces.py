"""Contact surfaces on pictures: their own facets, also around holes, and cylinders unrolled."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Discretisation, Run
from fenics_contact.report.contacts.curves import draw_curves
from fenics_contact.report.contacts.line import SurfaceLine
from fenics_contact.report.contacts.map_values import Surface
from fenics_contact.report.contacts.section_stress import section_at
from fenics_contact.report.drawing.cells import contact_pieces
from fenics_contact.report.drawing.charts import Cylinder, Plane, chart_of
from fenics_contact.results.contact_points import ContactTable, facet_flags
from fenics_contact.simulation.output.fields import _cell_fields, write_grid
from tests.records import made_contact
from tests.report.test_gallery import pressed
from tests.scenes import box_body

pytestmark = pytest.mark.serial
pyvista = pytest.importorskip("pyvista")

NAME = '<a> "b" & ü'
CONTACT = made_contact(
    name=NAME, contact="unilateral", law="static", parameters={"friction_coefficient": 0.5}
)
TURN = 2 * np.pi


def rows_at(points, normals, status="STICK", pressure=1.0):
    """Rows of a contact."""
    numbers = dict(zip("xyz", points.T, strict=True))
    numbers |= {f"n{axis}": column for axis, column in zip("xyz", normals.T, strict=True)}
    zero = np.zeros(len(points))
    numbers |= {f"traction_{axis}": zero for axis in "xyz"} | {"gap": zero}
    numbers |= {f"slip_{axis}": zero for axis in "xyz"}
    numbers["contact_pressure"] = pressure + zero
    return ContactTable(
        np.full(len(points), NAME),
        np.broadcast_to(np.array(status, dtype="<U5"), len(points)),
        numbers,
    )


def ring(inner, outer, height, around=24, across=3, up=3):
    """A ring of hexahedra, as a grid whose last corners meet its first ones, and its nodes."""
    angles = np.linspace(0, TURN, around, endpoint=False)
    r, t, z = np.meshgrid(
        np.linspace(inner, outer, across + 1), angles, np.linspace(0, height, up + 1), indexing="ij"
    )
    number = np.arange(r.size).reshape(r.shape)
    i, j, k = (index.ravel() for index in np.indices((across, around, up)))
    onward = (j + 1) % around
    cells = [
        number[i + a, b, k + c]
        for c in (0, 1)
        for a, b in ((0, j), (1, j), (1, onward), (0, onward))
    ]
    points = np.column_stack([(r * np.cos(t)).ravel(), (r * np.sin(t)).ravel(), z.ravel()])
    table = np.column_stack([np.full(i.size, 8), *cells])
    grid = pyvista.UnstructuredGrid(table.ravel(), np.full(i.size, 12), points)
    grid["status"] = np.full(len(points), -1.0)
    place = i, k
    return grid, place


def flagged(grid, facet, wanted):
    """The facets of some cells are the contact's; others are not, though their nodes are."""
    grid.cell_data[facet_flags(NAME)] = np.where(wanted, 1 << facet, 0).astype(np.uint8)


def seat(inner=1.0, outer=2.0):
    """The upper side of a ring, and its rows."""
    grid, (_, up) = ring(inner, outer, 0.5)
    flagged(grid, 5, up == up.max())
    points = np.asarray(grid.points)[np.isclose(grid.points[:, 2], 0.5)]
    return grid, rows_at(points, np.tile([0.0, 0, 1], (len(points), 1)))


def bore(radius=3.0, height=2.0, turned=None, **rows):
    """The inner side of a ring and its rows, perhaps turned."""
    grid, (across, _) = ring(radius, radius + 1, height)
    flagged(grid, 2, across == 0)
    points = np.asarray(grid.points)
    points = points[np.isclose(np.hypot(*points[:, :2].T), radius)]
    normals = -points * [1, 1, 0] / radius
    if turned is not None:
        grid.points = np.asarray(grid.points) @ turned.T
        points, normals = points @ turned.T, normals @ turned.T
    return grid, rows_at(points, normals, **rows)


def area(corners):
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def test_a_map_has_no_cell_in_a_hole_and_none_outside_of_a_curved_edge():
    grid, rows = seat()
    surface = Surface.of(grid, rows, CONTACT)
    distance = np.hypot(*surface.corners.mean(axis=1).T)
    assert distance.min() > np.cos(np.pi / 24) and distance.max() < 2
    polygon = 0.5 * 24 * np.sin(TURN / 24) * (2**2 - 1**2)
    assert area(surface.corners).sum() == pytest.approx(polygon)


def test_a_section_draws_the_contact_on_both_sides_of_a_hole():
    grid, rows = seat()
    grid["stress"] = np.outer(np.arange(grid.n_points), np.eye(3).ravel())
    section = section_at(grid, rows, CONTACT, flat=False)
    ends = section.contact[:, :, 0]
    assert np.abs(ends).min() == pytest.approx(1, rel=0.02)
    assert np.abs(np.diff(ends, axis=1)).sum() == pytest.approx(2 * (2 - 1), rel=0.02)


def about(axis, angle):
    """A turn about an axis, by Rodrigues' formula."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_a_cylinder_is_unrolled_to_its_arc_length(angle):
    turned = about(np.array([1.0, 2, 0]), angle)
    grid, rows = bore(3.0, 2.0, turned)
    chart = chart_of(rows)
    assert isinstance(chart, Cylinder) and chart.radius == pytest.approx(3)
    assert np.abs(chart.axis @ turned[:, 2]) == pytest.approx(1)
    points = rows.vectors("x", "y", "z")
    arc, height = chart.flat(points).T
    assert np.unique(np.round(np.diff(np.unique(np.round(arc, 6))), 5)) == pytest.approx(
        3 * TURN / 24, rel=1e-4
    )
    assert np.ptp(height) == pytest.approx(2)
    surface = Surface.of(grid, rows, CONTACT)
    assert area(surface.corners).sum() == pytest.approx(TURN * 3 * 2)
    across = np.ptp(surface.corners[:, :, 0], axis=1)
    assert across.max() == pytest.approx(3 * TURN / 24)  # none goes back around the cylinder
    # vectors around it stay as long, and point to larger angles
    around = np.cross(chart.axis, points - points.mean(axis=0))
    here = chart.vectors(points, around)
    assert here == pytest.approx(np.tile([3.0, 0], (len(here), 1)), abs=1e-9)


def test_a_part_of_a_cylinder_is_cut_where_it_is_open_and_a_whole_one_opposite_of_the_pressure():
    _, rows = bore()
    points = rows.vectors("x", "y", "z")
    left = points[:, 0] < -0.1  # across the angle at which arctan2 jumps
    arc = chart_of(rows.rows(left)).flat(points[left])[:, 0]
    assert np.ptp(arc) < 3 * np.pi
    _, pressed_on = bore(pressure=np.where(left, 1.0, 0.0))
    assert abs(chart_of(pressed_on).middle) == pytest.approx(np.pi)


def test_flat_ones_are_seen_across_them():
    _, rows = seat()
    chart = chart_of(rows)
    assert isinstance(chart, Plane) and chart.names == ("$x$", "$y$")
    turned = about(np.array([0.0, 1, 0]), 0.8)
    points = rows.vectors("x", "y", "z") @ turned.T
    chart = chart_of(rows_at(points, np.tile(turned[:, 2], (len(points), 1))))
    sizes = np.linalg.norm(points - points.mean(axis=0), axis=1)
    flat = chart.flat(points)
    assert np.linalg.norm(flat - flat.mean(axis=0), axis=1) == pytest.approx(sizes)
    box = np.concatenate(
        [np.tile(n, (9, 1)) for n in ([1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0])]
    )
    places = np.random.default_rng(1).uniform(-1, 1, (36, 3)) * (1 - np.abs(box)) + box
    assert isinstance(chart_of(rows_at(places, box)), Plane)  # four sides are no cylinder


def test_around_a_pin_in_a_flat_model_the_curve_follows_the_angle(tmp_path):
    """And not x, along which the upper and the lower half would be drawn to and fro."""
    angles = np.linspace(0, TURN, 16, endpoint=False)
    r = np.array([1.0, 2.0])[:, None]
    points = np.stack([r * np.cos(angles), r * np.sin(angles), 0 * r * angles], axis=-1)
    inner, onward = np.arange(16), (np.arange(16) + 1) % 16
    cells = np.column_stack([np.full(16, 4), inner, 16 + inner, 16 + onward, onward])
    grid = pyvista.UnstructuredGrid(cells.ravel(), np.full(16, 9), points.reshape(-1, 3))
    grid["status"] = np.repeat([1.0, -1.0], 16)
    grid.cell_data[facet_flags(NAME)] = np.full(16, 1 << 1, dtype=np.uint8)  # nodes 0 and 3
    rows = rows_at(points[0], -points[0], pressure=1 + np.sin(angles))
    rows.numbers["traction_x"] = -np.sin(angles)
    rows.numbers["traction_y"] = np.cos(angles)
    line = SurfaceLine.of(grid, rows, CONTACT)
    assert np.diff(line.position) == pytest.approx(TURN / 16)
    assert line.traction == pytest.approx(1)  # counter-clockwise everywhere
    assert len(np.unique(line.pieces)) == 1
    picture = draw_curves(grid, rows, CONTACT, "xy", tmp_path / "contact_0.png")
    assert "against the angle around its axis" in picture.caption


def test_a_curve_is_interrupted_where_the_surface_is():
    """Two feet of one contact, and nothing between them."""
    x = np.concatenate([np.linspace(-2, -1, 5), np.linspace(1, 2, 5)])
    points = np.concatenate([[[a, 0.0, 0], [a, 1.0, 0]] for a in x])
    left = np.array([0, 1, 2, 3, 5, 6, 7, 8]) * 2
    cells = np.column_stack([np.full(8, 4), left, left + 2, left + 3, left + 1])
    grid = pyvista.UnstructuredGrid(cells.ravel(), np.full(8, 9), points)
    grid["status"] = np.where(points[:, 1] == 0, 1.0, -1.0)
    grid.cell_data[facet_flags(NAME)] = np.full(8, 1, dtype=np.uint8)
    feet = points[::2]
    line = SurfaceLine.of(grid, rows_at(feet, np.tile([0.0, -1, 0], (10, 1))), CONTACT)
    position, values = line.curve(np.ones(10))
    assert len(position) == 11 and np.isnan(position[5]) and np.isnan(values[5])
    assert list(line.runs()) == [(-2.0, -1.0, "STICK"), (1.0, 2.0, "STICK")]


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("kind", ["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_files_say_which_facets_carry_a_contact(kind, degree, tmp_path):
    """Of a box those of its upper side, whatever its cells: all of its area, at its height."""
    from dolfinx.mesh import CellType

    flat = kind in ("triangle", "quadrilateral")
    cells = (2, 2) if flat else (2, 2, 2)
    body = box_body(cells, (1, 1, 0.5), CellType[kind], MPI.COMM_SELF)
    scene = dataclasses.replace(
        pressed(None, "plane strain" if flat else "3D"), discretisation=Discretisation(degree)
    )
    problem = Run(scene, MPI.COMM_SELF, body).problem
    space = problem.spaces.displacement_space
    fields = {"status": np.zeros(len(problem.spaces.coordinates))}
    name = write_grid(tmp_path, "fields", 1, space, fields, _cell_fields(problem))
    grid = pyvista.read(tmp_path / name)
    assert (grid.cell_data["body"] == 0).all()
    points = np.asarray(grid.points)
    axis, height = (1, 1.0) if flat else (2, 0.5)
    above = points[np.isclose(points[:, axis], height)]
    label = scene.contact[0].label
    contact = made_contact(name=label, contact="unilateral", law="none", parameters={})
    rows = rows_at(above, np.tile(np.eye(3)[axis], (len(above), 1)))
    surface = contact_pieces(grid, rows, contact)
    assert len(surface.nodes) == len(above)
    corners = points[surface.nodes[surface.pieces]]
    sides = corners[:, 1:] - corners[:, :1]
    if flat:
        assert np.linalg.norm(sides[:, 0], axis=1).sum() == pytest.approx(1)
    else:
        areas = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        assert areas.sum() == pytest.approx(1)
