"""What the program says of memory, against processes that were measured."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from fenics_contact import Contact, Material, Obstacle, Scene, Support
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.memory import contact_unknowns, memory_estimate, memory_terms
from tests.conftest import COMM
from tests.contact.pair_bodies import Box, boxes
from tests.scenes import ROOT, box_body

# Its files find each other as where they are run: beside the program.
sys.path.append(str(ROOT / "benchmarks"))

from cost_cases import FLAT, square
from memory_cases import Seat, body_of_seat, scene_of_seat
from memory_use import COUNTS_FROM, LEAST, MOST, measured


@pytest.mark.skipif(COMM.size > 1, reason="starts processes of its own")
@pytest.mark.parametrize("case", [square(90), FLAT[0]])
def test_estimate_is_near_the_peak_of_a_process(case):
    """Which ``benchmarks/memory_use.py`` tests over a longer table."""
    row = measured(case.name, "condensed", 1)
    assert row["converged"]
    assert row["measured"] > COUNTS_FROM
    assert LEAST < row["estimate"] / row["measured"] < MOST


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
