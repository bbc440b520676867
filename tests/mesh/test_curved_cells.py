"""Displacements of degree 1 on cells of order 2: exact where straight, refused where curved."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Body,
    Contact,
    Discretisation,
    InputError,
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
    with pytest.raises(InputError) as caught:
        run(TWISTED, COMM)
    said = str(caught.value)
    assert said.startswith(f"discretisation.degree = 1: cells of {HALF_DISC} are curved")
    assert said.endswith(
        "write discretisation.degree = 2, or make cells of order 1 (mesh.order = 1)"
    )


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
    with pytest.raises(InputError, match="are curved"):
        body.require_straight()
    scene = slab(degree=1, order=2)
    with pytest.raises(InputError, match="are curved"):
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
