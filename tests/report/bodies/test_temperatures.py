"""Pictures of bodies that have temperatures."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Material, Scene, Support, Temperature
from fenics_contact.report.bodies.picture import draw_temperatures
from fenics_contact.report.bodies.view_3d import make_view
from fenics_contact.report.drawing.fields import read_body
from fenics_contact.report.drawing.style import COLOUR_MAP, in_units
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.result import read_result
from fenics_contact.scene.units.table import Units
from fenics_contact.verification.boxes import Box, boxes
from tests.report.test_gallery import has_colour, pixels, write_run

pytestmark = pytest.mark.serial


def hot(kinematics, folder):
    """A body, cold at x = 0 and 90 °C at x = 3, and what is read of its run."""
    size = (3, 1, 1) if kinematics == "3D" else (3, 1)
    scene = Scene(
        kinematics=kinematics,
        units=Units("mm", "N", "°C"),
        material=Material(210e3, 0.3, thermal_expansion=12e-6),
        temperature=(Temperature("body", value=lambda x: 30 * x[0] - 20),),
        support=tuple(Support(f"body.{axis}0", {axis: 0.0}) for axis in "xyz"[: len(size)]),
    )
    cell = "hexahedron" if kinematics == "3D" else "quadrilateral"
    parts = [Box("body", (0,) * len(size), size, size)]
    write_run(scene, folder, boxes(parts, cell, comm=MPI.COMM_SELF))
    return read_body(folder), read_result(folder)


@pytest.mark.parametrize("kinematics", ["plane stress", "3D"])
def test_temperatures_are_drawn_from_the_lowest_to_the_highest(kinematics, tmp_path):
    body, result = hot(kinematics, tmp_path)
    with in_units(result.units):
        picture = draw_temperatures(body, result, tmp_path / "temperature.png")
    assert "from -20 °C to 70 °C" in picture.caption
    drawn = pixels(tmp_path / "temperature.png")
    if kinematics == "plane stress":  # in space these are shaded
        import matplotlib

        for end in (0.02, 0.98):
            colour = matplotlib.colors.to_hex(matplotlib.colormaps[COLOUR_MAP](end))
            assert has_colour(drawn, colour, 0.05)


def test_the_interactive_view_has_temperatures(tmp_path):
    body, result = hot("3D", tmp_path)
    view = make_view(body, result, ContactTable.read(tmp_path / "contact.csv"))
    assert view.shown["temperature"] == "T"
    values = view.surface.fields["temperature"]
    assert values == pytest.approx(30 * view.surface.points[:, 0] - 20)
    assert np.ptp(values) == pytest.approx(90)
