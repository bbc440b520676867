"""Mortar coupling of surfaces whose meshes do not match, against geometry known exactly."""

import dataclasses

import basix
import numpy as np
import pytest

from fenics_contact.contact.mortar.facet_mesh import FacetMesh
from fenics_contact.contact.mortar.polygon_overlap import clip, counter_clockwise, fan, signed_areas
from fenics_contact.contact.mortar.projection import NodalProjection, integrate
from fenics_contact.contact.mortar.ray_projection import face, hits
from tests.contact.mortar.facet_meshes import arc, cap, flat, node_places

SHAPES = ("interval", "triangle", "quadrilateral")
RATIOS = [(2, 3), (3, 2), (1, 7), (7, 1)]


def coupled(slave, master, is_axisymmetric=False, fixed=None):
    """The integrals along the mean normals at nodes, and the projection."""
    mean_normals, _ = face(node_places(slave), slave.normals, master)
    integrals = integrate(slave, master, mean_normals, is_axisymmetric)
    return integrals, written_out(integrals, fixed)


def written_out(integrals, fixed=None):
    """P, (slave nodes, master nodes)."""
    count, masters = integrals.coupling.shape
    fixed = np.zeros(count, dtype=bool) if fixed is None else fixed
    made = NodalProjection.between(integrals, fixed, np.ones(count, dtype=bool))
    return made.apply(np.eye(masters))


def polynomial(places, degree):
    return (1 + places[:, 0] + 2 * places[:, -2]) ** degree


def orders(errors):
    return np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))


# Flat surfaces


@pytest.mark.parametrize("cells", RATIOS)
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("shape", SHAPES)
def test_flat_surfaces_reproduce_polynomials(shape, degree, cells):
    slave = flat(shape, cells[0], 1, degree)
    master = flat(shape, cells[1], -1, degree, height=0.1)
    integrals, projected = coupled(slave, master)
    expected = polynomial(node_places(slave), degree)
    found = projected @ polynomial(node_places(master), degree)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(integrals.coverage, 1, atol=1e-12)


@pytest.mark.parametrize("cells", [(2, 3), (7, 2)])
@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_distorted_facets_reproduce_linear_functions(shape, cells):
    slave = flat(shape, cells[0], 1, distortion=0.3)
    master = flat(shape, cells[1], -1, distortion=0.3)
    integrals, projected = coupled(slave, master)
    found = projected @ polynomial(node_places(master), 1)
    np.testing.assert_allclose(found, polynomial(node_places(slave), 1), rtol=0, atol=1e-12)
    assert integrals.mass.sum() == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("slave_shape", ["triangle", "quadrilateral"])
def test_triangles_against_quadrilaterals(slave_shape):
    master_shape = {"triangle": "quadrilateral", "quadrilateral": "triangle"}[slave_shape]
    slave, master = flat(slave_shape, 4, 1, 1), flat(master_shape, 3, -1, 2)
    _, projected = coupled(slave, master)
    found = projected @ polynomial(node_places(master), 1)
    np.testing.assert_allclose(found, polynomial(node_places(slave), 1), rtol=0, atol=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_projection_is_of_least_squares(shape):
    """∫ (u − P u)² over a kinked u on the master cannot be less for any other slave values.

    Against a fine midpoint rule, so that interpolation of u at the slave's nodes fails.
    """
    slave, master = flat(shape, 2, 1), flat(shape, 5, -1)
    _, projected = coupled(slave, master)
    values = np.random.default_rng(1).normal(size=master.node_count)
    points, weight = midpoints(shape, 120)
    of_slave, of_master = sampled(slave, points), sampled(master, points)
    mass = weight * of_slave.T @ of_slave
    expected = np.linalg.solve(mass, weight * of_slave.T @ (of_master @ values))
    interpolated = sampled(master, node_places(slave))
    assert np.abs(interpolated @ values - expected).max() > 0.1
    np.testing.assert_allclose(projected @ values, expected, atol=2e-3)


def midpoints(shape, count):
    """Points (at height 0) and weight of a midpoint rule on the unit segment or square."""
    x = (np.arange(count) + 0.5) / count
    if shape == "interval":
        return np.column_stack([x, 0 * x]), 1 / count
    x, y = np.meshgrid(x, x)
    return np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]), 1 / count**2


