"""What facets miss of curved surfaces; and friction beside nodes that cannot slip."""

import dataclasses

import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.mesh import CellType
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
    SolverSettings,
    Support,
    run,
)
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.spaces import Spaces
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, reference_nodes
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface, _least_squares
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.mesh.loading import load_body
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.solve.load_steps.load_stepper import stepping
from fenics_contact.trust.error_estimates.mesh.geometry import geometry_errors
from fenics_contact.trust.error_estimates.solving_again import Again
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import ROOT, box_body, with_solver

pytestmark = pytest.mark.errors
COMM = MPI.COMM_WORLD


def arc(order, cells, straight=False):
    """Facets of uneven lengths on a circle of radius 1, or on its tangent."""
    share = np.linspace(-1, 1, cells + 1)
    ends = 0.6 * (share + 0.1 * np.sin(3 * share))
    angles = np.stack([ends[:-1], ends[1:], 0.5 * (ends[:-1] + ends[1:])], axis=1)
    places = np.stack([np.sin(angles), -np.cos(angles)], axis=-1)
    if straight:
        places[..., 1] = -1
    numbers = 2 * np.arange(cells)
    nodes = np.stack([numbers, numbers + 2, numbers + 1], axis=1)
    normals = np.zeros((2 * cells + 1, 2))
    normals[nodes] = places / np.linalg.norm(places, axis=-1, keepdims=True)
    return FacetMesh("interval", order, 2, places[:, : order + 1], nodes, normals)


