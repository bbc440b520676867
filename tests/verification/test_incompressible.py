"""ν = .4999: neither displacements locked nor pressures ruined, against closed forms."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Load, Material, Run, Scene, Support
from fenics_contact.body import elastic_body
from fenics_contact.evaluate.stress_at_places import NodalStress
from tests.body.test_materials import bimaterial
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
E, NU = 1e3, 0.4999
ELEMENTS = {
    "P1": (CellType.triangle, 1),
    "Q1": (CellType.quadrilateral, 1),
    "P2": (CellType.triangle, 2),
    "Q2": (CellType.quadrilateral, 2),
}


def worst(values):
    return COMM.allreduce(np.abs(values).max(initial=0.0), op=MPI.MAX)


def quarter_ring(cells, cell):
    """1 ≤ r ≤ 2, bent from a unit square; side x0 is the inside."""
    body = box_body((cells, 2 * cells), (1, 1), cell)
    x = body.mesh.geometry.x
    radius, angle = 1 + x[:, 0], np.pi / 2 * x[:, 1]
    x[:, 0], x[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    return body


def thick_cylinder(element, cells):
    """Pressure 1 inside, plane strain. Relative errors of u_r and of the mean stress.

    Lamé: u_r = (1 + ν)/E · c · ((1 − 2ν) r + b²/r), mean stress 2 (1 + ν) c / 3, c = a²/(b² − a²).
    """
    cell, degree = ELEMENTS[element]
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU),
        discretisation=Discretisation(degree),
        support=(Support("y0", {"y": 0}), Support("y1", {"x": 0})),
        load=(Load("x0", pressure=1),),
    )
    prepared = Run(scene, COMM, quarter_ring(cells, cell))
    assert prepared.solve().passed
    points = prepared.problem.spaces.coordinates
    r = np.hypot(points[:, 0], points[:, 1])
    found = np.einsum("ij,ij->i", prepared.solution.displacement, points[:, :2]) / r
    exact = (1 + NU) / E / 3 * ((1 - 2 * NU) * r + 4 / r)
    stress = NodalStress(prepared.problem).at_nodes()
    mean = np.trace(stress, axis1=1, axis2=2) / 3
    expected = 2 * (1 + NU) / 9
    return worst(found - exact) / worst(exact), worst(mean - expected)


@pytest.mark.parametrize(
    ("element", "displacement", "mean_stress"),
    [("P1", 5e-3, 0.1), ("Q1", 1e-3, 1e-3), ("P2", 1e-3, 1e-3), ("Q2", 1e-3, 1e-4)],
)
def test_thick_cylinder(element, displacement, mean_stress):
    """16 cells across; the mean stress to this share of the pressure, at every node."""
    coarse, fine = thick_cylinder(element, 8), thick_cylinder(element, 16)
    assert fine[0] < displacement
    assert fine[1] < mean_stress
    assert np.log2(coarse[0] / fine[0]) > 1.7
    assert fine[1] < 0.7 * coarse[1]


@pytest.mark.parametrize("element", ["P1", "Q1"])
def test_without_the_second_unknown_it_locks(element, monkeypatch):
    monkeypatch.setattr(elastic_body, "NEARLY_INCOMPRESSIBLE", 0.5)
    assert thick_cylinder(element, 16)[0] > 0.3


def driven_block(element, cells):
    """A block 2 × 1 pressed on a rough floor by 10 and driven sideways by its top."""
    cell, degree = ELEMENTS[element]
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, NU),
        discretisation=Discretisation(degree),
        support=(Support("y1", {"x": 0.012, "y": 0}),),
        contact=(Contact("y0", pressure=10, friction_coefficient=0.5),),
    )
    prepared = Run(scene, COMM, box_body((2 * cells, cells), (2, 1), cell))
    result = prepared.solve()
    assert result.passed
    stress = NodalStress(prepared.problem).at_nodes()
    contact = prepared.problem.contacts[0]
    inner = np.abs(prepared.problem.spaces.coordinates[contact.nodes, 0] - 1) < 0.7
    return result.quantities, worst(stress[contact.nodes[inner], 1, 1] + 10)


def test_driven_block():
    """All elements agree on friction force and slip, and carry σ_yy = −10 to the floor.

    The pressure is known there; away from the singular corners it must be found.
    """
    found = {element: driven_block(element, 24) for element in ELEMENTS}
    reference, _ = driven_block("Q2", 48)
    for element, (quantities, pressure_error) in found.items():
        force, slip = quantities["friction_force"][0], quantities["max_slip"]
        assert force == pytest.approx(reference["friction_force"][0], rel=0.01), element
        assert slip == pytest.approx(reference["max_slip"], rel=0.04), element
        assert pressure_error < {"P1": 1.0, "Q1": 0.3, "P2": 0.3, "Q2": 0.1}[element], element


@pytest.mark.parametrize("element", ELEMENTS)
def test_rubber_beside_steel(element):
    """Confined layers, ν = .495 | ν = 0: piecewise linear, the mean stress jumps.

    Exact where it may jump; of first order on P1, where it is continuous.
    """
    cell, degree = ELEMENTS[element]
    soft = E * (1 - 0.495) / ((1 + 0.495) * (1 - 2 * 0.495))
    errors = []
    for cells in (4, 8):
        scene = Scene(
            kinematics="plane strain",
            material=(Material(E, 0.495, on="left"), Material(100, 0, on="right")),
            discretisation=Discretisation(degree),
            support=(Support("body", {"y": 0}), Support("x0", {"x": 0})),
            load=(Load("x1", traction=(-0.1, 0)),),
        )
        prepared = Run(scene, COMM, bimaterial(cells=(2 * cells, cells), cell=cell))
        assert prepared.solve().passed
        x = prepared.problem.spaces.coordinates[:, 0]
        exact = -0.1 * (np.minimum(x, 1) / soft + np.maximum(x - 1, 0) / 100)
        errors.append(worst(prepared.solution.displacement[:, 0] - exact) / worst(exact))
    if element == "P1":
        assert np.log2(errors[0] / errors[1]) > 0.8
        assert errors[1] < 0.06
    else:
        assert errors[1] < 1e-9


@pytest.mark.parametrize("element", ELEMENTS)
def test_with_every_displacement_prescribed(element):
    """Nothing to solve but the mean stress: energy of a uniform strain, E-ν formula."""
    cell, degree = ELEMENTS[element]
    strain = 1e-3
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU),
        discretisation=Discretisation(degree),
        support=(Support("body", {"x": lambda x: strain * x[0], "y": 0}),),
    )
    result = Run(scene, COMM, box_body((2, 2), (1, 1), cell)).solve()
    modulus = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    assert result.quantities["strain_energy"] == pytest.approx(0.5 * modulus * strain**2, rel=1e-6)


def test_choice_is_made_by_itself_and_said():
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, 0.48),
        support=(Support("y0", {"x": 0, "y": 0}),),
    )
    body = box_body((2, 2), (1, 1))
    assert Run(scene, COMM, body).model["terms"] == ["elastic energy"]
    for kinematics, expected in (("plane strain", True), ("plane stress", False)):
        nearly = dataclasses.replace(scene, kinematics=kinematics, material=Material(E, 0.49))
        term = Run(nearly, COMM, body).model["terms"][0]
        assert ("mean stress as a second unknown" in term) == expected
