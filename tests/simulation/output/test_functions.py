"""Answers as functions of dolfinx, beside formulas and beside what results say."""

import dataclasses

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import (
    Contact,
    HalfSpace,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Path,
    Run,
    Scene,
    Steps,
    Support,
)
from fenics_contact.common import form_cache
from fenics_contact.common.parallel import largest, on_root, smallest, total
from fenics_contact.simulation.output.fields import FIELD_SLIP, FieldSeries
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import ROOT, box_body

COMM = MPI.COMM_WORLD
LENGTH, PRESSURE, PULL, COEFFICIENT = 2.0, 10.0, 3.0, 0.5


def pressed(on="y0", **changes):
    """A block that lies on a rough floor, pressed from above and pulled."""
    loads = (Load("y1", pressure=PRESSURE), Load("x1", traction=(PULL, 0)))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        load=loads,
        contact=(Contact(on, friction_coefficient=COEFFICIENT),),
    )
    return dataclasses.replace(scene, **changes)


def integral(expression, mesh):
    """∫ over a mesh, by hand."""
    found = fem.assemble_scalar(form_cache.form(expression * ufl.dx(domain=mesh)))
    return float(total(COMM, found))


@pytest.fixture(scope="module")
def block():
    prepared = Run(pressed(), COMM, box_body((16, 4), (LENGTH, 1)))
    return prepared, prepared.solve()


def test_a_rank_may_lack_the_contact():
    """A long block of which only the left end stands on the floor, and is pressed."""

    def at_left(x):
        return x[0] < 0.25

    patches = {"foot": ("y0", at_left), "head": ("y1", at_left)}
    body = box_body((64, 2), (LENGTH, 0.1), patches=patches)
    scene = pressed("foot", load=(Load("head", pressure=PRESSURE), Load("x1", traction=(PULL, 0))))
    prepared = Run(scene, COMM, body)
    counts = COMM.allgather(len(prepared.problem.contacts[0].nodes))
    assert COMM.size == 1 or 0 in counts, counts
    result = prepared.solve()
    contact = prepared.fields.contacts["foot"]
    mesh = contact.pressure.function_space.mesh
    force = integral(contact.pressure, mesh)
    assert force == pytest.approx(result.quantities["normal_force"], rel=1e-9)
    assert force == pytest.approx(0.25 * PRESSURE, rel=1e-9)
    assert integral(contact.friction[0], mesh) == pytest.approx(-0.1 * PULL, rel=1e-9)


def test_pressure_and_friction_carry_the_block(block):
    prepared, result = block
    contact = prepared.fields.contacts["y0"]
    mesh = contact.pressure.function_space.mesh
    assert mesh.topology.dim == 1
    assert integral(ufl.as_ufl(1.0), mesh) == pytest.approx(LENGTH)
    assert integral(contact.pressure, mesh) == pytest.approx(PRESSURE * LENGTH, rel=1e-9)
    assert integral(contact.friction[0], mesh) == pytest.approx(-PULL, rel=1e-9)
    assert integral(contact.pressure, mesh) == pytest.approx(
        result.quantities["normal_force"], rel=1e-9
    )
    # The slip lags behind by what is regularised, against friction.
    power = integral(ufl.inner(contact.friction, contact.slip), mesh)
    assert power < 0 < integral(ufl.inner(contact.slip, contact.slip), mesh)


def test_stress_is_that_of_own_elasticity(block):
    """σ of the displacement, written anew, and the energy of it."""
    prepared, result = block
    fields = prepared.fields
    u, mesh = fields.displacement, fields.displacement.function_space.mesh
    strain = ufl.sym(ufl.grad(u))
    shear, lame = 1000 / 2.6, 1000 * 0.3 / (1.3 * 0.4)
    stress = 2 * shear * strain + lame * ufl.tr(strain) * ufl.Identity(2)
    energy = integral(ufl.inner(stress, strain) / 2, mesh)
    assert energy == pytest.approx(result.quantities["strain_energy"], rel=1e-9)
    found = ufl.as_matrix([[fields.stress[i, j] for j in (0, 1)] for i in (0, 1)])
    off = integral(ufl.inner(found - stress, found - stress), mesh)
    assert off < 0.01 * integral(ufl.inner(stress, stress), mesh)
    out_of_plane = fields.stress[2, 2] - 0.3 * (found[0, 0] + found[1, 1])
    assert integral(out_of_plane**2, mesh) < 1e-18 * integral(ufl.inner(found, found), mesh)


