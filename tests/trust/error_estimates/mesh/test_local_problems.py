"""Local error problems: exact fields, effectivity against fine meshes, edges of contact, ranks."""

import numpy as np
import pytest
from dolfinx import fem, geometry
from dolfinx import mesh as dolfinx_mesh
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Load, Material, Obstacle, Run, Scene, Support
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.parallel import gather_rows
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors
from tests.scenes import box_body

COMM = MPI.COMM_WORLD


def errors_of(prepared):
    local = LocalErrors(prepared.problem)
    local.solve(BulkForces(prepared.problem, prepared.solution), prepared.scene.steps.last)
    return local


NEARLY = 0.4999


def bent(kinematics, degree, comm=COMM, cells=4, cell=CellType.quadrilateral, ratio=0.3):
    """A block on its base, sheared at its top by a traction that varies; and its strain energy."""
    dimension = 3 if kinematics == "3D" else 2
    axes = "xyz"[:dimension]

    def pull(points):
        return 10 * np.sin(2 * points[0])

    scene = Scene(
        kinematics=kinematics,
        material=Material(1000, ratio),
        discretisation=Discretisation(degree),
        support=(Support(f"{axes[-1]}0", dict.fromkeys(axes, 0)),),
        load=(
            Load(f"{axes[-1]}1", traction=(pull, *(0,) * (dimension - 1))),
            Load("body", body_force=(*(0,) * (dimension - 1), pull)),
        ),
    )
    count = (cells,) * dimension
    prepared = Run(scene, comm, box_body(count, (1.0,) * dimension, cell, comm))
    return prepared, prepared.solve().quantities["strain_energy"]


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(
    ("kinematics", "cell", "ratio"),
    [
        ("plane strain", CellType.triangle, 0.3),
        ("axisymmetric", CellType.quadrilateral, 0.3),
        ("3D", CellType.tetrahedron, 0.3),
        ("3D", CellType.hexahedron, 0.3),
        ("plane strain", CellType.triangle, NEARLY),
        ("axisymmetric", CellType.quadrilateral, NEARLY),
    ],
)
def test_uniform_stress_has_no_error(kinematics, cell, degree, ratio):
    """Free sides, sides that supports hold, a load, and contact, which all leave nothing."""
    dimension = 3 if kinematics == "3D" else 2
    axes = "xyz"[:dimension]
    scene = Scene(
        kinematics=kinematics,
        material=Material(1000, ratio),
        discretisation=Discretisation(degree),
        support=tuple(Support(f"{axis}0", {axis: 0}) for axis in axes[:-1]),
        load=(Load(f"{axes[-1]}1", pressure=10),),
        contact=(Contact(f"{axes[-1]}0", obstacle=Obstacle(gap=0)),),
    )
    body = box_body((2, 3, 2)[:dimension], (2, 1, 0.5)[:dimension], cell)
    prepared = Run(scene, COMM, body)
    energy = prepared.solve().quantities["strain_energy"]
    assert errors_of(prepared).total < 1e-7 * np.sqrt(energy)


@pytest.mark.parametrize(
    ("kinematics", "cell", "degree", "cells"),
    [
        ("plane strain", CellType.triangle, 1, 8),
        ("plane strain", CellType.triangle, 2, 4),
        ("plane stress", CellType.quadrilateral, 1, 8),
        ("axisymmetric", CellType.quadrilateral, 2, 4),
        ("3D", CellType.tetrahedron, 2, 2),
        ("3D", CellType.hexahedron, 2, 2),
    ],
)
def test_total_is_about_that_against_a_fine_mesh(kinematics, cell, degree, cells):
    """Under loads alone the energy falls short by half the square of the error's norm."""
    coarse, energy = bent(kinematics, degree, cells=cells, cell=cell)
    fine = 4 if kinematics != "3D" else 3
    true = np.sqrt(2 * (bent(kinematics, 2, cells=fine * cells, cell=cell)[1] - energy))
    assert 0.75 < errors_of(coarse).total / true < 2.5


