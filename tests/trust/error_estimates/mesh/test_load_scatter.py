"""Scatter of a force as the edge of contact moves through cells large beside the contact."""

import numpy as np
import pytest

from fenics_contact import Contact, HalfSpace, Material, MeshSource, Obstacle, Scene, run
from tests.scenes import ROOT

pytestmark = pytest.mark.errors

E, NU, RADIUS, CELL = 1000.0, 0.3, 8.0, 1.0


def pressed(contact_radius):
    """A paraboloid on a half-space of which cells are not small beside the contact."""
    return Scene(
        kinematics="axisymmetric",
        mesh=MeshSource(
            str(ROOT / "meshes" / "half_space.geo"),
            cell="quadrilateral",
            parameters={"fine": 6, "size": CELL, "extent": 20},
        ),
        material=Material(E, NU),
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(
            Contact(
                "contact",
                obstacle=Obstacle(
                    "paraboloid", radius=RADIUS, indentation=contact_radius**2 / RADIUS
                ),
            ),
        ),
    )


def test_bars_of_a_force_hold_where_a_contact_is_one_to_four_cells_wide():
    """Hertz: F = 4/3 E* a³/R. Over a part of one cell all that cells do to a force looks smooth."""
    ratios = []
    for radius in (1.2, 1.8, 2.1, 2.4, 2.7, 3.4):
        result = run(pressed(radius * CELL))
        hertz = 4 / 3 * E / (1 - NU**2) * (radius * CELL) ** 3 / RADIUS
        error = abs(result.quantities["normal_force"] - hertz)
        ratios.append(result.errors["normal_force"]["total"] / error)
    assert min(ratios) > 1, ratios
    assert np.median(ratios) < 4
