"""One-sided contact against an exact solver of the inequality, Hertz, and its own limits."""

import dataclasses

import numpy as np
import pytest
from dolfinx import mesh
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from petsc4py import PETSc

from fenics_contact import (
    Contact,
    Discretisation,
    HalfSpace,
    Material,
    MeshSource,
    Obstacle,
    Run,
    Scene,
    Support,
    run,
)
from tests.scenes import ROOT, box_body

COMM = MPI.COMM_WORLD
E, NU = 1000.0, 0.3
HERTZ_FORCE = 4 / 3 * E / (1 - NU**2) * np.sqrt(8)  # K. L. Johnson, Contact Mechanics, (4.23)
HERTZ_RADIUS = np.sqrt(8)


def ball(size=0.25, degree=2, cell="quadrilateral", **contact):
    """A paraboloid of radius 8 pressed 1 deep into a half-space."""
    obstacle = contact.pop("obstacle", Obstacle("paraboloid", radius=8, indentation=1))
    return Scene(
        kinematics="axisymmetric",
        mesh=MeshSource(
            str(ROOT / "meshes" / "half_space.geo"),
            cell=cell,
            parameters={"fine": 4, "size": size, "extent": 60, "cells_outside": 16},
        ),
        material=Material(E, NU),
        discretisation=Discretisation(degree),
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=obstacle, **contact),),
    )


def block(degree, cell, kinematics="plane strain", penalty="auto"):
    """A block on its base, and a parabola pressed into its top."""
    scene = Scene(
        kinematics=kinematics,
        material=Material(E, NU),
        discretisation=Discretisation(degree),
        support=(
            Support("y0" if kinematics != "3D" else "z0", {"x": 0, "y": 0, "z": 0})
            if kinematics == "3D"
            else Support("y0", {"x": 0, "y": 0}),
        ),
        contact=(
            Contact(
                "z1" if kinematics == "3D" else "y1",
                obstacle=Obstacle(
                    "paraboloid" if kinematics == "3D" else "parabola",
                    radius=2,
                    position=(0.45, 0.5, 1) if kinematics == "3D" else (0.45, 1),
                    indentation=0.03,
                ),
                penalty_parameter=penalty,
            ),
        ),
    )
    cells = (6, 6, 4) if kinematics == "3D" else (16, 12)
    return Run(scene, MPI.COMM_SELF, box_body(cells, (1, 1, 1), cell=cell, comm=MPI.COMM_SELF))


def exact(prepared):
    """Minimise ½ uᵀ K u subject to u_n ≤ s by PETSc's `vinewtonrsls`: no penalty at all."""
    problem, contact = prepared.problem, prepared.problem.contacts[0]
    components = problem.spaces.components
    stiffness = fem_petsc.assemble_matrix(problem.elastic.stiffness)
    stiffness.assemble()
    stiffness.zeroRowsColumns(problem.constrained.astype(PETSc.IntType), diag=1.0)
    upper, residual = stiffness.createVecs()
    lower = upper.duplicate()
    lower.set(PETSc.NINFINITY)
    upper.set(PETSc.INFINITY)
    axis = components - 1
    with upper as bound:
        kinematics = contact.kinematics
        bound[contact.nodes * components + axis] = kinematics.gap - kinematics.indentation
    state = upper.duplicate()
    state.set(0.0)
    snes = PETSc.SNES().create(MPI.COMM_SELF)
    snes.setType("vinewtonrsls")
    snes.setFunction(lambda snes, x, f: stiffness.mult(x, f), residual)
    snes.setVariableBounds(lower, upper)
    snes.setJacobian(lambda snes, x, J, P: None, stiffness)
    snes.setTolerances(rtol=1e-12, atol=1e-10, max_it=50)
    ksp = snes.getKSP()
    ksp.setType("preonly")
    ksp.getPC().setType("lu")
    snes.solve(None, state)
    assert snes.getConvergedReason() > 0
    stiffness.mult(state, residual)
    forces = -residual.array_r.reshape(-1, components)[contact.nodes, axis].copy()
    displacement = state.array_r.reshape(-1, components).copy()
    snes.destroy()
    return displacement, forces


@pytest.mark.serial
@pytest.mark.parametrize(
    ("kinematics", "degree", "cell"),
    [
        ("plane strain", 1, "triangle"),
        ("plane strain", 2, "quadrilateral"),
        ("3D", 1, "tetrahedron"),
        ("3D", 2, "hexahedron"),
    ],
)
def test_penalty_tends_to_the_exact_inequality(kinematics, degree, cell):
    prepared = block(degree, getattr(mesh.CellType, cell), kinematics)
    result = prepared.solve()
    assert result.passed
    displacement, forces = exact(prepared)
    contact = prepared.problem.contacts[0]
    pressure = forces / contact.trace.weights
    peak = pressure.max()
    state = prepared.solution.states[0]
    assert np.abs(state.contact_pressure - pressure).max() < 1e-3 * peak
    assert np.abs(prepared.solution.displacement - displacement).max() < 1e-3 * 0.03
    assert (state.status != "OPEN").tolist() == (pressure > 1e-6 * peak).tolist()
    # A penalty a hundred times stiffer halves nothing: it is a hundred times nearer.
    stiffer = block(
        degree, getattr(mesh.CellType, cell), kinematics, contact.penalty_parameter / 100
    )
    stiffer.solve()
    nearer = np.abs(stiffer.solution.states[0].contact_pressure - pressure).max()
    assert nearer < 0.05 * np.abs(state.contact_pressure - pressure).max() + 1e-8 * peak


