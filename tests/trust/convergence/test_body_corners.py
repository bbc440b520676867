"""Corners of bodies up to which they are pressed: where stress has no bound, which is said."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from fenics_contact import Contact, Material, Obstacle, Run, Scene, Support, run
from fenics_contact.trust.convergence.body_corners import _conditions, is_singular, singular_corners
from tests.scenes import box_body, with_solver

COMM = MPI.COMM_WORLD
KOLOSOV = 3 - 4 * 0.3
RIGHT = np.pi / 2


def power(angle, friction, kolosov=KOLOSOV):
    """The least real λ, by a search along a line."""

    def determinant(found):
        matrix = _conditions(np.array([found], dtype=complex), angle, friction, kolosov)
        return float(np.real(np.linalg.det(matrix[0]))) / found**2

    at = np.linspace(0.3, 1.2, 400)
    signs = np.sign([determinant(one) for one in at])
    (first, *_) = np.flatnonzero(signs[1:] != signs[:-1])
    return brentq(determinant, at[first], at[first + 1])


def test_powers_are_those_of_the_literature():
    """A clamped side of a right angle: .7112 (Williams 1952); a punch without friction: ½."""
    assert power(RIGHT, None) == pytest.approx(0.7112, abs=1e-4)
    assert power(np.pi, 0.0) == pytest.approx(0.5, abs=1e-9)
    # Of a punch that slides: tan πλ = −(κ + 1)/(μ (κ − 1)) (Johnson 1985, section 2.8(b)).
    for friction in (-0.3, 0.3):
        slid = power(np.pi, friction)
        expected = friction * (KOLOSOV - 1) / (KOLOSOV + 1)
        assert 1 / np.tan(np.pi * slid) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("angle", "friction", "singular"),
    [
        (90, 0.0, False),  # as uniform pressure
        (90, 0.3, True),
        (90, -0.3, False),
        (90, None, True),
        (60, 0.3, False),
        (120, -0.3, True),
        (180, 0.0, True),
        (180, None, True),  # λ = ½ ± iε
        (270, 0.0, True),
    ],
)
def test_wedges(angle, friction, singular):
    assert is_singular(np.radians(angle), friction, KOLOSOV) == singular


# A parabola that reaches over the corner of a block; friction drags the block to the right.
CORNER = Scene(
    kinematics="plane strain",
    material=Material(1000, 0.3),
    support=(Support("y0", {"x": 0, "y": 0}),),
    contact=(
        Contact(
            "y1",
            obstacle=Obstacle("parabola", radius=3, position=(0.03, 1), indentation=0.02),
            friction_coefficient=0.3,
        ),
    ),
)


def with_obstacle(**parts):
    (contact,) = CORNER.contact
    obstacle = dataclasses.replace(contact.obstacle, **parts)
    return dataclasses.replace(CORNER, contact=(dataclasses.replace(contact, obstacle=obstacle),))


def corners(scene, cells=(16, 8)):
    prepared = Run(with_solver(scene, errors="none"), COMM, box_body(cells, (2, 1)))
    assert prepared.solve().converged
    return singular_corners(prepared.problem, prepared.solution.states)


@pytest.mark.errors
def test_the_peak_grows_by_the_power_and_has_no_bar():
    results = [run(CORNER, COMM, box_body((n, n // 2), (2, 1))) for n in (32, 64, 128)]
    peaks = [result.quantities["max_contact_pressure"] for result in results]
    grown = np.log2(np.array(peaks[1:]) / peaks[:-1])
    first, second = np.abs(grown - (1 - power(RIGHT, 0.3)))
    assert second < 0.01
    assert second < 0.5 * first
    rows, own = results[0].errors, results[0].contacts[0].errors
    for name in ("max_contact_pressure", "max_penetration"):
        assert rows[name]["total"] is None
        assert own[name]["total"] is None
    assert rows["normal_force"]["total"] < 0.01 * results[0].quantities["normal_force"]
    (note,) = (note for note in results[0].error_notes if "corner" in note)
    assert "at (0, 1) it reaches a corner of the body of 90°" in note and "friction" in note


def test_only_a_corner_that_is_pressed_counts():
    (found,) = corners(CORNER)
    assert found.contact == 0 and found.place == (0, 1) and found.rubs
    assert found.angle == pytest.approx(90)
    assert corners(with_obstacle(position=(1.0, 1))) == []


def test_without_friction_a_right_angle_has_a_bound():
    (contact,) = CORNER.contact
    smooth = dataclasses.replace(contact, friction_coefficient=0.0)
    assert corners(dataclasses.replace(CORNER, contact=(smooth,))) == []


def test_a_side_that_is_held_is_no_corner():
    held = (*CORNER.support, Support("x0", {"x": 0}))
    assert corners(dataclasses.replace(CORNER, support=held)) == []


def test_of_other_bodies_nothing_is_said():
    soft = Material(lambda x: 1000 + x[0], lambda x: 0.3 + 0 * x[0])
    assert corners(dataclasses.replace(CORNER, material=(soft,))) == []
