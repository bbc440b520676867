"""P = D⁻¹ M as a factor and a sparse matrix: the numbers of P written out, without its size."""

import tracemalloc

import numpy as np
import pytest
from mpi4py import MPI
from scipy.sparse import csr_matrix

from fenics_contact import Contact, Discretisation, Material, Scene, Support
from fenics_contact.contact.mortar.projection import (
    MortarIntegrals,
    NodalProjection,
    Projection,
    integrate,
)
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.verification.boxes import Box, boxes
from tests.contact.mortar.facet_meshes import flat, node_places

COMM = MPI.COMM_WORLD


def lagrange(cells, degree, low, high, points):
    """Shape functions of a line's nodes in turn, (points, nodes), and where the nodes are."""
    width = (high - low) / cells
    cell = np.clip(((points - low) / width).astype(int), 0, cells - 1)
    local = (points - low) / width - cell
    places = np.arange(degree + 1) / degree
    found = np.zeros((len(points), cells * degree + 1))
    for number, place in enumerate(places):
        others = np.delete(places, number)
        values = np.prod((local[:, None] - others) / (place - others), axis=1)
        found[np.arange(len(points)), cell * degree + number] = values
    return found, np.linspace(low, high, cells * degree + 1)


def line_projection(cells, degree, low, high):
    """P of a line on [0, 1] against one from low to high, by Gauss's rule between all ends."""
    begin, end = max(0.0, low), min(1.0, high)
    ends = np.concatenate([np.linspace(0, 1, cells[0] + 1), np.linspace(low, high, cells[1] + 1)])
    ends = np.unique(np.round(np.clip(ends, begin, end), 12))
    points, weights = np.polynomial.legendre.leggauss(4)
    middles, halves = (ends[1:] + ends[:-1]) / 2, np.diff(ends) / 2
    points = (middles[:, None] + halves[:, None] * points).ravel()
    weights = (halves[:, None] * weights).ravel()
    ours, here = lagrange(cells[0], degree, 0.0, 1.0, points)
    theirs, there = lagrange(cells[1], degree, low, high, points)
    mass, coupling = (ours.T @ (weights[:, None] * other) for other in (ours, theirs))
    active = mass.diagonal() > 1e-14
    found = np.zeros(coupling.shape)
    found[active] = np.linalg.solve(mass[np.ix_(active, active)], coupling[active])
    return found, here, there


def numbers_of(mesh, x, y):
    """Numbers of a square's nodes, those along y in turn, then along x, by their places."""
    places = node_places(mesh)
    along = [
        np.abs(places[:, axis, None] - line).argmin(axis=1) for axis, line in enumerate((x, y))
    ]
    return along[0] * len(y) + along[1]


@pytest.mark.parametrize("corner", [0.0, 0.4])
@pytest.mark.parametrize("degree", [1, 2])
def test_squares_have_the_product_of_lines(degree, corner):
    """Against P of lines, worked out densely and by another quadrature; also where partly covered.

    A square of facets against another one has the Kronecker product of these.
    """
    across, x, far_x = line_projection((3, 4), degree, corner, 2 + corner)
    along, y, far_y = line_projection((3, 4), degree, -0.7, 1.3)
    slave = flat("quadrilateral", 3, 1, degree)
    master = flat("quadrilateral", 4, -1, degree, height=0.1, corner=(corner, -0.7), size=2.0)
    expected = np.kron(across, along)
    expected = expected[np.ix_(numbers_of(slave, x, y), numbers_of(master, far_x, far_y))]
    found = between(slave, master)
    assert found.shape == expected.shape
    np.testing.assert_allclose(found.apply(np.eye(found.shape[1])), expected, atol=1e-12)
    np.testing.assert_allclose(found.transposed(np.eye(found.shape[0])), expected.T, atol=1e-12)
    np.testing.assert_array_equal(found.nonzero_rows(), expected.any(axis=1))


def between(slave, master, fixed=None, used=None):
    upward = np.tile(np.eye(slave.dimension)[-1], (slave.node_count, 1))
    integrals = integrate(slave, master, upward, False)
    every = np.ones(slave.node_count, dtype=bool)
    fixed, used = (~every if fixed is None else fixed), (every if used is None else used)
    return NodalProjection.between(integrals, fixed, used)


def dense(integrals, fixed, used):
    """P by its definition."""
    mass, coupling = integrals.mass.toarray(), integrals.coupling.toarray()
    active = (mass.diagonal() > 0) & ~fixed
    found = np.zeros(coupling.shape)
    found[active] = np.linalg.solve(mass[np.ix_(active, active)], coupling[active])
    found[~used] = 0
    return found


