"""Cells of order 2: degree 1 is exact where straight, refused where curved; coarse ones sound."""

import dataclasses

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Body,
    Contact,
    Discretisation,
    Load,
    Material,
    MeshSource,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.spaces import Spaces
from fenics_contact.mesh.loading import load_body
from tests import cad
from tests.messages import refused
from tests.scenes import ROOT, slab

COMM = MPI.COMM_WORLD
HALF_DISC = str(ROOT / "meshes" / "half_disc.geo")
# Half a disc of radius 8, held at its straight side and pushed along it: it bears a moment.
TWISTED = Scene(
    kinematics="plane strain",
    mesh=MeshSource(HALF_DISC, order=2, parameters={"fine": 3, "size": 2}),
    material=Material(1000, 0.3),
    discretisation=Discretisation(1),
    support=(Support("face", {"x": 0, "y": 0}),),
    load=(Load("body", body_force=(1, 0)),),
    contact=(Contact("contact", pressure=1.0, friction_coefficient=0.1),),
    solver=SolverSettings(errors="none"),
)


def test_degree_1_is_refused_where_cells_are_curved():
    with refused("half_disc_of_degree_1"):
        run(TWISTED, COMM)


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_a_moment_that_is_lost_in_curved_cells_fails_the_check(monkeypatch, solver):
    """If such a model were solved: the check of equilibrium sees all forces, as they are."""
    monkeypatch.setattr(Body, "require_straight", lambda self: None)
    settings = dataclasses.replace(TWISTED.solver, solver=solver)
    result = run(dataclasses.replace(TWISTED, solver=settings), COMM)
    assert not result.checks["equilibrium"].passed
    assert result.checks["equilibrium"].value > 1e-4


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_straight_cells_of_order_2_are_those_of_order_1(cell):
    """Middle nodes at the middle: the same answer to round-off, with all moments in balance."""
    found = [run(slab(degree=1, order=order, cell=cell, cells=(4, 2)), COMM) for order in (1, 2)]
    one, two = ({"max_slip": 0.0} | dict(result.quantities) for result in found)
    assert found[1].checks["equilibrium"].passed
    for key in ("reaction", "strain_energy", "external_work"):
        assert two[key] == pytest.approx(one[key], rel=1e-9)


def test_middle_nodes_that_lie_aside_are_curved_sides():
    """By a millionth of a cell: enough for a moment that the check of equilibrium would miss."""
    body = load_body(slab(order=2, cells=(4, 1)).mesh, 2, COMM)
    body.require_straight()
    x = body.mesh.geometry.x
    x[np.isclose(x[:, 1], 0.5 * x[:, 1].max()), 0] += 1e-6
    with refused("curved_cells_of_degree_1"):
        body.require_straight()
    scene = slab(degree=1, order=2)
    with refused("curved_cells_of_degree_1"):
        Spaces(BodyDescription.of(scene), body)


@pytest.mark.errors
def test_meshes_for_an_accuracy_keep_straight_cells_at_degree_1():
    """A geometry that is curved is meshed again by cells that displacements of degree 1 suit."""
    finer = dataclasses.replace(
        TWISTED,
        mesh=MeshSource(HALF_DISC, parameters={"fine": 3, "size": 2}),
        accuracy=Accuracy(strain_energy=0.005, max_levels=2),
        solver=SolverSettings(),
    )
    result = run(finer, COMM)
    assert len(result.levels) > 1
    assert result.checks["equilibrium"].passed


@pytest.mark.serial
@pytest.mark.parametrize(("curvature", "wall"), [(4, 0.4), (6, 2.0)])
def test_coarse_cells_between_a_hole_and_a_side_are_not_inverted(tmp_path, curvature, wall):
    """Curved sides of straight cells would go through them; nodes of the hole stay on it."""
    wide, high, radius = 40.0, 8.0, 4.0

    def build(occ):
        plate = occ.addBox(0, 0, 0, wide, wide, high)
        hole = occ.addCylinder(radius + wall, wide / 2, 0, 0, 0, high, radius)
        occ.cut([(3, plate)], [(3, hole)])

    file = cad.write_shapes(tmp_path / "plate.step", build)
    body = load_body(MeshSource(file, order=2, curvature=curvature), 3, COMM)
    volume = fem.assemble_scalar(fem.form(fem.Constant(body.mesh, 1.0) * ufl.dx))
    exact = high * (wide**2 - np.pi * radius**2)
    assert COMM.allreduce(volume) == pytest.approx(exact, rel=2e-4)
