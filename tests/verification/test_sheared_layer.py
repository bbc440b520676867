"""A sheared layer in closed form: height H, shear modulus G, friction on its top.

The bottom is shifted by U, nothing moves vertically, the ends are free, the top rests
under the pressure p against a surface at rest. The state is one of uniform shear:
surface shift U/(1 + μpH/(Gε)) while the top sticks, up to U = ε + μpH/G; then
U − μpH/G (a regularised friction in series with a spring G/H).
"""

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Run, Scene, Support
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
HEIGHT, LENGTH, YOUNG, POISSON, PRESSURE, COEFFICIENT = 0.5, 2.0, 1000.0, 0.25, 20.0, 0.4
SHEAR = YOUNG / (2 * (1 + POISSON))
THRESHOLD = COEFFICIENT * PRESSURE * HEIGHT / SHEAR


def surface_shift(shift, epsilon):
    if shift <= epsilon + THRESHOLD:
        return shift / (1 + THRESHOLD / epsilon)
    return shift - THRESHOLD


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("kinematics", ["plane strain", "plane stress", "3D"])
@pytest.mark.parametrize("epsilon", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("share", [0.3, 0.999999, 1.0, 1.5, 20.0])
def test_surface_shift(kinematics, degree, epsilon, share):
    shift = share * (epsilon + THRESHOLD)
    three = kinematics == "3D"
    up = "z" if three else "y"
    held = {"y": 0, "z": 0} if three else {"y": 0}
    scene = Scene(
        kinematics=kinematics,
        material=Material(YOUNG, POISSON),
        discretisation=Discretisation(degree),
        support=(Support("body", held), Support(f"{up}0", {"x": shift})),
        contact=(
            Contact(
                f"{up}1",
                pressure=PRESSURE,
                friction_coefficient=COEFFICIENT,
                regularisation_parameter=epsilon,
            ),
        ),
    )
    size = (LENGTH, 0.7, HEIGHT) if three else (LENGTH, HEIGHT)
    cell = CellType.hexahedron if three else CellType.triangle
    prepared = Run(scene, COMM, box_body((3, 2, 2)[: 3 if three else 2], size, cell))
    result = prepared.solve()
    failed = {name for name, check in result.checks.items() if not check.passed}
    assert failed <= ({"stick_creep"} if epsilon == 1e-3 else set())  # a tenth of the threshold
    expected = surface_shift(shift, epsilon)
    assert np.abs(result.points.slip[:, 0] - expected).max() < 1e-10
    traction = -COEFFICIENT * PRESSURE * min(expected / epsilon, 1.0)
    assert result.points.friction_traction[:, 0] == pytest.approx(traction, rel=1e-6)
    if share != 1.0:
        assert (result.points.status == ("STICK" if share < 1 else "SLIP")).all()
