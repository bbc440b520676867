"""Contacts with fewer than three points across what touches are told; others are resolved."""

import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    Discretisation,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Scene,
    Support,
    run,
)
from fenics_contact.analytic.contact import line_contact, plane_strain_modulus
from tests.scenes import box_body
from tests.trust.convergence.blocks import GEOMETRY, pressed

COMM = MPI.COMM_WORLD
MODULUS = plane_strain_modulus(1000, 0.3)
NOT_RESOLVED = "not resolved: fewer than three points lie across what touches"


def found_on(cells, obstacle):
    """What a unit block of so many cells gives."""
    return run(pressed(obstacle, len(cells)), COMM, box_body(cells, (1,) * len(cells)))


def line(indentation):
    """A parabola over the node in the middle."""
    return Obstacle("parabola", radius=2, position=(0.5, 1), indentation=indentation)


@pytest.mark.errors
def test_one_row_of_points_is_said_in_the_first_sentence_and_has_no_bars():
    """Its pressure is the force over a cell, a fraction of Hertz's peak for the same force."""
    found = found_on((10, 10), line(0.0006))
    first = f"Converged, but the contact at 'y1' near (0.5, 1) is {NOT_RESOLVED}"
    assert found.verdict.startswith(first)
    assert "All " in found.verdict and found.exit_code == 0
    peak = line_contact(MODULUS, 2, found.quantities["normal_force"]).peak
    assert found.quantities["max_contact_pressure"] < 0.8 * peak
    for name in ("max_contact_pressure", "contact_area", "max_penetration"):
        assert found.errors[name]["total"] is None
    assert any("fewer than three points" in note for note in found.error_notes)


@pytest.mark.parametrize("indentation", [0.02, 0.06])
def test_three_rows_and_more_are_resolved(indentation):
    assert NOT_RESOLVED not in found_on((10, 10), line(indentation)).verdict


def test_a_row_along_a_face_is_no_more_than_a_row():
    """A cylinder across a face in space: many points, but in one row."""
    cylinder = Obstacle(
        "cylinder", radius=2, position=(0.5, 0.5, 1), along=(0, 1, 0), indentation=0.004
    )
    assert NOT_RESOLVED in found_on((4, 4, 4), cylinder).verdict


@pytest.mark.parametrize("cells", [(2, 2), (2, 2, 2), (3, 3)])
def test_a_contact_up_to_all_borders_has_no_edge_to_be_resolved(cells):
    dimension = len(cells)
    normal = (*(0,) * (dimension - 1), -1)
    place = (*(0,) * (dimension - 1), 1)
    plane = Obstacle("plane", position=place, normal=normal, indentation=0.01)
    assert NOT_RESOLVED not in found_on(cells, plane).verdict


def test_few_points_beside_many_are_passed_over():
    """A block that is pressed flat, and lifts at one end: what touches is nearly all of it."""
    floor = Obstacle("plane", position=(0, 0), normal=(0, 1), indentation=0.0)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        support=(Support("x0", {"x": 0}),),
        load=(Load("y1", traction=(0, -1)),),
        contact=(Contact("y0", obstacle=floor),),
    )
    assert NOT_RESOLVED not in run(scene, COMM, box_body((10, 3), (1, 0.3))).verdict


@pytest.mark.errors
def test_an_accuracy_refines_what_is_not_resolved(tmp_path):
    """Hertz's peak for the force that is given."""
    (tmp_path / "b.geo").write_text(GEOMETRY)
    driven = Obstacle("parabola", radius=2, position=(0.5, 1), force=0.2)
    mesh, accuracy = MeshSource(str(tmp_path / "b.geo")), Accuracy(max_contact_pressure=0.05)
    found = run(pressed(driven, mesh=mesh, accuracy=accuracy))
    peak = line_contact(MODULUS, 2, 0.2).peak
    assert found.exit_code == 0 and NOT_RESOLVED not in found.verdict
    assert found.quantities["max_contact_pressure"] == pytest.approx(peak, rel=0.05)