@pytest.mark.parametrize("shape", ["interval", "triangle", "quadrilateral"])
def test_parts_of_a_projection_are_those_of_the_matrix(shape):
    """Nodes taken out, rows not used, some rows and columns of it; one vector or many.

    A node with hardly any covered area has entries of about 50, known to fewer digits.
    """
    slave = flat(shape, 6, 1, 2)
    master = flat(shape, 5, -1, 2, corner=(0.3, -0.2), size=1.5)
    upward = np.tile(np.eye(slave.dimension)[-1], (slave.node_count, 1))
    integrals = integrate(slave, master, upward, False)
    random = np.random.default_rng(2)
    fixed, used = random.random((2, slave.node_count)) < [[0.1], [0.9]]
    whole = NodalProjection.between(integrals, fixed, used)
    expected = dense(integrals, fixed, used)
    rows = np.flatnonzero(random.random(slave.node_count) < 0.6)
    columns = random.permutation(master.node_count)[: master.node_count // 2]
    part, matrix = whole.restricted(rows, columns), expected[np.ix_(rows, columns)]
    assert part.shape == matrix.shape
    for size in ((), (1,), (3, 70)):
        values = random.normal(size=(len(columns), *size))
        forces = random.normal(size=(len(rows), *size))
        to_slave = np.tensordot(matrix, values, axes=1)
        np.testing.assert_allclose(part.apply(values), to_slave, rtol=0, atol=1e-9)
        to_master = np.tensordot(matrix.T, forces, axes=1)
        np.testing.assert_allclose(part.transposed(forces), to_master, rtol=0, atol=1e-9)
    some = np.arange(len(rows))[::3]
    np.testing.assert_allclose(part.written_rows(some), matrix[some], rtol=0, atol=1e-9)
    again = part.restricted(some, np.arange(len(columns)))
    np.testing.assert_allclose(again.apply(np.eye(len(columns))), matrix[some], atol=1e-9)


def test_rows_are_zero_where_a_part_of_the_slave_meets_no_chosen_master():
    """Two parts of a slave that share no node, each against its own part of the master."""
    mass = csr_matrix(np.kron(np.eye(2), [[2.0, 1.0], [1.0, 2.0]]))
    coupling = csr_matrix(np.array([[1.0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 1, 0]]))
    integrals = MortarIntegrals(mass, coupling, np.ones(2))
    none = np.zeros(4, dtype=bool)
    whole = NodalProjection.between(integrals, none, ~none)
    for columns in ([0], [1, 2], [0, 2], []):
        part = whole.restricted(np.arange(4), columns)
        expected = np.linalg.solve(mass.toarray(), coupling.toarray())[:, columns]
        np.testing.assert_array_equal(part.nonzero_rows(), expected.any(axis=1))
        np.testing.assert_allclose(part.apply(np.eye(len(columns))), expected, atol=1e-15)
        assert part.transposed(np.ones(4)).shape == (len(columns),)


def test_no_node_that_faces_the_master():
    slave, beside = flat("quadrilateral", 2, 1), flat("quadrilateral", 2, -1, corner=(1.5, 0.0))
    found = between(slave, beside)
    assert not found.apply(np.ones(9)).any()
    assert not found.transposed(np.ones(9)).any()
    assert not found.nonzero_rows().any()


def test_memory_grows_with_the_surfaces():
    """Made and applied both ways, in less than a fifth of what P takes written out."""
    slave, master = flat("quadrilateral", 40, 1), flat("quadrilateral", 37, -1)
    upward = np.tile([0.0, 0.0, 1.0], (slave.node_count, 1))
    integrals = integrate(slave, master, upward, False)
    fixed = np.zeros((slave.node_count, 3), dtype=bool)
    fixed[0, 0] = True
    tracemalloc.start()
    made = Projection.between(integrals, fixed, np.ones(slave.node_count, dtype=bool))
    made.transposed(made.apply(np.ones((master.node_count, 3))))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < slave.node_count * master.node_count * 8 / 5
    assert made.components[1] is made.components[2]
    for part in made.components:
        assert stored(part) < 60 * (slave.node_count + master.node_count)


def stored(thing, seen=None):
    """Numbers in all arrays and factors that an object holds."""
    seen = set() if seen is None else seen
    if id(thing) in seen:
        return 0
    seen.add(id(thing))
    if isinstance(thing, np.ndarray):
        return thing.size
    if hasattr(thing, "indptr"):
        return thing.data.size
    if type(thing).__name__ == "SuperLU":
        return thing.L.nnz + thing.U.nnz
    parts = thing if isinstance(thing, (list, tuple)) else vars(thing).values()
    return sum(stored(part, seen) for part in parts if not np.isscalar(part) and part is not None)


def problem_of(cells, degree=1):
    """Two blocks whose sides hold some of the slave's dofs."""
    parts = (
        Box("lower", (0, 0, -1), (1, 1, 0), (*cells[0], 1)),
        Box("upper", (0.2, 0, 0), (1.1, 1, 1), (*cells[1], 1)),
    )
    clamped = dict.fromkeys("xyz", 0.0)
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=(
            Support("lower.z0", clamped),
            Support("upper.z1", clamped | {"z": -0.01}),
            Support("lower.y0", {"y": 0.0}),
        ),
        contact=(Contact("lower.z1", against="upper.z0", friction_coefficient=0.3, slave="on"),),
    )
    return Problem.on_mesh(scene, boxes(parts, "hexahedron"))