@pytest.mark.parametrize(("degree", "cell"), [(1, "triangle"), (2, "quadrilateral")])
def test_automatic_penalty_is_stiff_enough(degree, cell):
    """A tenfold reduction changes force and peak pressure by less than .1 %."""
    found = run(ball(degree=degree, cell=cell))
    parameter = found.contacts[0]["parameters"]["penalty_parameter"]
    tenth = run(ball(degree=degree, cell=cell, penalty_parameter=parameter / 10))
    for key in ("normal_force", "max_contact_pressure"):
        assert found.quantities[key] == pytest.approx(tenth.quantities[key], rel=1e-3)
    softer = run(ball(degree=degree, cell=cell, penalty_parameter=parameter * 1e4))
    assert not softer.passed  # and the check of penetration can fail


def test_hertz_converges_with_the_mesh():
    """Force and radius of contact against the formula, the radius within the elements."""
    errors = []
    for size in (1.0, 0.5, 0.25):
        result = run(ball(size))
        assert result.passed
        quantities = result.quantities
        radius = np.sqrt(quantities["contact_area"] / np.pi)
        errors.append(
            (
                abs(quantities["normal_force"] / HERTZ_FORCE - 1),
                abs(radius / HERTZ_RADIUS - 1) * HERTZ_RADIUS / size,
            )
        )
    force, radius = np.array(errors).T
    assert force[-1] < 2e-3 and force[-1] < force[0] / 3
    assert radius.max() < 0.2  # of a cell: nodes are half a cell apart


def test_contact_force_is_the_support_reaction():
    scene = dataclasses.replace(
        ball(), half_space=None, support=(Support("outer", {"x": 0, "y": 0}),)
    )
    result = run(scene)
    force, reaction = result.quantities["normal_force"], result.quantities["reaction"][1]
    assert force == pytest.approx(reaction, rel=1e-9)


def test_nodes_on_the_axis_are_left_out_where_they_stand_for_no_area():
    quadratic = run(ball(size=0.5)).points
    assert quadratic.coordinates[:, 0].min() == pytest.approx(0.25)
    assert quadratic.weights.sum() == pytest.approx(np.pi * 4**2, rel=1e-9)
    linear = run(ball(size=0.5, degree=1)).points
    assert linear.coordinates[:, 0].min() == pytest.approx(0, abs=1e-12)
    assert linear.weights.sum() == pytest.approx(np.pi * 4**2, rel=1e-9)
    peak = 2 / np.pi * E / (1 - NU**2) / np.sqrt(8)  # Johnson, (4.24)
    assert linear.contact_pressure[0] == pytest.approx(peak, rel=0.05)


@pytest.mark.parametrize("poissons_ratio", [0.49, 0.4999])
def test_nearly_incompressible_hertz(poissons_ratio):
    scene = dataclasses.replace(ball(), material=Material(E, poissons_ratio))
    result = run(scene)
    modulus = E / (1 - poissons_ratio**2)
    assert result.passed
    assert result.quantities["normal_force"] == pytest.approx(
        4 / 3 * modulus * np.sqrt(8), rel=5e-3
    )
    peak = 2 / np.pi * modulus / np.sqrt(8)
    assert result.quantities["max_contact_pressure"] == pytest.approx(peak, rel=1e-2)


def test_quarter_by_symmetry_is_a_quarter_of_the_whole():
    """Two planes of symmetry against the whole block, cell for cell."""

    def pressed(cells, size, symmetry, centre):
        obstacle = Obstacle("paraboloid", radius=2, position=(*centre, 1), indentation=0.05)
        scene = Scene(
            kinematics="3D",
            material=Material(E, NU),
            support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
            symmetry=symmetry,
            contact=(Contact("z1", obstacle=obstacle),),
        )
        return run(scene, COMM, box_body(cells, size))

    quarter = pressed((3, 3, 2), (1, 1, 1), ("x0", "y0"), (0, 0))
    whole = pressed((6, 6, 2), (2, 2, 1), (), (1, 1))
    assert quarter.model["symmetry"] == "quarter (x = 0, y = 0)"
    for key in ("normal_force", "contact_area", "strain_energy"):
        assert whole.quantities[key] == pytest.approx(4 * quarter.quantities[key], rel=1e-8)
