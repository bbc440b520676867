"""What units are called."""

import pytest
from mpi4py import MPI

from fenics_contact import Units

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")


@pytest.mark.parametrize(
    ("length", "force", "stress", "energy"),
    [
        ("mm", "N", "MPa", "mJ"),
        ("m", "N", "Pa", "J"),
        ("millimeter", "kilonewton", "GPa", "J"),
        ("µm", "mN", "GPa", "nJ"),
        ("in", "lbf", "psi", "lbf·in"),
        ("ft", "lbf", "lbf/ft²", "lbf·ft"),
    ],
)
def test_stress_and_energy_have_usual_names(length, force, stress, energy):
    found = Units(length, force).names()
    assert (found.stress, found.energy) == (stress, energy)


def test_others_are_made_of_these():
    found = Units("mm", "N").names()
    words = ("area", "stress/length", "length/stress", "force/volume", "energy/area", "")
    assert [found.of(each) for each in words] == [
        *("mm²", "MPa/mm", "mm/MPa", "N/mm³", "mJ/mm²", ""),
    ]
    assert Units("ft", "lbf").names().of("length/stress") == "ft/(lbf/ft²)"


def test_forces_areas_and_energies_of_unit_thickness_are_per_length():
    found = Units("mm", "N").names(per_unit_thickness=True)
    words = ("force", "energy", "area", "stress", "length", "force/volume")
    assert [found.of(each) for each in words] == ["N/mm", "mJ/mm", "mm", "MPa", "mm", "N/mm³"]


def test_densities_are_by_force_length_and_seconds():
    found = Units("mm", "N").names()
    assert found.of("mass/volume") == "N·s²/mm⁴" and found.of("1/stress") == "1/MPa"