def sampled(mesh, points):
    """Shape functions of a flat surface at points of it, (points, nodes)."""
    directions = -mesh.normals[:1].repeat(len(points), axis=0)
    found = hits(mesh, points, directions)
    assert (found.facet >= 0).all()
    table = np.zeros((len(points), mesh.node_count))
    rows = np.arange(len(points))[:, None]
    table[rows, mesh.nodes[found.facet]] = mesh.shape_functions(found.reference)
    return table


def test_numbering_of_facets_does_not_matter():
    """A triangle numbered the other way round has the same outward side."""
    slave, master = flat("triangle", 3, 1), flat("triangle", 2, -1)
    turned = [0, 2, 1]
    other = FacetMesh(
        "triangle", 1, 1, master.geometry[:, turned], master.nodes[:, turned], master.normals
    )
    here, there = coupled(slave, master)[0], coupled(slave, other)[0]
    np.testing.assert_allclose(there.coupling.toarray(), here.coupling.toarray(), atol=1e-15)
    assert there.mass.sum() == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("shape", SHAPES)
def test_mass_matrix(shape, degree):
    """One facet against three each way: as by a rule of high degree on the facet."""
    slave = flat(shape, 1, 1, degree)
    integrals, _ = coupled(slave, flat(shape, 3, -1, degree))
    np.testing.assert_allclose(integrals.mass.toarray(), mass_matrix(slave), atol=1e-15)


def test_mass_matrix_of_rings():
    """A flat ring whose geometry is quadratic: its middle node is not in the middle."""
    straight = flat("interval", 1, 1, 2)
    geometry = np.array([[[0.0, 0.0], [1.0, 0.0], [0.55, 0.0]]])
    slave = FacetMesh("interval", 2, 2, geometry, straight.nodes, straight.normals)
    master = flat("interval", 3, -1, 2)
    integrals = integrate(slave, master, slave.normals, True)
    expected = mass_matrix(slave, is_axisymmetric=True)
    np.testing.assert_allclose(integrals.mass.toarray(), expected, rtol=0, atol=1e-14)


def mass_matrix(mesh, is_axisymmetric=False):
    points, weights = basix.make_quadrature(getattr(basix.CellType, mesh.shape), 20)
    matrix = np.zeros((mesh.node_count, mesh.node_count))
    values = mesh.shape_functions(points)
    for facet, nodes in enumerate(mesh.nodes):
        facets = np.full(len(points), facet)
        areas = weights * np.linalg.norm(mesh.area_normals(facets, points), axis=1)
        if is_axisymmetric:
            areas *= 2 * np.pi * mesh.positions(facets, points)[:, 0]
        matrix[np.ix_(nodes, nodes)] += values.T @ (areas[:, None] * values)
    return matrix


@pytest.mark.parametrize("shape", SHAPES)
def test_area_does_not_depend_on_the_rays(shape):
    """Oblique rays: still the slave's area, and where they lead."""
    slave = flat(shape, 3, 1)
    master = flat(shape, 4, -1, height=0.5, corner=(-0.1, -0.5), size=2.0)
    oblique = np.eye(slave.dimension)[-1] + 0.6 * np.eye(slave.dimension)[0]
    rays = np.tile(oblique / np.linalg.norm(oblique), (slave.node_count, 1))
    integrals = integrate(slave, master, rays, False)
    assert integrals.mass.sum() == pytest.approx(1, abs=1e-12)
    projected = written_out(integrals)
    found = projected @ node_places(master)[:, 0]
    np.testing.assert_allclose(found, node_places(slave)[:, 0] + 0.3, atol=1e-12)


# Parts of surfaces


