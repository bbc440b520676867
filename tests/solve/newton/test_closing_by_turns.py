"""Points that close by turns: clusters of them do not go round in circles."""

import functools
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from fenics_contact.solve.closing import ClosingByTurns
from tests.scenes import ROOT, with_solver

sys.path.append(str(ROOT / "benchmarks"))
from assembly_scenes import Mesh, clevis

COMM = MPI.COMM_WORLD
PULL = 5e3
# Newton steps of the first load step: half as many again as were measured.
MOST = 32


class Row:
    """A contact with points in a row, each of unit area, whose pressures are said."""

    is_one_sided = True

    def __init__(self, places):
        places = np.asarray(places, dtype=float)
        coordinates = np.column_stack([places, np.zeros((len(places), 2))])
        count = len(places)
        self.trace = SimpleNamespace(
            coordinates=coordinates, weights=np.ones(count), owned=np.ones(count, dtype=bool)
        )
        self.spaces = SimpleNamespace(comm=MPI.COMM_SELF)
        self.kinematics = SimpleNamespace(gap=np.zeros(count))
        self.pressures = np.zeros(count)

    def pressure(self):
        return self.pressures

    def set_gap(self, gap):
        self.kinematics.gap = gap

    def held(self, turns, pressures):
        """Points that are held open in a step from a state with these pressures."""
        self.pressures = np.asarray(pressures, dtype=float)
        turns.hold_open()
        found = np.flatnonzero(np.isinf(self.kinematics.gap)).tolist()
        turns.release()
        assert not self.kinematics.gap.any()
        return found


def test_of_neighbours_that_close_the_most_pressed_one_does():
    row = Row([0, 1, 2, 5])
    turns = ClosingByTurns([row])
    assert row.held(turns, [0, 0, 0, 0]) == []
    assert row.held(turns, [1, 3, 2, 1]) == [0, 2]
    # What has closed keeps nobody waiting.
    assert row.held(turns, [1, 3, 0, 1]) == []


def test_what_touches_as_a_solve_begins_is_not_held():
    row = Row([0, 1, 2])
    assert row.held(ClosingByTurns([row]), [1, 3, 2]) == []


def test_points_that_close_again_and_again_wait_for_others_farther_away():
    row, number = Row([0, 2.4]), 0
    turns = ClosingByTurns([row])
    while row.held(turns, [1, 2]) == []:
        row.held(turns, [0, 0])
        number += 1
    assert number == 4  # 1.1 (1 + .5 · 2) = 2.2 is not yet enough, 1.1 (1 + .5 · 3) = 2.75 is


@functools.cache
def answer(degree, **solver):
    """A lug that is pulled by its pin, in holes that are wider."""
    given = clevis(Mesh(10, 8, degree), clearance=0.02, pull=PULL)
    result = Run(with_solver(given, errors="none", **solver), COMM).solve()
    assert result.converged, result.verdict
    return result


def test_a_pin_in_wider_holes_takes_few_newton_steps():
    result = answer(2)
    assert result.steps[0].newton_iterations <= MOST
    for contact in result.contacts:  # each carries all of the pull
        assert abs(contact.quantities["contact_force"][0]) == pytest.approx(PULL, rel=1e-6)


def test_the_answer_is_that_of_the_whole_system():
    """The ``full`` system has neither condensed bodies nor a contact zone."""
    mine, other = answer(1), answer(1, solver="full")
    for one, two in zip(mine.contacts, other.contacts, strict=True):
        for name in ("pressure_integral", "max_contact_pressure"):
            assert one.quantities[name] == pytest.approx(two.quantities[name], rel=1e-3)
