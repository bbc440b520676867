"""What the program says of memory, against processes that were measured."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from fenics_contact import Contact, Material, Obstacle, Scene, Support
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.solver_choice import contact_unknowns, memory_estimate, memory_terms
from fenics_contact.verification import memory_check as check
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.memory_check import (
    COUNTS_FROM,
    FLAT,
    LEAST,
    MOST,
    Seat,
    body_of_seat,
    measured,
    scene_of_seat,
    square,
)
from tests.conftest import COMM
from tests.scenes import box_body


@pytest.fixture(scope="module")
def row_of():
    """What was measured of a case, in a process of its own, once."""
    return functools.cache(lambda case: measured(case.name, "condensed"))


@pytest.mark.serial
@pytest.mark.parametrize("case", [square(90), FLAT[0]])
def test_estimate_is_near_the_peak_of_a_process(case, row_of):
    """Which ``fenics-contact verify memory`` tests over a longer table."""
    row = row_of(case)
    assert row["converged"]
    assert row["measured"] > COUNTS_FROM
    assert LEAST < row["estimate"] / row["measured"] < MOST


@pytest.mark.serial
def test_verify_measures_a_case_and_refuses_an_estimate_that_is_far_off(monkeypatch, row_of):
    run = (square(90), "condensed", 1)
    row = dict(row_of(run[0]))
    ratio = row["estimate"] / row["measured"]
    monkeypatch.setattr(check, "measured", lambda case, solver: row)
    (found,) = check.findings_of([run])
    assert found.passed
    assert found.value == ratio
    for wrong in (0.69, 1.51):
        row["estimate"] = wrong * row["measured"]
        (found,) = check.findings_of([run])
        assert not found.passed
    row["converged"], row["estimate"] = False, row["measured"]
    (found,) = check.findings_of([run])
    assert not found.passed
    row["measured"] = 1e6  # so little does not count
    assert not list(check.findings_of([run]))


def pressed(cells):
    held = Support("z0", dict.fromkeys("xyz", 0))
    contact = Contact("z1", obstacle=Obstacle("plane", position=(0, 0, 0.5)))
    scene = Scene(
        kinematics="3D", material=Material(1000, 0.3), support=(held,), contact=(contact,)
    )
    return Problem.on_mesh(scene, box_body(cells))


def test_what_solvers_hold_grows_with_the_body():
    """More than with its unknowns, the program itself left out."""
    small, large = pressed((4, 4, 2)), pressed((8, 8, 4))
    for name in ("condensed", "full", "iterative"):
        parts = [memory_terms(problem, name) for problem in (small, large)]
        few, many = (sum(terms.values()) - terms["program"] for terms in parts)
        assert many > 4 * few
        assert memory_estimate(large, name) == sum(parts[1].values())


def test_dofs_that_contacts_share_count_once():
    """A cube of 4 cells a side on a floor and against a wall of 3: an edge of 5 nodes is shared.

    By coordinates: of both faces of the cube 2 × 5² − 5 nodes, of floor and wall 4² each.
    """
    seat = Seat(4)
    problem = Problem.on_mesh(scene_of_seat(seat, "condensed"), body_of_seat(seat, COMM))
    assert contact_unknowns(problem) == 3 * (2 * 25 - 5 + 2 * 16)


def test_bodies_are_factorised_each_by_itself():
    """Two bodies of n unknowns need twice what one does, not 2^(4/3) times as much."""
    cells = (6, 6, 6)
    below, above = (
        Box("below", (0, 0, -1), (1, 1, 0), cells),
        Box("above", (0, 0, 0), (1, 1, 1), cells),
    )
    supports = tuple(
        Support(f"{box.name}.{side}", dict.fromkeys("xyz", 0))
        for box, side in ((below, "z0"), (above, "z1"))
    )
    factors = []
    for parts, count in (((below,), 1), ((below, above), 2)):
        contact = Contact("below.z1", obstacle=Obstacle("plane", normal=(0, 0, -1)))
        scene = Scene(
            kinematics="3D",
            material=Material(1000, 0.3),
            support=supports[:count],
            contact=(contact,),
        )
        problem = Problem.on_mesh(scene, boxes(parts, "hexahedron", COMM))
        factors.append(memory_terms(problem, "condensed")["factor"])
    assert np.isclose(factors[1], 2 * factors[0])
