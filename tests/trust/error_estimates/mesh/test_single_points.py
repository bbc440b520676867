"""Contacts that touch in a single point of the mesh, against Hertz's formulas."""

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Obstacle, Point, Scene, Support, run
from fenics_contact.analytic import contact as formulas
from fenics_contact.trust.error_estimates.measured import HeldBack
from fenics_contact.trust.error_estimates.mesh import estimate
from tests.scenes import box_body, with_solver

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
MODULUS, RADIUS = formulas.plane_strain_modulus(1000, 0.3), 0.5


def pressed(degree, height=1, **driven):
    """A block, twice as wide as high, under a paraboloid over its middle, of cells of 1/4.

    They are much larger than contact is.
    """
    obstacle = Obstacle("paraboloid", radius=RADIUS, position=(height,) * 3, **driven)
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("z1", obstacle=obstacle),),
        point=(Point("below", (height, height, height - 0.25)),),
    )
    count = int(4 * height) // degree
    size = (2 * height, 2 * height, height)
    body = box_body((2 * count, 2 * count, count), size, CellType.hexahedron)
    return run(with_solver(scene, errors="auto"), COMM, body)


def without_single_points(monkeypatch):
    def none(load_steps, again):
        return dict.fromkeys(again.answer, 0.0)

    monkeypatch.setattr(estimate, "single_point_errors", none)


@pytest.mark.parametrize("degree", [1, 2])
def test_forces_by_an_indentation(degree, monkeypatch):
    """Their bars hold; of degree 2 they did not by what else is estimated."""
    exact = formulas.paraboloid(MODULUS, RADIUS, 0.002)
    found = pressed(degree, indentation=0.002)
    error = abs(found.quantities["normal_force"] - exact.force)
    assert error > exact.force  # of the mesh's share of the surface
    assert error < found.errors["normal_force"]["total"] < 3 * error
    assert np.linalg.norm(found.quantities["reaction"]) < 2 * found.errors["reaction"]["total"]
    without_single_points(monkeypatch)
    if degree == 2:
        assert pressed(degree, indentation=0.002).errors["normal_force"]["total"] < 0.6 * error


def test_a_force_that_is_given_stays_known(monkeypatch):
    """How far the obstacle goes in is less known: by F / E* √A, A the area of a facet."""
    exact = formulas.paraboloid(MODULUS, RADIUS, 0.002)
    # One cell of degree 1 below a point is too stiff for a bar of the indentation.
    assert pressed(1, 0.5, force=exact.force).errors["indentation"]["total"] is None
    monkeypatch.setattr(HeldBack, "is_too_stiff", False)
    found = pressed(1, 0.5, force=exact.force)
    assert found.errors["normal_force"]["total"] < 1e-6 * exact.force
    without_single_points(monkeypatch)
    other = pressed(1, 0.5, force=exact.force)
    more = found.errors["indentation"]["mesh"] - other.errors["indentation"]["mesh"]
    assert more == pytest.approx(exact.force / MODULUS / 0.25, rel=0.01)


def test_pieces_that_touch_as_a_whole_add_nothing(monkeypatch):
    before = pressed(1, indentation=0.15).errors["normal_force"]["mesh"]
    without_single_points(monkeypatch)
    assert pressed(1, indentation=0.15).errors["normal_force"]["mesh"] == before
