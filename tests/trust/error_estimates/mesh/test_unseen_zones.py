"""Gaps and slip at ends of surfaces that no point of a coarse mesh shows."""

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Scene, Support, run
from tests.scenes import box_body, with_solver

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD


def slid(cells, errors, along=0.01):
    """A block 2 × 1 that is held above, pressed by .002 on a floor and moved along it."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": along, "y": -0.002}),),
        contact=(Contact("y0", obstacle=Obstacle(), friction_coefficient=0.3),),
    )
    return run(with_solver(scene, errors=errors), COMM, box_body((2 * cells, cells), (2, 1)))


def test_a_corner_that_lifts_on_finer_meshes_alone_is_in_the_bar_of_the_area():
    """All touches on three cells; on twelve .026 of it does not. The bar was 1e-14."""
    coarse, fine = slid(3, "auto"), slid(12, "none")
    for name in ("contact_area", "slip_area"):
        error = abs(coarse.quantities[name] - fine.quantities[name])
        assert 0.01 < error < coarse.errors[name]["total"] < 6 * error, name


def test_ends_that_carry_as_much_as_all_else_hide_none():
    result = slid(3, "auto", along=0.0)
    assert result.errors["contact_area"]["total"] < 1e-12


def in_a_corner(cells, errors):
    """A block 1.5 × .6, hardly compressible, that loads press into a corner of rough walls."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.499),
        load=(Load("x1", pressure=4.3), Load("y1", pressure=7.9)),
        contact=(
            Contact("x0", obstacle=Obstacle(), friction_coefficient=0.45),
            Contact("y0", obstacle=Obstacle(), friction_coefficient=0.7),
        ),
    )
    body = box_body((5 * cells // 2, cells), (1.5, 0.6))
    return run(with_solver(scene, errors=errors), COMM, body).contacts[0]


def test_slip_at_an_end_that_finer_meshes_alone_show_is_in_bars_that_go_by_what_it_can_do():
    """All sticks on two cells. The bar of the work was 111 times its error."""
    coarse, fine = in_a_corner(2, "auto"), in_a_corner(16, "none")
    assert coarse["quantities"]["slip_area"] == 0.0
    for name, most in (("slip_area", 4), ("max_slip", 3), ("friction_work", 20)):
        error = fine["quantities"][name] - coarse["quantities"][name]
        assert 0 < error < coarse["errors"][name]["total"] < most * error, name