@pytest.mark.parametrize("shape", SHAPES)
def test_facets_next_to_nothing_of_which_is_covered(shape):
    """Quadratic functions are multiples of each other on a sliver: its facet is left out."""
    slave = flat(shape, 1, 1, 2)
    barely = flat(shape, 2, -1, 2, corner=(1 - 1e-7, -0.5), size=2.0)
    integrals, _ = coupled(slave, barely)
    assert integrals.mass.count_nonzero() == 0
    assert integrals.coupling.count_nonzero() == 0
    assert not integrals.coverage.any()


@pytest.mark.parametrize("shape", SHAPES)
def test_facets_little_of_which_is_covered(shape):
    """Linear displacements of the master are reproduced from a thousandth of a facet on."""
    slave = flat(shape, 1, 1, 2)
    master = flat(shape, 2, -1, 2, corner=(1 - 2e-3, -0.5), size=2.0)
    integrals, projected = coupled(slave, master)
    covered = integrals.mass.diagonal() > 0
    found = projected @ node_places(master)[:, 0]
    np.testing.assert_allclose(found[covered], node_places(slave)[covered, 0], atol=1e-5)
    assert covered.any()


@pytest.mark.parametrize("shape", SHAPES)
def test_coverage_is_the_exact_share(shape):
    """A slave of three facets each way, covered from x = 0.5 on: none, half, all of a facet."""
    slave = flat(shape, 3, 1)
    master = flat(shape, 2, -1, corner=(0.5, -0.5), size=2.0)
    integrals, projected = coupled(slave, master)
    assert integrals.mass.sum() == pytest.approx(0.5, abs=1e-12)
    middles = slave.centres[:, 0]
    if shape != "triangle":
        expected = np.select([middles < 0.4, middles < 0.6], [0.0, 0.5], 1.0)
        np.testing.assert_allclose(integrals.coverage, expected, atol=1e-12)
    else:
        column = np.floor(3 * middles)
        for number, share in enumerate([0.0, 0.5, 1.0]):
            assert integrals.coverage[column == number].mean() == pytest.approx(share, abs=1e-12)
        halves = integrals.coverage[column == 1]
        np.testing.assert_allclose(np.sort(halves), [0.25] * 3 + [0.75] * 3, atol=1e-12)
    places = node_places(slave)
    far = places[:, 0] < 0.3
    assert not projected[far].any()
    found = projected @ polynomial(node_places(master), 1)
    np.testing.assert_allclose(found[~far], polynomial(places, 1)[~far], atol=1e-11)


def test_surfaces_that_do_not_face_each_other():
    slave, beside = flat("quadrilateral", 2, 1), flat("quadrilateral", 2, -1, corner=(1.5, 0.0))
    back = flat("quadrilateral", 2, 1, height=0.1)
    for master in (beside, back):
        integrals, projected = coupled(slave, master)
        assert integrals.mass.sum() == 0
        assert not integrals.coverage.any()
        assert not projected.any()
        directions, found = face(node_places(slave), slave.normals, master)
        np.testing.assert_array_equal(found.facet, -1)
        np.testing.assert_array_equal(directions, slave.normals)


@pytest.mark.parametrize("shape", SHAPES)
def test_only_the_nearest_layer_counts(shape):
    slave, near = flat(shape, 4, 1), flat(shape, 3, -1, height=0.1)
    far = flat(shape, 3, -1, height=4.0)
    both = FacetMesh(
        shape,
        1,
        1,
        np.concatenate([far.geometry, near.geometry]),
        np.concatenate([far.nodes, near.nodes + far.node_count]),
        np.concatenate([far.normals, near.normals]),
    )
    integrals, projected = coupled(slave, both)
    assert integrals.mass.sum() == pytest.approx(1, abs=1e-12)
    assert not projected[:, : far.node_count].any()
    found = hits(both, node_places(slave), slave.normals)
    np.testing.assert_allclose(found.distance, 0.1, atol=1e-12)


