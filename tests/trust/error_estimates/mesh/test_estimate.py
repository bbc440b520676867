"""How the parts of the error by the mesh are put together, and what no point of it shows."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Load, Material, Obstacle, Scene, run
from fenics_contact.trust.error_estimates.mesh import estimate
from tests.scenes import box_body, with_solver

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
OF_SLIP = ("slip_area", "stick_area", "max_slip", "friction_work")


def pressed(cells, coefficient, errors, poisson=0.3):
    """Right half of a block 4 × 1 that even pressure holds on a rough floor; it widens by ν."""
    scene = Scene(
        kinematics="plane strain",
        material=(Material(1000, poisson),),
        discretisation=Discretisation(1),
        symmetry=("x0",),
        load=(Load("y1", traction=(0, -10)),),
        contact=(Contact("y0", obstacle=Obstacle(), friction_coefficient=coefficient),),
    )
    return run(with_solver(scene, errors=errors), COMM, box_body((2 * cells, cells), (2.0, 1.0)))


def test_slip_that_falls_between_the_points_is_within_the_bars():
    """Two cells stick as a whole, where the corner slips on .6 % of the floor."""
    coarse, fine = pressed(1, 0.4, "auto"), pressed(24, 0.4, "none").quantities
    assert coarse.quantities["slip_area"] == 0
    assert 0 < fine["slip_area"] < 0.05
    for name in OF_SLIP:
        change = abs(fine[name] - coarse.quantities[name])
        assert coarse.errors[name]["total"] > change > 1e-9, name
        assert coarse.contacts[0].errors[name]["total"] == pytest.approx(
            coarse.errors[name]["total"]
        )


def test_nothing_may_slip_where_friction_carries_nothing():
    found = pressed(1, 0.4, "auto", poisson=0.0)
    for name in OF_SLIP:
        assert found.errors[name]["total"] < 1e-6, name


def test_the_place_of_an_edge_is_of_second_order_in_small_pieces():
    """Fields of a smooth edge are right but for the distance from it over the size of the zone."""
    places = [estimate._place_of_edge(cut, 1.0) for cut in (0.02, 0.01, 0.005)]
    assert np.diff(np.log2(places)) == pytest.approx([-2.0, -2.0])
    for cut in (0.3, 1.0, 10.0):
        assert estimate._place_of_edge(cut, 1.0) == pytest.approx(0.15 * cut)
    assert estimate._place_of_edge(0.3, 0.0) == pytest.approx(0.15 * 0.3)


def test_energy_of_errors_goes_to_friction_work_in_the_root_of_its_share():
    answer = {"strain_energy": 4.0, "friction_work": 1.0, (0, "friction_work"): 8.0}
    found = estimate._energies(answer, 0.1)
    assert found["strain_energy"] == 0.1 and found["external_work"] == 0.2
    assert found["friction_work"] == pytest.approx(0.05)
    assert found[0, "friction_work"] == pytest.approx(0.1)  # no more than all


@pytest.mark.parametrize(("share", "longer"), [(2.0, np.sqrt(2.0)), (1e3, 3.0)])
def test_bars_are_longer_where_an_edge_passes_through_large_pieces(share, longer, monkeypatch):
    def mesh_part(share):
        monkeypatch.setattr(estimate, "piece_share", lambda *of: share)
        return pressed(4, 0.2, "auto").errors["friction_force"]["mesh"]

    assert mesh_part(share) == pytest.approx(longer * mesh_part(0.0), rel=1e-6)


def test_energies_are_stationary_in_the_place_of_a_small_edge():
    """All but one node slips: the energy's bar was 31 times the distance from a fine mesh."""
    coarse, fine = pressed(2, 0.05, "auto"), pressed(16, 0.05, "none")
    error = abs(coarse.quantities["strain_energy"] - fine.quantities["strain_energy"])
    assert error < coarse.errors["strain_energy"]["total"] < 15 * error
    found = coarse.quantities["friction_force"][0] - fine.quantities["friction_force"][0]
    assert abs(found) < coarse.errors["friction_force"]["total"]
