"""Exact uniform states for every kinematics, from the closed formulas of elasticity."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Discretisation, Load, Material, Run, Scene, Support, run
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
E, NU, P = 1000.0, 0.3, 10.0


def stretched(kinematics, dimension):
    """A box on three rollers, pulled along its last axis."""
    axes = "xyz"[:dimension]
    traction = (0,) * (dimension - 1) + (P,)
    return Scene(
        kinematics=kinematics,
        material=Material(E, NU),
        support=tuple(Support(f"{axis}0", {axis: 0}) for axis in axes),
        load=(Load(f"{axes[-1]}1", traction=traction),),
    )


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(
    ("kinematics", "cell", "axial", "lateral", "volume"),
    [
        ("plane stress", CellType.triangle, 1 / E, -NU / E, 2.0),
        ("plane stress", CellType.quadrilateral, 1 / E, -NU / E, 2.0),
        ("plane strain", CellType.quadrilateral, (1 - NU**2) / E, -NU * (1 + NU) / E, 2.0),
        ("plane strain", CellType.triangle, (1 - NU**2) / E, -NU * (1 + NU) / E, 2.0),
        ("axisymmetric", CellType.quadrilateral, 1 / E, -NU / E, 4 * np.pi),
        ("3D", CellType.hexahedron, 1 / E, -NU / E, 1.0),
        ("3D", CellType.tetrahedron, 1 / E, -NU / E, 1.0),
    ],
)
def test_uniaxial_stress(kinematics, cell, degree, axial, lateral, volume):
    dimension = 3 if kinematics == "3D" else 2
    size = (2, 1, 0.5) if dimension == 3 else (2, 1)
    scene = dataclasses.replace(
        stretched(kinematics, dimension), discretisation=Discretisation(degree)
    )
    body = box_body((2, 3, 2)[:dimension], size, cell)
    prepared = Run(scene, COMM, body)
    result = prepared.solve()
    assert result.passed
    points = prepared.problem.spaces.coordinates
    exact = points[:, :dimension] * P * np.array([lateral] * (dimension - 1) + [axial])
    assert np.abs(prepared.solution.displacement - exact).max() < 1e-12
    assert result.quantities["strain_energy"] == pytest.approx(0.5 * P**2 * axial * volume)


def test_pressure_and_body_force_are_balanced_by_the_reaction():
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU),
        support=(Support("y0", {"x": 0, "y": 0}),),
        load=(Load("y1", pressure=P), Load("body", body_force=(3, -5))),
    )
    result = run(scene, COMM, box_body((4, 4), (2, 1)))
    assert result.quantities["reaction"] == pytest.approx([-3 * 2, P * 2 + 5 * 2])
    (support,) = result.supports
    assert support["on"] == "y0" and support["displacement"] == [0, 0]
    assert support["reaction"] == pytest.approx(result.quantities["reaction"])


def test_load_that_varies_in_space():
    """A traction x along the top: its resultant and its moment."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU),
        support=(Support("y0", {"x": 0, "y": 0}),),
        load=(Load("y1", traction=(0, lambda x: x[0])),),
    )
    result = run(scene, COMM, box_body((4, 2), (2, 1)))
    assert result.quantities["reaction"] == pytest.approx([0, -2], abs=1e-12)


def test_prescribed_displacement_does_work():
    """Uniaxial strain by a moved side: ½ σ e V from E(1−ν)/((1+ν)(1−2ν))."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU),
        support=(
            Support("x0", {"x": 0}),
            Support("x1", {"x": 0}),
            Support("y0", {"y": 0}),
            Support("y1", {"y": 0.01}),
        ),
    )
    result = run(scene, COMM, box_body((2, 2), (2, 1)))
    modulus = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    assert result.quantities["strain_energy"] == pytest.approx(0.5 * modulus * 0.01**2 * 2)
    assert result.quantities["external_work"] == pytest.approx(modulus * 0.01**2 * 2)