@pytest.mark.parametrize("degree", [1, 2])
def test_fixed_nodes_leave_the_mortar_space(degree):
    """A function that vanishes at the fixed nodes is reproduced, and the others' rows alone."""
    slave = flat("quadrilateral", 3, 1, degree)
    master = flat("quadrilateral", 4, -1, degree)
    places = node_places(slave)
    fixed = places[:, 0] < 1e-9
    assert fixed.sum() == 3 * degree + 1
    _, projected = coupled(slave, master, fixed=fixed)
    assert not projected[fixed].any()
    found = projected @ node_places(master)[:, 0] ** degree
    np.testing.assert_allclose(found, places[:, 0] ** degree, atol=1e-12)
    _, free = coupled(slave, master)
    assert np.abs(projected - free)[~fixed].max() > 1e-2


# Curved surfaces


@pytest.mark.parametrize(("order", "rate"), [(1, 2), (2, 4)])
def test_circles_in_circles(order, rate):
    """Total mass against 2π, the gap against the difference of the radii."""
    lengths, gaps = [], []
    for cells in (16, 32, 64):
        pin = arc(cells, 1.0, 1, order, order)
        hole = arc(3 * cells // 2 - 1, 1.1, -1, order, order)
        integrals, projected = coupled(pin, hole)
        _, found = face(node_places(pin), pin.normals, hole)
        assert (found.facet >= 0).all()
        lengths.append(integrals.mass.sum() - 2 * np.pi)
        gaps.append(np.abs(found.distance - 0.1).max())
        np.testing.assert_allclose(integrals.coverage, 1, atol=1e-7)
        assert integrals.coverage.max() <= 1
        np.testing.assert_allclose(projected.sum(axis=1), 1, atol=1e-12)
        np.testing.assert_allclose(
            np.asarray(integrals.coupling.sum(axis=1)),
            np.asarray(integrals.mass.sum(axis=1)),
            atol=1e-15,
        )
    np.testing.assert_allclose(orders(np.array(lengths)), rate, atol=0.1)
    np.testing.assert_allclose(orders(np.array(gaps)), rate, atol=0.3)


@pytest.mark.parametrize("radius", [0.3, 3.0])
def test_wide_gaps(radius):
    """Rays spread over a gap as wide as the circle, whether the slave is outside or inside."""
    side = 1 if radius > 1 else -1
    slave, master = arc(12, 1.0, side, 2, 2), arc(75, radius, -side, 2, 2)
    integrals, projected = coupled(slave, master)
    np.testing.assert_allclose(integrals.coverage, 1, atol=1e-3)
    x = [mesh.normals @ [0.6, 0.8] for mesh in (slave, master)]
    np.testing.assert_allclose(projected @ x[1], -x[0], atol=5e-3)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("shift", [0.0, 0.09, 0.15])
def test_pin_in_hole_hits_the_near_wall(side, shift):
    """Also where the pin is off centre, and where it overlaps the hole (shift 0.15)."""
    pin = arc(40, 1.0, 1, 2, 2, centre=(shift, 0.0))
    hole = arc(53, 1.1, -1, 2, 2)
    slave, master = (pin, hole) if side > 0 else (hole, pin)
    places = node_places(slave)
    directions, found = face(places, slave.normals, master)
    assert (found.facet >= 0).all()
    there = master.positions(found.facet, found.reference)
    np.testing.assert_allclose(there, places + found.distance[:, None] * directions, atol=1e-9)
    assert np.abs(found.distance).max() <= 0.1 + shift + 1e-3
    assert found.distance.min() == pytest.approx(0.1 - shift, abs=1e-4)
    # n̄ halves the angle between the normals.
    opposite = master.interpolate(master.normals, found.facet, found.reference)
    ours = np.einsum("pd,pd->p", directions, slave.normals)
    np.testing.assert_allclose(-np.einsum("pd,pd->p", directions, opposite), ours, atol=2e-6)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_caps_of_spheres(shape, order):
    """Total mass against the solid angle of a square in gnomonic coordinates, 4 asin(1/5).

    The pieces of curved facets are bounded by chords: order 2 whatever the geometry. Functions
    that are constant along rays are carried over the gap with the order of the spaces.
    """
    areas, errors = [], []
    for cells in (4, 8, 16):
        slave = cap(shape, cells, 1.0, 1, order, order)
        master = cap(shape, 3 * cells // 2, 1.05, -1, order, order, width=1.6, turn=0.4)
        integrals, projected = coupled(slave, master)
        np.testing.assert_allclose(integrals.coverage, 1, atol=1e-12)
        np.testing.assert_allclose(projected.sum(axis=1), 1, atol=1e-12)
        balance = np.asarray(integrals.coupling.sum(axis=1) - integrals.mass.sum(axis=1))
        np.testing.assert_allclose(balance, 0, atol=1e-15)
        areas.append(integrals.mass.sum() - 4 * np.arcsin(0.2))
        wave = [np.sin(2 * mesh.normals[:, 0]) for mesh in (slave, master)]
        error = projected @ wave[1] + wave[0]
        errors.append(np.sqrt(error @ integrals.mass @ error))
    np.testing.assert_allclose(orders(np.array(areas)), 2, atol=0.1)
    assert np.abs(areas[-1]) < (1e-3 if order == 1 else 2e-4)
    assert orders(np.array(errors))[-1] > order + 0.8


@pytest.mark.parametrize("overlap", [-0.02, 0.02])
@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_distances_of_spheres(shape, overlap):
    slave = cap(shape, 12, 1.0, 1, 2, 2)
    master = cap(shape, 11, 1.0 - overlap, -1, 2, 2, width=1.6, turn=0.4)
    directions, found = face(node_places(slave), slave.normals, master)
    np.testing.assert_allclose(found.distance, -overlap, atol=1e-4)
    np.testing.assert_allclose(directions, slave.normals, atol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_moved_surfaces(order):
    """A displacement linear in the place moves all points with it, whatever the degrees."""
    for degree in (1, 2):
        mesh = flat("quadrilateral", 3, 1, degree)
        if order == 2:
            mesh = cap("quadrilateral", 3, 1.0, 1, 2, 2)
        gradient = np.array([[0.1, 0.2, 0.0], [-0.3, 0.1, 0.1], [0.2, 0.0, 0.3]])
        moved = mesh.moved(node_places(mesh) @ gradient)
        generator = np.random.default_rng(5)
        facets, reference = generator.integers(len(mesh.nodes), size=20), generator.random((20, 2))
        before = mesh.positions(facets, reference)
        expected = before + before @ gradient
        np.testing.assert_allclose(moved.positions(facets, reference), expected, atol=1e-13)
        assert moved.normals is mesh.normals


def test_rings():
    """A cone frustum: area π (r₁ + r₂) s, and that of its outer half."""
    start, slope = 0.5, 0.75

    def cone(mesh, side):
        geometry = mesh.geometry * [1.0, 0.0] + [start, 0.0]
        geometry[:, :, 1] = slope * geometry[:, :, 0]
        normal = side * np.array([-slope, 1.0]) / np.hypot(1, slope)
        normals = np.tile(normal, (mesh.node_count, 1))
        return FacetMesh("interval", 1, mesh.degree, geometry, mesh.nodes, normals)

    slant = np.hypot(1, slope)
    slave = cone(flat("interval", 1, 1, degree=2), 1)
    integrals, projected = coupled(slave, cone(flat("interval", 3, -1, degree=2), -1), True)
    assert integrals.mass.sum() == pytest.approx(np.pi * 2.0 * slant, rel=1e-12)
    np.testing.assert_allclose(projected.sum(axis=1), 1, atol=1e-12)
    half = cone(flat("interval", 3, -1, corner=(0.5,), degree=2), -1)
    integrals, _ = coupled(slave, half, True)
    assert integrals.mass.sum() == pytest.approx(np.pi * 2.5 * slant / 2, rel=1e-12)
    assert integrals.coverage[0] == pytest.approx(0.5, rel=1e-12)


# Rays and polygons


@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_rays_at_edges_hit(shape):
    """Points opposite corners and edges, of the border too; the lowest of several facets."""
    master = flat(shape, 4, -1, height=0.5)
    x, y = np.meshgrid(np.arange(9) / 8, np.arange(9) / 8)
    points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    found = hits(master, points, up)
    np.testing.assert_allclose(found.distance, 0.5, atol=1e-15)
    for point, facet in zip(points[:, :2], found.facet, strict=True):
        corners = master.geometry[:, :, :2]
        low, high = corners.min(axis=1) - 1e-9, corners.max(axis=1) + 1e-9
        candidates = np.flatnonzero(((low <= point) & (point <= high)).all(axis=1))
        assert facet in candidates
        if shape == "quadrilateral":
            assert facet == candidates[0]
    beyond = hits(master, points + np.array([1.01, 0, 0]), up)
    assert (beyond.facet == -1).sum() == len(points)
    assert np.isinf(beyond.distance).all()


def test_rays_in_parts_are_the_same():
    """More lines than fit into one table of lines against facets."""
    master = flat("quadrilateral", 30, -1, height=0.5)
    points = np.random.default_rng(2).random((1000, 3)) * [1, 1, 0]
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    found = hits(master, points, up)
    cells = np.floor(30 * points[:, :2]).astype(int)
    np.testing.assert_array_equal(found.facet, cells[:, 0] + 30 * cells[:, 1])
    np.testing.assert_allclose(master.positions(found.facet, found.reference)[:, :2], points[:, :2])


SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
TRIANGLE = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]])