def test_uniform_pressure_makes_uniform_stress():
    scene = pressed(load=(Load("y1", pressure=PRESSURE),), support=(Support("x0", {"x": 0}),))
    scene = dataclasses.replace(scene, contact=(Contact("y0"),))
    prepared = Run(scene, COMM, box_body((5, 3), (LENGTH, 1)))
    prepared.solve()
    stress = prepared.fields.stress.x.array.reshape(-1, 3, 3)
    expected = np.zeros((3, 3))
    expected[1, 1], expected[2, 2] = -PRESSURE, -0.3 * PRESSURE
    np.testing.assert_allclose(stress, np.broadcast_to(expected, stress.shape), atol=1e-7)


def test_on_the_axis_stands_hertz_s_peak(folder):
    """p(0) = (2/π) E* √(d/R) (Johnson, Contact Mechanics, (4.24)), at a node without area."""
    scene = Scene(
        kinematics="axisymmetric",
        symmetry=("axis",),
        mesh=MeshSource(
            str(ROOT / "meshes" / "half_space.geo"),
            cell="quadrilateral",
            parameters={"fine": 5, "size": 0.2, "extent": 60, "cells_outside": 16},
        ),
        material=Material(1000, 0.3),
        half_space=HalfSpace(on=("outer",)),
        contact=(Contact("contact", obstacle=Obstacle("paraboloid", radius=8, indentation=1)),),
    )
    prepared = Run(scene)
    prepared.solve()
    contact = prepared.fields.contacts["contact"]
    space, pressure = contact.pressure.function_space, contact.pressure.x.array
    radius = space.tabulate_dof_coordinates()[:, 0]
    exact = 2 / np.pi * 1000 / (1 - 0.3**2) * 8**-0.5
    on_axis = radius < 1e-9
    assert total(COMM, int(on_axis.sum())) >= 1
    found = largest(COMM, pressure[on_axis])
    assert found == pytest.approx(exact, rel=2e-3)
    FieldSeries(prepared.problem, folder).write(prepared.forces, 1.0, 1)
    in_file = on_root(COMM, lambda: field_on_axis(folder))
    assert in_file["contact_pressure"] == pytest.approx(exact, rel=2e-3)
    assert in_file["status"] == FIELD_SLIP  # as all that touches without friction
    # Off the contact, the gap opens.
    assert smallest(COMM, contact.gap.x.array[radius > 4]) > 0.05


def field_on_axis(folder):
    import pyvista

    found = pyvista.read(folder / "fields000001.pvtu")
    on_axis = np.linalg.norm(found.points, axis=1) < 1e-9
    return {name: found[name][on_axis].max() for name in ("contact_pressure", "status")}


def test_between_bodies():
    parts = [Box("lower", (0, 0), (2, 1), (4, 2)), Box("upper", (0.5, 1), (1.5, 2), (3, 3))]
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("lower.y0", {"x": 0, "y": 0}), Support("upper.x0", {"x": 0})),
        load=(Load("upper.y1", pressure=PRESSURE),),
        contact=(Contact("upper.y0", against="lower.y1", name="joint"),),
    )
    prepared = Run(scene, COMM, boxes(parts))
    result = prepared.solve()
    pressure = prepared.fields.contacts["joint"].pressure
    force = integral(pressure, pressure.function_space.mesh)
    assert force == pytest.approx(PRESSURE, rel=1e-6)
    assert force == pytest.approx(result.quantities["normal_force"], rel=1e-6)


def test_every_step_has_its_own():
    path = Path(time=(0, 1), factor=(0, 1))
    loads = (Load("y1", pressure=PRESSURE, path=path), Load("x1", traction=(PULL, 0), path=path))
    scene = pressed(load=loads, steps=Steps(3))
    prepared = Run(scene, COMM, box_body((8, 2), (LENGTH, 1)))
    with refused("fields_before_solve"):
        _ = prepared.fields
    kept = []
    result = prepared.solve(accepted=lambda: kept.append(prepared.fields))
    assert prepared.fields is kept[-1]
    for fields, step in zip(kept, result.steps, strict=True):
        pressure = fields.contacts["y0"].pressure
        force = integral(pressure, pressure.function_space.mesh)
        assert force == pytest.approx(step.load_factor * PRESSURE * LENGTH, rel=1e-9)
        stress = fields.stress
        mean = integral(stress[1, 1], stress.function_space.mesh) / LENGTH
        assert mean == pytest.approx(-step.load_factor * PRESSURE, rel=1e-6)