def cap(order, cells):
    """Triangles on a sphere of radius 1, seen from outside."""
    reference = reference_nodes("triangle", order)
    facets = []
    for i, j in np.ndindex(cells, cells):
        a, b, c, d = np.array([(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]) / cells - 0.5
        for x, y, z in ((a, b, c), (d, c, b)):
            flat = x + reference @ np.stack([y - x, z - x])
            facets.append(np.column_stack([flat, np.sqrt(1 - (flat**2).sum(axis=1))]))
    places = np.array(facets)
    corners = np.arange(3 * len(places)).reshape(-1, 3)
    return FacetMesh("triangle", order, 1, places, corners, places[:, :3].reshape(-1, 3))


def tube(around):
    """Uneven triangles of order 2 on a cylinder of radius 1, three rows of them."""
    reference, size = reference_nodes("triangle", 2), 2 * np.pi / around
    rows, columns = np.mgrid[: 3 + 1, : around + 1]
    uneven = 0.25 * np.sin(2.7 * rows + 1.9 * (columns % around) ** 2)
    angles, heights = columns + 0.5 * (rows % 2) + uneven, rows + uneven * (rows % 3 > 0)
    grid = size * np.stack([angles, heights], axis=-1)
    places = []
    for j, i in np.ndindex(3, around):
        a, b, c, d = grid[j, i], grid[j, i + 1], grid[j + 1, i], grid[j + 1, i + 1]
        for x, y, z in ((a, b, c), (d, c, b)) if j % 2 == 0 else ((a, b, d), (d, c, a)):
            angle, height = (x + reference @ np.stack([y - x, z - x])).T
            places.append(np.stack([np.cos(angle), np.sin(angle), height], axis=1))
    corners = np.arange(6 * around * 3).reshape(-1, 3)
    normals = np.array(places)[:, :3].reshape(-1, 3) * [1, 1, 0]
    return FacetMesh("triangle", 2, 1, np.array(places), corners, normals)


@pytest.mark.parametrize(("around", "share"), [(32, 0.2), (64, 0.05)])
def test_what_quadratic_triangles_miss_of_a_cylinder(around, share):
    """Neighbours reach far around it, where no polynomial follows: they are to count for less."""
    mesh = tube(around)
    facets = np.arange(len(mesh.nodes))
    reference = np.full((len(facets), 2), 1 / 3)
    true = 1 - np.linalg.norm(mesh.positions(facets, reference)[:, :2], axis=1)
    found = SmoothSurface(mesh).offsets(facets, reference)
    assert np.linalg.norm(found - true) < share * np.linalg.norm(true)


@pytest.mark.parametrize(
    ("surface", "order", "least"), [(arc, 1, 3.5), (arc, 2, 4.5), (cap, 1, 2.5)]
)
def test_what_facets_miss_is_found_but_for_higher_order(surface, order, least):
    errors, missed = [], []
    for cells in (4, 8, 16):
        mesh = surface(order, cells)
        inside = np.array([[0.2, 0.3], [0.4, 0.5], [0.1, 0.1]])[:, : mesh.dimension - 1]
        facets = np.repeat(np.arange(len(mesh.nodes)), len(inside))
        reference = np.tile(inside, (len(mesh.nodes), 1))
        true = 1 - np.linalg.norm(mesh.positions(facets, reference), axis=1)
        found = SmoothSurface(mesh).offsets(facets, reference)
        errors.append(np.abs(found - true).max())
        missed.append(np.abs(true).max())
    assert np.log2(errors[1] / errors[2]) > least
    assert errors[2] < 0.1 * missed[2]


def test_flat_facets_miss_nothing():
    mesh = arc(1, 6, straight=True)
    assert (SmoothSurface(mesh).at_nodes() == 0).all()


def test_blunt_edge_between_flat_sides_is_no_curve():
    mesh = arc(1, 8, straight=True)
    right = mesh.geometry[..., 0] > 1e-12
    mesh.geometry[..., 1] += 0.2 * np.where(right, mesh.geometry[..., 0], 0)
    assert np.abs(SmoothSurface(mesh).at_nodes()).max() < 1e-12


def half_disc(order):
    """A half disc pressed onto a plane."""
    source = MeshSource(
        str(ROOT / "meshes" / "half_disc.geo"),
        cell="quadrilateral",
        order=order,
        parameters={"radius": 8, "fine": 2, "size": 0.5, "growth": 1.8},
    )
    return Scene(
        kinematics="plane strain",
        mesh=(source,),
        material=Material(1000, 0.3),
        discretisation=Discretisation(2),
        support=(Support("face", {"x": 0, "y": 0}),),
        contact=(Contact("contact", obstacle=Obstacle("plane", normal=(0, 1), indentation=0.05)),),
    )


def test_straight_facets_of_a_disc_differ_from_curved_ones_by_the_estimate():
    """One mesh, with straight cells and with curved ones: what they are apart is the geometry's."""
    prepared = Run(half_disc(1), COMM)

    def measure(solution):
        values = contact_quantities(prepared.problem, solution, 0)
        return {name: values[name] for name in ("normal_force", "contact_area")}

    with stepping(prepared.problem, prepared.timings, prepared.choice) as load_steps:
        load_steps.solve()
        found = geometry_errors(load_steps, Again.of_last_step(load_steps, measure))
    straight = run(half_disc(1), COMM)
    curved = run(with_solver(half_disc(2), errors="none"), COMM)
    force = [result.quantities["normal_force"] for result in (straight, curved)]
    true = abs(force[0] - force[1])
    assert true > 0.02 * force[1]
    assert 0.7 * true < found["normal_force"] < 1.4 * true
    assert straight.errors["normal_force"]["mesh"] > true


@pytest.mark.parametrize("floor", ["roller", "rough floor"])
def test_friction_beside_a_corner_that_cannot_slip(floor):
    """Two obstacles driven by forces: all of a side slips, but for a zone within its last cell."""
    supports = (Support("x1", {"x": 0}),)
    contacts = tuple(
        Contact(on, obstacle=Obstacle(force=force), friction_coefficient=0.3)
        for on, force in (("y1", 8), ("x0", 5))
    )
    if floor == "roller":
        supports += (Support("y0", {"y": 0}),)
    else:
        contacts += (Contact("y0", friction_coefficient=0.3),)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        support=supports,
        contact=contacts,
    )
    result = run(scene, COMM, box_body((6, 6), (1, 1), CellType.triangle))
    fine = dataclasses.replace(with_solver(scene, errors="none"), discretisation=Discretisation(2))
    exact = run(fine, COMM, box_body((32, 32), (1, 1)))
    for number in range(len(contacts)):
        own, other = (found.contacts[number]["quantities"] for found in (result, exact))
        error = np.linalg.norm(np.subtract(own["friction_force"], other["friction_force"]))
        assert error < 1.5 * result.contacts[number]["errors"]["friction_force"]["total"]
        error = abs(own["normal_force"] - other["normal_force"])
        assert error < 1.5 * result.contacts[number]["errors"]["normal_force"]["total"] + 1e-9
        error = abs(own["slip_area"] - other["slip_area"])
        assert error < 1.5 * result.contacts[number]["errors"]["slip_area"]["total"] + 1e-9


