"""What is drawn along lines, the axis and the surface, against Hertz's solution."""

import numpy as np
import pytest

from fenics_contact.analytic import contact as formulas
from fenics_contact.report.contacts.depth_curves import (
    AxisStress,
    SurfaceDisplacement,
    contact_radius,
)
from fenics_contact.report.contacts.section_stress import section_at
from fenics_contact.report.drawing.fields import read_body
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.result import read_result
from tests.report.test_gallery import small_sphere, write_run

pytestmark = pytest.mark.serial


def sphere_files(folder, coefficient):
    """The body, the contact points and the result of a small sphere."""
    write_run(small_sphere(0.25, friction_coefficient=coefficient), folder)
    result = read_result(folder)
    return read_body(folder), ContactTable.read(folder / "contact.csv"), result.contacts[0]


def test_stress_below_a_sphere(tmp_path):
    """Hertz's, ν = .3 (Johnson, Contact Mechanics, 1985, Section 3.4)."""
    body, rows, contact = sphere_files(tmp_path, 0)
    stress = AxisStress.of(body, rows)
    radius, peak = contact_radius(rows, contact), contact["quantities"]["max_contact_pressure"]
    assert radius == pytest.approx(8**0.5, rel=0.01)
    assert stress.axial[0] / peak == pytest.approx(-1, abs=0.02)
    most = int(np.argmax(stress.shear))
    assert stress.shear[most] / peak == pytest.approx(0.31, abs=0.01)
    assert stress.depth[most] / radius == pytest.approx(0.48, abs=0.05)
    value, place = section_at(body, rows, contact, flat=True).peak
    assert value / peak == pytest.approx(0.31, abs=0.01)
    assert place == pytest.approx([0, -0.48 * radius], abs=0.06 * radius)
    below = (stress.depth > 0.2 * radius) & (stress.depth < 2 * radius)  # on the fine cells
    hertz = formulas.paraboloid(formulas.plane_strain_modulus(1000, 0.3), 8, 1)
    axial, radial = formulas.axis_stress(hertz, stress.depth[below], 0.3)
    assert stress.axial[below] == pytest.approx(axial, abs=0.02 * hertz.peak)
    assert stress.radial[below] == pytest.approx(radial, abs=0.02 * hertz.peak)


def test_displacement_of_the_surface_below_a_sphere(tmp_path):
    """It follows the paraboloid; friction, where it sticks, keeps it from moving inwards."""
    inwards = []
    for coefficient in (0, 0.6):
        body, rows, contact = sphere_files(tmp_path, coefficient)
        found = SurfaceDisplacement.of(body, rows, contact)
        closed, r = found.line.rows.closed, found.line.position
        assert closed.sum() > 5
        assert found.normal[closed] == pytest.approx(r[closed] ** 2 / 16 - 1, abs=1e-3)
        inwards.append(-found.tangential)
        stuck = found.line.rows.status == "STICK"
    assert np.abs(inwards[1][stuck]).max() < 1e-5
    # Johnson, Section 3.4: −u_r = (1 − 2ν)(1 + ν) a² p0 / (3 E r) [1 − (1 − r²/a²)^(3/2)]
    inside = r < 2.5
    hertz = 0.4 * 1.3 * 8 * 247.34 / 3000 / r * (1 - np.maximum(1 - r**2 / 8, 0) ** 1.5)
    assert inwards[0][inside] == pytest.approx(hertz[inside], abs=0.02 * hertz.max())
