"""Punches that end between nodes: forces go by where the last node before them is."""

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Obstacle, Scene, Support, run
from tests.scenes import box_body, with_solver

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD


def punched(cells, errors, kinematics):
    """Half of a layer .5 thick under a punch that ends at .4375, an edge of cells of 1/16."""
    sides = [Support("y0", {"x": 0, "y": 0})]
    if kinematics != "axisymmetric":
        sides.append(Support("x0", {"x": 0}))
    punch = Obstacle("flat punch", radius=0.4375, position=(0.0, 0.5), indentation=0.01)
    scene = Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=tuple(sides),
        contact=(Contact("y1", obstacle=punch, friction_coefficient=0.0),),
    )
    body = box_body((cells, cells // 2), (1.0, 0.5))
    return run(with_solver(scene, errors=errors), COMM, body)


@pytest.mark.parametrize("kinematics", ["plane strain", "axisymmetric"])
def test_the_force_of_a_punch_that_ends_inside_a_piece_is_in_its_bar(kinematics):
    """Its edge is .25 and .75 of a piece beyond the last node: of the first bars were .35, .43."""
    coarser, finer = (punched(n, "none", kinematics).quantities["normal_force"] for n in (32, 64))
    force = 2 * finer - coarser  # both end at a node: of first order in the size of cells
    for cells in (6, 10):
        result = punched(cells, "auto", kinematics)
        error = abs(result.quantities["normal_force"] - force)
        assert error > 0.02 * force
        assert error < result.errors["normal_force"]["total"] < 4 * error
        # That is where the scene says.
        assert result.errors["contact_area"]["total"] < 0.07 * result.quantities["contact_area"]