def test_friction_beside_a_corner_where_the_next_node_nearly_slips():
    """A wall under pressure beside a clamped base: the node next to it sticks, and carries much."""
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(
            Contact("y1", obstacle=Obstacle(force=20), friction_coefficient=0.3),
            Contact("x1", pressure=5, friction_coefficient=0.3),
        ),
    )
    result = run(scene, COMM, box_body((12, 12), (1, 1)))
    fine = dataclasses.replace(with_solver(scene, errors="none"), discretisation=Discretisation(2))
    exact = run(fine, COMM, box_body((24, 24), (1, 1)))
    own, other = (found.contacts[1]["quantities"] for found in (result, exact))
    error = np.linalg.norm(np.subtract(own["friction_force"], other["friction_force"]))
    assert error > 0.05 * np.linalg.norm(other["friction_force"])
    assert error < 1.5 * result.contacts[1]["errors"]["friction_force"]["total"]


@pytest.mark.parametrize("cells", [4, 8])
def test_facets_at_45_degrees_to_each_other_miss_the_same_wherever_they_stand(cells):
    """The second neighbour's angle in quarters of a circle, the first one's in an octagon."""
    whole = np.pi / 2 if cells == 4 else 2 * np.pi
    missed = []
    for start in np.linspace(0, 6, 40):
        ends = start + whole * np.arange(cells + 1) / cells
        places = np.stack([np.cos(ends), np.sin(ends)], axis=1)
        geometry = np.stack([places[:-1], places[1:]], axis=1)
        numbers = np.arange(2 * cells).reshape(-1, 2)
        normals = np.repeat(geometry.mean(axis=1), 2, axis=0)
        facets = FacetMesh("interval", 1, 1, geometry, numbers, normals)
        missed.append(SmoothSurface(facets).offsets(np.arange(cells), np.full((cells, 1), 0.5)))
    np.testing.assert_allclose(missed, missed[:1] * 40, rtol=1e-6)
    sagitta = 1 - np.cos(whole / cells / 2)
    np.testing.assert_allclose(missed[0], sagitta, rtol=0.5)


def test_a_curve_that_is_asked_at_no_point_answers_for_none():
    """As at the middles of facets of a contact whose points are its nodes."""
    ends = np.pi / 2 * np.arange(4) / 3
    places = np.stack([np.cos(ends), np.sin(ends)], axis=1)
    geometry = np.stack([places[:-1], places[1:]], axis=1)
    facets = FacetMesh(
        "interval", 1, 1, geometry, np.arange(6).reshape(-1, 2), np.repeat(geometry.mean(1), 2, 0)
    )
    found = SmoothSurface(facets).offsets(np.zeros(0, dtype=np.int64), np.zeros((0, 1)))
    assert found.shape == (0,)


def ring(cells, cell=None):
    """A quarter of a ring, radii 1 and 2, with straight cells; y0 is the inner side."""
    body = box_body(cells, (1, 1, 1), cell)
    angle, radius = np.pi / 2 * body.mesh.geometry.x[:, 0], 1 + body.mesh.geometry.x[:, 1]
    body.mesh.geometry.x[:, 0] = radius * np.sin(angle)
    body.mesh.geometry.x[:, 1] = radius * np.cos(angle)
    return body


