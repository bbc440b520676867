"""Thin parts whose mesh is too stiff in bending, against the theory of beams."""

import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Point, Scene, Support, run
from fenics_contact.trust.error_estimates.measured import HeldBack
from tests.scenes import box_body, with_solver

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
MODULUS, LENGTH, PRESSURE = 1000.0, 10.0, 1e-3
# S. P. Timoshenko, Strength of Materials: q L⁴ / 8 EI, and by shear q L² / 2 k G A with k = 5/6.
TIP = PRESSURE * LENGTH**2 * (LENGTH**2 / 8 * 12 + 0.5 * 2 * 6 / 5) / MODULUS


def leaf(cells, degree, kind=CellType.quadrilateral):
    """A cantilever of height 1, ν = 0, under a pressure on its top."""
    scene = Scene(
        kinematics="plane strain",
        material=(Material(MODULUS, 0.0),),
        discretisation=Discretisation(degree),
        support=(Support("x0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", pressure=PRESSURE),),
        point=(Point("tip", (LENGTH, 0.5)),),
    )
    body = box_body(cells, (LENGTH, 1.0), kind)
    return run(with_solver(scene, errors="all"), COMM, body)


def off(found):
    return abs(found.quantities["displacement_tip"][1] + TIP)


@pytest.mark.parametrize("kind", [CellType.quadrilateral, CellType.triangle])
def test_a_mesh_that_is_stiffer_than_the_body_has_no_bars(kind):
    """It gives way by a quarter of what it should: no estimate by small errors tells of that."""
    found = leaf((4, 1), 1, kind)
    assert off(found) > 0.7 * TIP
    assert found.errors["displacement_tip"]["mesh"] is None
    assert found.errors["displacement_tip"]["total"] is None
    # Statics decide it.
    assert found.errors["reaction"]["total"] < 1e-6 * PRESSURE * LENGTH
    assert ["more of the stiffness" in note for note in found.error_notes] == [True]


def test_a_mesh_that_hides_all_is_not_one_that_makes_no_errors(monkeypatch):
    monkeypatch.setattr(HeldBack, "hides", lambda held, change, value: True)
    found = leaf((4, 1), 1)
    assert {errors["total"] for errors in found.errors.values()} == {None}
    assert ["more of the stiffness" in note for note in found.error_notes] == [True]


@pytest.mark.parametrize("kind", [CellType.quadrilateral, CellType.triangle])
def test_degree_2_has_bars_that_hold(kind):
    found = leaf((8, 1), 2, kind)
    assert off(found) < 0.02 * TIP
    assert off(found) < found.errors["displacement_tip"]["total"] < 0.2 * TIP
    assert found.error_notes == []


def test_all_steps_to_the_answer_count_where_the_mesh_makes_much_of_the_stiffness(monkeypatch):
    """Of what the mesh adds, s, the displacement lacks s / (1 - s): the first step alone is s."""
    found = leaf((8, 2), 1)
    assert off(found) < found.errors["displacement_tip"]["total"] < 4 * off(found)
    shares = []

    def first_step(held):
        shares.append(held.share)
        return 1.0

    monkeypatch.setattr(HeldBack, "all_steps", property(first_step))
    first = leaf((8, 2), 1)
    share = shares[0]
    lacks = share / (1 - share) * abs(found.quantities["displacement_tip"][1])
    assert off(found) == pytest.approx(lacks, rel=0.2)
    ratio = found.errors["displacement_tip"]["mesh"] / first.errors["displacement_tip"]["mesh"]
    assert ratio == pytest.approx(1 / (1 - share), rel=0.05)


def test_what_a_support_bends_is_not_held_back(monkeypatch):
    """Its shape is given: forces are too large, by what local errors tell at once."""
    scene = Scene(
        kinematics="plane strain",
        material=(Material(MODULUS, 0.0),),
        discretisation=Discretisation(1),
        support=(Support("x0", {"x": 0, "y": 0}), Support("x1", {"y": -0.1})),
        contact=(Contact("y1", pressure=0.0),),
    )
    found = run(with_solver(scene, errors="all"), COMM, box_body((4, 1), (LENGTH, 1.0)))
    # Beam: 3 EI w / L³, less what shear gives way by, 6/5 F L / GA.
    force = 0.1 / (LENGTH**3 / 3 * 12 + 1.2 * 2 * LENGTH) * MODULUS
    (tip,) = (support for support in found.supports if support.on == "x1")
    wrong = abs(abs(tip.reaction[1]) - force)
    assert wrong > 2 * force
    assert wrong < tip.errors["reaction"]["total"] < 4 * wrong
