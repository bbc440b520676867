"""The surface of the interactive view: areas and volumes of bodies of every kind of cell."""

from types import SimpleNamespace

import numpy as np
import pytest
from dolfinx import fem, mesh, plot
from mpi4py import MPI

from fenics_contact.common import dolfinx_versions as compat  # noqa: F401
from fenics_contact.report.bodies.surface import REVOLVED, boundary, revolved, surface_of

pytestmark = pytest.mark.serial

CELLS = ["triangle", "quadrilateral", "tetrahedron", "hexahedron"]
SIZE = (2.0, 1.0, 0.5)


def grid_of(kind, degree, number=3):
    """A box, as the files of the fields have it: nodes are those of a Lagrange space."""
    cell = mesh.CellType[kind]
    dimension = 2 if kind in CELLS[:2] else 3
    make = mesh.create_rectangle if dimension == 2 else mesh.create_box
    ends = [np.zeros(dimension), np.array(SIZE[:dimension])]
    made = make(MPI.COMM_SELF, ends, [number] * dimension, cell)
    cells, kinds, points = plot.vtk_mesh(fem.functionspace(made, ("Lagrange", degree)))
    width = cells[0]
    nodes = cells.reshape(-1, width + 1)[:, 1:]
    return SimpleNamespace(
        points=np.round(points, 12),
        cell_connectivity=nodes.ravel(),
        celltypes=kinds,
        n_cells=len(kinds),
    )


def fields_of(grid, place=None):
    """Displacements that tell all nodes apart, and a scalar."""
    places = grid.points if place is None else place
    return {"displacement": 0.1 * places, "height": places[:, 1].copy()}


def areas(surface, points=None):
    """Area vectors of the triangles, (triangles, 3)."""
    a, b, c = (surface.points if points is None else points)[surface.triangles].swapaxes(0, 1)
    return 0.5 * np.cross(b - a, c - a)


def volume(surface, points=None):
    """By the divergence theorem: positive if the triangles face outwards."""
    centres = (surface.points if points is None else points)[surface.triangles].mean(axis=1)
    return np.einsum("ij,ij->", centres, areas(surface, points)) / 3


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("kind", CELLS)
def test_a_box_has_its_area_and_volume(kind, degree):
    grid = grid_of(kind, degree)
    surface = surface_of(grid, fields_of(grid))
    size = np.linalg.norm(areas(surface), axis=1)
    x, y, z = SIZE
    if kind in CELLS[:2]:
        assert areas(surface).sum(axis=0) == pytest.approx([0, 0, x * y])
    else:
        assert size.sum() == pytest.approx(2 * (x * y + y * z + z * x))
        assert volume(surface) == pytest.approx(x * y * z)
    assert size.min() > 0.1 * size.max()  # no triangle bridges nodes in a wrong order
    assert surface.fields["height"] == pytest.approx(surface.points[:, 1])
    lengths = np.linalg.norm(np.diff(surface.points[surface.lines], axis=1), axis=2)
    assert lengths.max() < 2.0 / degree  # sides of cells and diagonals, in halves


@pytest.mark.parametrize("kind", ["tetrahedron", "hexahedron"])
def test_of_degree_two_all_nodes_of_the_surface_are_used(kind):
    """Displaced by a quadratic function they enclose what the cells do, to fourth order."""
    errors = []
    for number in (2, 4):
        grid = grid_of(kind, 2, number)
        surface = surface_of(grid, fields_of(grid))
        x, y, z = surface.points.T
        moved = np.stack([x, y, z + 0.3 * x * (2 - x)], axis=1)
        moved[:, 2] -= 0.3 * x * (2 - x) * (z < 1e-9)  # the floor stays where it is
        errors.append(abs(volume(surface, moved) - (1.0 + 0.3 * 4 / 3)))
    assert errors[1] < errors[0] / 3.9  # of a parabola by chords: second order in their length
    assert errors[0] == pytest.approx(0.3 * 4 / 3 / 16, rel=1e-6)  # 4 chords: 1/n²


def test_too_many_triangles_are_made_between_corners_alone():
    grid = grid_of("hexahedron", 2)
    fine = surface_of(grid, fields_of(grid))
    coarse = surface_of(grid, fields_of(grid), most=200)
    assert len(fine.triangles) == 4 * len(coarse.triangles) == 54 * 8
    assert volume(coarse) == pytest.approx(volume(fine))
    assert len(coarse.points) < len(fine.points) / 2


def joined(first, second):
    """Two grids of the same kind as one, without common nodes, as of two ranks."""
    return SimpleNamespace(
        points=np.concatenate([first.points, second.points]),
        cell_connectivity=np.concatenate(
            [first.cell_connectivity, second.cell_connectivity + len(first.points)]
        ),
        celltypes=np.concatenate([first.celltypes, second.celltypes]),
        n_cells=first.n_cells + second.n_cells,
    )


@pytest.mark.parametrize("kind", CELLS)
def test_pieces_of_a_body_are_one_and_bodies_that_touch_are_two(kind):
    first, second = grid_of(kind, 2), grid_of(kind, 2)
    second.points = np.round(second.points + np.array([SIZE[0], 0, 0]), 12)
    both = joined(first, second)
    moved = fields_of(both)
    both.points[len(first.points) :] += 1e-15  # each rank has its own round-off in places
    one = surface_of(both, moved)
    parted = {name: values.copy() for name, values in moved.items()}
    parted["displacement"][len(first.points) :] += 1e-9  # by no more than a penalty does
    two = surface_of(both, parted)
    x, y, z = SIZE
    if kind in CELLS[:2]:
        assert len(two.points) - len(one.points) == 2 * 3 + 1  # the nodes of a side
        assert len(boundary(two.triangles)) == len(boundary(one.triangles)) + 2 * 2 * 3
    else:
        inner = np.linalg.norm(areas(two), axis=1).sum() - np.linalg.norm(areas(one), axis=1).sum()
        assert inner == pytest.approx(2 * y * z)
        assert volume(one) == pytest.approx(2 * x * y * z) == volume(two)


@pytest.mark.parametrize("kind", ["triangle", "quadrilateral"])
@pytest.mark.parametrize("inner", [0.0, 0.5])
def test_three_quarters_of_a_ring(kind, inner):
    """Between polygons of as many sides as there are strips, two sections cut by planes."""
    grid = grid_of(kind, 2)
    grid.points = grid.points + np.array([inner, 0, 0])
    surface = revolved(grid, fields_of(grid))
    radii, height = (inner, inner + SIZE[0]), SIZE[1]
    strips = 60
    turn = (REVOLVED[1] - REVOLVED[0]) / strips
    section = 0.5 * strips * np.sin(turn) * (radii[1] ** 2 - radii[0] ** 2)
    assert volume(surface) == pytest.approx(section * height)
    sides = strips * 2 * np.sin(turn / 2) * (radii[0] + radii[1]) * height
    area = 2 * section + sides + 2 * SIZE[0] * height
    assert np.linalg.norm(areas(surface), axis=1).sum() == pytest.approx(area)
    # nothing in the quarter into which one looks; vectors are turned with the points
    x, y, z = surface.points.T
    assert not ((x > 1e-9) & (y > 1e-9)).any()
    assert np.hypot(x, y).max() == pytest.approx(radii[1])
    assert surface.fields["height"] == pytest.approx(z)
    assert surface.fields["displacement"] == pytest.approx(0.1 * surface.points, abs=1e-12)