def missed(spaces):
    """What lies between facets and curve, and what the body has without it."""
    sides = CurvedSides(spaces, [])
    every = np.ones(len(sides.facets), dtype=bool)
    parts = (sides.offset * sides.measure(every), ufl.as_ufl(1.0) * spaces.bulk)
    return [COMM.allreduce(fem.assemble_scalar(fem.form(part))) for part in parts]


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_what_lies_between_straight_facets_and_the_curve(cell):
    dimension = 2 if cell in ("triangle", "quadrilateral") else 3
    body = ring((5, 2, 2)[:dimension], cell=CellType[cell])
    scene = Scene(
        kinematics="3D" if dimension == 3 else "plane strain", material=Material(1000, 0.3)
    )
    between, whole = missed(Spaces(BodyDescription.of(scene), body))
    assert between == pytest.approx(0.75 * np.pi - whole, rel=0.2)
    assert between > 0.005 * whole


def test_flat_sides_take_no_polynomials_and_miss_what_these_say(monkeypatch):
    """Of a block none is made; beside a curve those of which one is no plane."""
    made = []
    fit = SmoothSurface._fit
    monkeypatch.setattr(
        SmoothSurface, "_fit", lambda self, numbers: made.extend(numbers) or fit(self, numbers)
    )
    scene = Scene(kinematics="3D", material=Material(1000, 0.3))
    block, curved = box_body((3, 3, 2), (1, 1, 1)), ring((4, 9, 3))
    assert CurvedSides(Spaces(BodyDescription.of(scene), block), []).offset is None
    assert not made
    few = missed(Spaces(BodyDescription.of(scene), curved))
    chosen = COMM.allreduce(len(made))
    monkeypatch.setattr(
        SmoothSurface, "_is_near_curve", lambda self, normals: np.ones(len(normals), dtype=bool)
    )
    made.clear()
    assert missed(Spaces(BodyDescription.of(scene), curved)) == pytest.approx(few, rel=1e-12)
    assert 0 < chosen < COMM.allreduce(len(made))


def test_polynomials_found_together_are_those_of_each_alone():
    """Of points of any number, also where they say too little for all coefficients."""
    random = np.random.default_rng(1)
    counts, size = np.array([6, 9, 14, 9]), 6
    powers, heights = random.normal(size=(4, 14, size)), random.normal(size=(4, 14))
    powers[3, :, 4] = powers[3, :, 1] + powers[3, :, 2]
    weights = random.uniform(0.1, 1e3, (4, 14)) * (np.arange(14) < counts[:, None])
    found = _least_squares(powers, heights, weights, counts)
    for number, count in enumerate(counts):
        one, weight = powers[number, :count], weights[number, :count]
        alone, *_ = np.linalg.lstsq(weight[:, None] * one, weight * heights[number, :count])
        np.testing.assert_allclose(found[number], alone, rtol=1e-9)


def test_what_lies_between_quadratic_facets_and_the_curve():
    scene = half_disc(2)
    between, whole = missed(Spaces(BodyDescription.of(scene), load_body(scene.mesh, 2, COMM)))
    true = 32 * np.pi - whole
    assert 0 < true < 1e-3 * whole
    assert 0.5 * true < between < 2 * true  # cells grow by 1.8 from one to the next


RING = Scene(
    kinematics="plane strain",
    material=Material(1000, 0.3),
    discretisation=Discretisation(2),
    support=(Support("x0", {"x": 0}), Support("x1", {"y": 0})),
    solver=SolverSettings(errors="all"),
)


@pytest.mark.parametrize(
    ("load", "exact"),
    [
        (Load("body", body_force=(0, -10)), 7.5 * np.pi),
        (Load("y1", traction=(0, -10)), 10 * np.pi),
        (Load("y0", traction=(0, -10)), 5 * np.pi),
    ],
    ids=["weight", "outside", "inside"],
)
def test_straight_cells_lack_weight_and_length_of_sides(load, exact):
    result = run(dataclasses.replace(RING, load=(load,)), COMM, ring((4, 4)))
    error = abs(result.reactions["x1"]["reaction"][1] - exact)
    assert error > 0.005 * exact
    assert error < result.reactions["x1"]["errors"]["reaction"]["total"] < 2 * error


