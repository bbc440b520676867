"""Supports that turn a face: against rigid motions, and formulas of torsion."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    DerivativeRequest,
    Discretisation,
    FaceRotation,
    Material,
    Path,
    Point,
    Scene,
    Steps,
    Support,
    run,
)
from fenics_contact.common.errors import InputError
from tests.problem.rings import ring
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
STEEL = Material(210e3, 0.3)


@pytest.mark.parametrize("kinematics", ["3D", "plane strain"])
def test_a_body_held_by_one_turned_face_turns_rigidly(kinematics):
    """Displacements ω × (x − at), exactly, whatever the order of the axis's length."""
    size = 3 if kinematics == "3D" else 2
    axis, at = (np.array([0.0, 3.0, 4.0]) if size == 3 else None), np.array([0.5, -1.0, 2.0])[:size]
    turn = FaceRotation(angle=1e-3, axis=None if axis is None else tuple(axis), at=tuple(at))
    corner = np.array([2.0, 1.0, 1.0])[:size]
    scene = Scene(
        kinematics=kinematics,
        material=STEEL,
        discretisation=Discretisation(1),
        support=(Support("x0", rotation=turn),),
        point=(Point(name="corner", at=tuple(corner)),),
    )
    found = run(scene, COMM, box_body((2, 2, 2)[:size], tuple(corner)))
    assert found.passed, found.verdict
    direction = np.array([0.0, 0.6, 0.8]) if size == 3 else np.array([0.0, 0.0, 1.0])
    arm = np.zeros(3)
    arm[:size] = corner - at
    expected = 1e-3 * np.cross(direction, arm)[:size]
    assert found.quantities["displacement_corner"] == pytest.approx(expected, abs=1e-13)
    assert found.quantities["strain_energy"] < 1e-12


# A tube of radii 10 and 30 whose rim is turned about its hole.
INNER, OUTER, ANGLE = 10.0, 30.0, 1e-3


def turned_ring(**more):
    support = (
        Support("ring.y0", {"x": 0, "y": 0}),
        Support("ring.y1", rotation=FaceRotation(angle=ANGLE)),
    )
    scene = {"kinematics": "plane strain", "material": STEEL, "support": support}
    return Scene(**{**scene, **more})


def torque(angle):
    """Of a ring over its thickness: T = 4 π G φ / (1/a² − 1/b²)."""
    modulus = 210e3 / 2.6
    return 4 * np.pi * modulus * angle / (INNER**-2 - OUTER**-2)


def test_a_ring_whose_rim_is_turned():
    found = run(turned_ring(), COMM, ring(24, layers=6))
    assert found.passed, found.verdict
    energy = 0.5 * torque(ANGLE) * ANGLE
    assert found.quantities["strain_energy"] == pytest.approx(energy, rel=2e-3)


def test_derivative_by_the_angle_and_a_path():
    """The energy goes with the square of the angle, in each load step."""
    key = "support.1.rotation.angle"
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.5))
    turn = Support("ring.y1", rotation=FaceRotation(angle=ANGLE), path=path)
    scene = turned_ring(
        support=(Support("ring.y0", {"x": 0, "y": 0}), turn),
        steps=Steps(times=(1.0, 2.0)),
        derivatives=DerivativeRequest(("strain_energy",), (key,)),
    )
    found = run(scene, COMM, ring(16))
    first, last = (step.quantities["strain_energy"] for step in found.steps)
    assert last == pytest.approx(0.25 * first, rel=1e-10)
    slope = found.derivatives["strain_energy"][key]["value"]
    assert slope == pytest.approx(2 * last / ANGLE, rel=1e-8)


@pytest.mark.parametrize(
    ("kinematics", "turn", "words"),
    [
        ("plane strain", {"axis": (0, 0, 1)}, "rotation.axis"),
        ("3D", {}, "rotation.axis is missing"),
        ("axisymmetric", {}, "no torsion"),
    ],
)
def test_an_axis_that_the_model_has_not_is_refused(kinematics, turn, words):
    with pytest.raises(InputError, match=words):
        Scene(
            kinematics=kinematics,
            material=STEEL,
            support=(Support("x0", rotation=FaceRotation(angle=0.1, **turn)),),
        )


def test_a_support_says_what_it_holds():
    with pytest.raises(InputError, match="give displacement, rotation, normal, stiffness"):
        Support("x0")