@pytest.mark.parametrize(
    ("cell", "degree"),
    [
        (CellType.triangle, 1),
        (CellType.triangle, 2),
        (CellType.quadrilateral, 1),
        (CellType.quadrilateral, 2),
    ],
)
def test_total_of_nearly_incompressible_bodies_is_that_of_the_true_stress(cell, degree):
    """½ ∫ s : s / 2G + r² / 2K of the difference from a fine mesh's stress, by quadrature there.

    Neither grows as ν → ½. (The energies alone tell less: a mean stress's error takes from them.)
    """
    totals = []
    for ratio in (0.49, NEARLY):
        coarse, _ = bent("plane strain", degree, cells=8 // degree, cell=cell, ratio=ratio)
        total = errors_of(coarse).total
        true = distance_from_fine(coarse, ratio)
        assert 0.6 < total / true < 3, (ratio, total / true)
        totals.append(total)
    assert totals[1] == pytest.approx(totals[0], rel=0.2)


def distance_from_fine(coarse, ratio):
    """Energy norm of the stress's error, at the middles of a fine mesh's cells."""
    fine, _ = bent("plane strain", 2, MPI.COMM_SELF, cells=24, ratio=ratio)
    made = fine.problem.spaces.body.mesh
    count = made.topology.index_map(2).size_local
    cells = np.arange(count, dtype=np.int32)
    points = dolfinx_mesh.compute_midpoints(made, 2, cells)
    expected = stress_at(fine.problem, points, MPI.COMM_SELF)
    found = stress_at(coarse.problem, points, COMM)
    apart = (found - expected).reshape(-1, 3, 3)
    mean = np.trace(apart, axis1=1, axis2=2) / 3
    deviator = apart - mean[:, None, None] * np.eye(3)
    shear, bulk = 1000 / 2 / (1 + ratio), 1000 / 3 / (1 - 2 * ratio)
    density = (deviator**2).sum(axis=(1, 2)) / 2 / shear + mean**2 / bulk
    return np.sqrt(density.sum() / count)


def stress_at(problem, points, comm):
    """(points, 9), wherever they are."""
    mesh = problem.spaces.body.mesh
    tree = geometry.bb_tree(mesh, 2, padding=1e-12)
    near = geometry.compute_collisions_points(tree, points)
    inside = geometry.compute_colliding_cells(mesh, near, points)
    owned = mesh.topology.index_map(2).size_local
    found, counts = np.zeros((len(points), 9)), np.zeros(len(points))
    space = fem.functionspace(mesh, ("DG", 2, (3, 3)))
    stress = fem.Function(space)
    points_of_cells = compat.interpolation_points(space.element)
    stress.interpolate(form_cache.expression(problem.elastic.stress(), points_of_cells))
    for number, point in enumerate(points):
        own = [cell for cell in inside.links(number) if cell < owned]
        if own:
            found[number] = stress.eval(point, own[0])
            counts[number] = 1
    return comm.allreduce(found) / comm.allreduce(counts)[:, None]


def test_a_wrong_solution_has_a_large_error():
    """Waves from node to node of a fiftieth of the displacement."""
    prepared, _ = bent("plane strain", 2)
    right = errors_of(prepared).total
    displacement = prepared.problem.displacement.x.array
    places = prepared.problem.spaces.coordinates[:, :2]
    waves = np.cos(8 * np.pi * places).prod(axis=1)
    displacement += 0.02 * COMM.allreduce(np.abs(displacement).max(), MPI.MAX) * np.repeat(waves, 2)
    assert errors_of(prepared).total > 3 * right


@pytest.mark.parametrize(("cell", "degree"), [(CellType.triangle, 2), (CellType.tetrahedron, 1)])
def test_the_rule_of_simplices_leaves_nothing_out(cell, degree, monkeypatch):
    """As by the rule of quadrilaterals and hexahedra, which is of a higher degree."""
    kinematics = "3D" if cell == CellType.tetrahedron else "plane strain"
    prepared, _ = bent(kinematics, degree, cells=3, cell=cell)
    found = errors_of(prepared)
    monkeypatch.setattr(compat, "is_tensor_cell", lambda mesh: True)
    finer = errors_of(prepared)
    assert found.total == pytest.approx(finer.total, rel=1e-10)
    np.testing.assert_allclose(found.forces().nodal, finer.forces().nodal, atol=1e-9 * finer.total)


@pytest.mark.parametrize("ratio", [0.3, NEARLY])
def test_the_same_on_any_number_of_ranks(ratio):
    comms = (COMM, MPI.COMM_SELF)
    found = [errors_of(bent("axisymmetric", 2, comm, ratio=ratio)[0]) for comm in comms]
    assert found[0].total == pytest.approx(found[1].total, rel=1e-8)
    own = [np.sum(local.forces().nodal ** 2) for local in found]
    assert np.isfinite(own).all()


def pressed(cells=32):
    """A cylinder pressed into the middle of a block, several cells wide."""
    obstacle = Obstacle("parabola", radius=0.5, position=(1, 1), indentation=0.05)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(2),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle),),
    )
    body = box_body((cells, cells // 2), (2, 1), CellType.quadrilateral)
    return scene, body


def test_the_edge_of_contact_has_the_largest_errors_of_the_surface():
    scene, body = pressed()
    prepared = Run(scene, COMM, body)
    half = prepared.solve().quantities["contact_area"] / 2
    local = errors_of(prepared)
    cells = np.arange(len(local.squared), dtype=np.int32)
    middles = dolfinx_mesh.compute_midpoints(body.mesh, 2, cells)
    rows = gather_rows(COMM, np.column_stack([middles, local.squared]))
    upper = rows[rows[:, 1] > 0.5]
    worst = upper[upper[:, 3].argmax()]
    assert abs(abs(worst[0] - 1) - half) < 2 / 32 and worst[1] > 0.9
