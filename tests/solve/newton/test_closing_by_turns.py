"""Points that close by turns where friction alone holds bodies and no other way has an answer."""

import dataclasses
import functools
import sys
from types import SimpleNamespace

import gmsh
import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run, Steps
from fenics_contact.solve.closing import ClosingByTurns
from fenics_contact.solve.load_steps.step_tries import StepTries
from tests.scenes import ROOT, with_solver

sys.path.append(str(ROOT / "benchmarks"))
from assembly_scenes import Mesh, clevis

COMM = MPI.COMM_WORLD
PULL = 5e3
# Newton steps of a solve that are too few for all other ways.
FEW = 12
# Gmsh 4.13 finds an end of the pin among its sides: the scene is refused.
SEES_SIDES = tuple(map(int, gmsh.__version__.split(".")[:2])) >= (4, 15)
of_lug = pytest.mark.skipif(not SEES_SIDES, reason="it is for another version of Gmsh")


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


def lug(**solver):
    """A lug that is pulled by its pin, in holes that are wider, in one load step."""
    given = clevis(Mesh(10, 10), clearance=0.02, pull=PULL)
    given = dataclasses.replace(given, steps=Steps(number=1))
    return with_solver(given, errors="none", **solver)


@functools.cache
def answer(**solver):
    return Run(lug(**solver), COMM).solve()


@of_lug
def test_they_lead_to_an_answer_where_no_other_way_does(monkeypatch):
    result = answer(max_iterations=FEW)
    assert result.converged, result.verdict
    for contact in result.contacts:  # each carries all of the pull
        assert abs(contact.quantities["contact_force"][0]) == pytest.approx(PULL, rel=1e-6)

    def give_up(tries, time):
        return None

    monkeypatch.setattr(StepTries, "_try_by_turns", give_up)
    assert not Run(lug(max_iterations=FEW), COMM).solve().converged


@of_lug
def test_the_answer_is_that_of_the_other_ways():
    """Which have one where they may take more steps; it is then theirs."""
    mine, other = answer(max_iterations=FEW), answer()
    assert mine.steps[0].newton_iterations > other.steps[0].newton_iterations
    for one, two in zip(mine.contacts, other.contacts, strict=True):
        for name in ("pressure_integral", "max_contact_pressure", "contact_area"):
            assert one.quantities[name] == pytest.approx(two.quantities[name], rel=1e-3), name


@of_lug
def test_where_they_lead_nowhere_either_the_first_failure_is_told():
    result = answer(max_iterations=2)
    assert not result.converged
    assert "coefficient brought up or down" in result.verdict