def moved(polygon, shift):
    return polygon + np.array(shift)


def turned(angle):
    return SQUARE @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize(
    ("polygon", "window", "area"),
    [
        (SQUARE, SQUARE, 4.0),
        (SQUARE, turned(np.pi / 4), 8 * (np.sqrt(2) - 1)),  # a regular octagon
        (SQUARE, moved(SQUARE, [0.5, 1.5]), 0.75),
        (SQUARE, moved(SQUARE, [2.0, 0.0]), 0.0),
        (SQUARE, moved(SQUARE, [5.0, 0.0]), 0.0),
        (SQUARE, 10 * SQUARE, 4.0),
        (SQUARE, 0.1 * SQUARE, 0.04),
        (TRIANGLE, SQUARE + 1.0, 3.5),  # the square's corner (2, 2) is cut off
        (SQUARE + 1.0, TRIANGLE, 3.5),
        (TRIANGLE, 2.0 - TRIANGLE, 3.0),  # 0 ≤ x, y ≤ 2 and 1 ≤ x + y ≤ 3
    ],
)
def test_common_areas_of_polygons(polygon, window, area):
    common = clip(
        counter_clockwise(polygon[None]),
        counter_clockwise(window[None]),
    )
    assert signed_areas(common)[0] == pytest.approx(area, abs=1e-14)
    triangles = fan(common, np.array([[1.0, 0.6]]))[0]
    np.testing.assert_allclose(signed_areas(triangles).sum(), area, atol=1e-14)
    assert signed_areas(triangles).min() >= -1e-15


def test_polygons_that_run_clockwise_are_reversed():
    both = np.stack([SQUARE, SQUARE[::-1]])
    np.testing.assert_allclose(signed_areas(both), [4, -4])
    np.testing.assert_allclose(signed_areas(counter_clockwise(both)), 4)


@pytest.mark.parametrize("turns", [(1, 0), (0, 1), (2, 1)])
def test_a_projection_does_not_depend_on_the_corner_that_a_facet_begins_at(turns):
    """It depends on the ranks that share a mesh, and ratios are not integrated exactly."""
    meshes = cap("triangle", 5, 1.0, 1), cap("triangle", 6, 1.05, -1, width=1.6, turn=0.4)
    _, expected = coupled(*meshes)
    _, found = coupled(*(begun_at(mesh, turn) for mesh, turn in zip(meshes, turns, strict=True)))
    np.testing.assert_allclose(found, expected, atol=1e-12)


def begun_at(mesh, corner):
    """Linear triangles, each with its nodes from another corner on."""
    turned = {name: np.roll(getattr(mesh, name), corner, axis=1) for name in ("geometry", "nodes")}
    return dataclasses.replace(mesh, **turned)