@pytest.mark.parametrize("degree", [1, 2])
def test_the_tangent_between_bodies_is_made_by_rows(degree):
    """Jᵀ K J of any K, against the product of written out matrices; each row on one rank."""
    problem = problem_of(((4, 3), (3, 5)), degree)
    surface = SurfaceMatrix(problem.contacts[0])
    pair, pairing = surface.pair, problem.contacts[0].kinematics.pairing
    slaves, masters = len(surface.dofs), len(pairing.dofs)
    random = np.random.default_rng(5)
    tangent = random.normal(size=(slaves, slaves)) * (random.random((slaves, slaves)) < 0.1)
    tangent[3] = 0.0
    rows, columns = np.nonzero(tangent)
    mine = rows % COMM.size == COMM.rank
    entries = rows[mine], columns[mine], tangent[rows[mine], columns[mine]]
    unit = np.eye(masters).reshape(-1, 3, masters)
    whole_p = pairing.whole_projection()
    jump = np.hstack([np.eye(slaves), -whole_p.apply(unit).reshape(slaves, masters)])
    expected = jump.T @ tangent @ jump
    whole = np.zeros((COMM.size, *expected.shape))
    for numbers, block in pair.rows(COMM, entries):
        whole[COMM.rank, np.searchsorted(pair.dofs, numbers, sorter=np.argsort(pair.dofs))] += block
    whole = COMM.allreduce(whole)
    assert (whole.any(axis=2).sum(axis=0) <= 1).all()
    order = np.argsort(pair.dofs)
    np.testing.assert_allclose(whole.sum(axis=0), expected[order], rtol=0, atol=1e-12)


def test_the_pair_is_kept_and_its_tangent_made_without_its_square():
    problem = problem_of(((24, 24), (22, 22)))
    surface = SurfaceMatrix(problem.contacts[0])
    pairing = problem.contacts[0].kinematics.pairing
    size = len(surface.dofs) + len(pairing.dofs)
    assert stored(pairing.whole_projection()) < 100 * size
    numbers = np.arange(COMM.rank, len(surface.dofs), COMM.size)
    tracemalloc.start()
    rows = surface.pair.rows(COMM, (numbers, numbers, np.ones(len(numbers))))
    made = sum(len(block) for _, block in rows)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert COMM.allreduce(made) > 0.9 * size  # all but what lies beyond the slave
    assert peak < size**2 * 8 / 4


def test_the_condensed_unknowns_are_kept_and_used_without_their_square():
    """Also where supports hold dofs of the slave; only the tangent has those jumps written out."""
    problem = problem_of(((24, 24), (22, 22)))
    surfaces = [SurfaceMatrix(contact) for contact in problem.contacts]
    dofs = ContactDofs(problem.spaces, problem.constrained, problem.discrete.sides)
    tracemalloc.start()
    variables = ContactVariables(dofs, surfaces)
    moved = variables.displacements(np.ones(variables.count))
    variables.derived_jumps(variables.unknowns(moved))
    variables.forces(moved)
    variables.held_part(surfaces[0], np.ones(len(dofs.numbers)))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert variables.derived_count == 20  # held nodes at y = 0 that face the upper block
    assert peak < variables.count**2 * 8 / 40


@pytest.mark.parametrize("degree", [1, 2])
def test_the_spread_projection_is_the_whole_one(degree):
    """Against P of the gathered surfaces; where supports hold slaves, and beyond the master.

    And each is the other's transpose.
    """
    problem = problem_of(((4, 3), (3, 5)), degree)
    pairing = problem.contacts[0].kinematics.pairing
    slave, master = problem.contacts[0].trace.surface, pairing.master
    whole, spread = pairing.whole_projection(), pairing.projection
    random = np.random.default_rng(3)  # the same on every rank
    values = random.normal(size=(whole.components[0].shape[1], 3, 2))
    forces = random.normal(size=(whole.components[0].shape[0], 3, 2))
    ours = slave.numbers[: slave.owned_nodes]
    theirs = master.numbers[: master.owned_nodes]
    moved, taken = spread.apply(values[theirs]), spread.transposed(forces[ours])
    np.testing.assert_allclose(moved, whole.apply(values)[ours], rtol=0, atol=1e-10)
    np.testing.assert_allclose(taken, whole.transposed(forces)[theirs], rtol=0, atol=1e-10)
    works = COMM.allreduce(np.array([np.sum(moved * forces[ours]), np.sum(taken * values[theirs])]))
    assert works[0] == pytest.approx(works[1], rel=1e-12)


def test_ranks_hold_a_part_of_the_integrals():
    """In proportion to their facets of the slave, however few these are."""
    problem = problem_of(((12, 12), (11, 11)))
    pairing = problem.contacts[0].kinematics.pairing
    own = pairing._present.rows.integrals
    sizes = np.array(COMM.allgather((len(pairing.shares), own.coupling.nnz)))
    assert sizes[:, 0].sum() == 144
    assert (sizes[:, 1] <= 36 * sizes[:, 0]).all()  # four nodes, each opposite to nine