def test_straight_cells_lack_stiffness():
    """A ring under pressure from inside: G. Lamé's formulas, E = 1000, ν = .3, plane strain."""
    scene = dataclasses.replace(
        RING, load=(Load("y0", pressure=10),), point=(Point("outer", (0, 2)),)
    )
    result = run(scene, COMM, ring((4, 4)))
    widened = 10 / 3 * 1.3 / 1000 * ((1 - 2 * 0.3) * np.array([1, 2]) + 4 / np.array([1, 2]))
    exact = {
        "strain_energy": 0.5 * 10 * np.pi / 2 * widened[0],
        "displacement_outer": np.array([0, widened[1]]),
    }
    for name in ("strain_energy", "displacement_outer"):
        error = np.linalg.norm(result.quantities[name] - exact[name])
        assert error > 0.003 * np.linalg.norm(exact[name])
        assert error < result.errors[name]["total"] < 6 * error


def test_ring_that_is_held_outside_is_no_stiffer_there():
    """Displacements vanish on the curve, not on facets inside of it: that makes it softer."""
    scene = dataclasses.replace(
        RING,
        support=(*RING.support, Support("y1", {"x": 0, "y": 0})),
        load=(Load("y0", pressure=10),),
    )
    result = run(scene, COMM, ring((4, 4)))
    fine = run(with_solver(scene, errors="none"), COMM, ring((48, 16)))
    error = abs(result.quantities["strain_energy"] - fine.quantities["strain_energy"])
    assert error < result.errors["strain_energy"]["total"] < 6 * error


def wave(points):
    return -10 * np.sin(5 * points[0])


def step(points):
    return -10.0 * (points[0] > 0.4)


@pytest.mark.parametrize(
    ("load", "exact"),
    [
        (Load("y1", traction=(0, wave)), 2 * (1 - np.cos(5))),
        (Load("body", body_force=(0, wave)), 2 * (1 - np.cos(5))),
        (Load("y1", pressure=lambda x: -step(x)), 6.0),
    ],
    ids=["traction", "body force", "step"],
)
def test_loads_by_functions_are_not_what_nodes_say(load, exact):
    scene = dataclasses.replace(
        RING,
        support=(Support("y0", {"x": 0, "y": 0}),),
        discretisation=Discretisation(1),
        load=(load,),
    )
    result = run(scene, COMM, box_body((6, 6), (1, 1), CellType.triangle))
    error = abs(result.quantities["reaction"][1] - exact)
    assert error > 0.01 * exact
    assert error < result.errors["reaction"]["total"] < 3 * error


@pytest.mark.parametrize(
    ("body", "pressure", "exact"),
    [
        (lambda: ring((4, 4)), 10, (20 * np.sqrt(2), 10 * np.pi)),
        (lambda: box_body((6, 6), (1, 1)), lambda x: 20 * np.sin(5 * x[0]) ** 2, (10.5440211,) * 2),
    ],
    ids=["curve", "function"],
)
def test_pressure_that_is_given_is_not_what_nodes_and_their_normals_say(body, pressure, exact):
    scene = dataclasses.replace(
        RING,
        discretisation=Discretisation(1),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", pressure=pressure, friction_coefficient=0.1),),
    )
    result = run(scene, COMM, body())
    for name, true in zip(("normal_force", "pressure_integral"), exact, strict=True):
        error = abs(result.quantities[name] - true)
        assert error > 0.005 * true
        assert error < result.errors[name]["total"] < 3 * error


def test_the_rule_of_points_misses_of_curved_cells_what_the_bar_of_the_area_says():
    """Beneath a pressure on a quarter of a circle, on cells of order 2: almost none before."""
    body = boxes((Box("body", (0.0, 0.0), (1.0, 1.0), (8, 2)),), "quadrilateral", COMM, 2)
    angle, radius = np.pi / 2 * body.mesh.geometry.x[:, 0], 1 + body.mesh.geometry.x[:, 1]
    body.mesh.geometry.x[:, 0] = radius * np.sin(angle)
    body.mesh.geometry.x[:, 1] = radius * np.cos(angle)
    contact = Contact("body.y0", pressure=1.0, friction_coefficient=0.1)
    support = (Support("body.x0", {"x": 0}), Support("body.x1", {"y": 0}))
    result = run(dataclasses.replace(RING, support=support, contact=(contact,)), COMM, body)
    error = abs(result.quantities["contact_area"] - np.pi / 2)
    assert error > 1e-6
    assert error < result.errors["contact_area"]["total"] < 3 * error
