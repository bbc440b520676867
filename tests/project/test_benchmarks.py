"""The benchmark of costs counts what it says, on a small mesh."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from fenics_contact.common.parallel import largest
from fenics_contact.problem.problem import Problem
from tests.conftest import COMM

# Its files find each other as where they are run: beside the program.
from tests.scenes import ROOT

sys.path.append(str(ROOT / "benchmarks"))

from cost_cases import PAIRS, Case, body_of, quick_runs, scene_of
from cost_measure import limit_of, measure

KEYS = [
    *("case", "dimension", "element", "bodies", "dofs", "contact_dofs", "solver", "ranks"),
    *("linear_seconds", "frictional_seconds", "pairing_seconds", "ratio"),
    *("steps", "newton", "outer"),
    *("factorisations", "preconditioner_setups", "peak_memory_mb"),
]
CASE = Case("Q2", (20, 20))
PAIR = Case("Q2", (20, 10), upper=(15, 7))


@pytest.fixture(scope="module")
def measured():
    return {name: measure(CASE, name, COMM, enough=0) for name in ("condensed", "full")}


@pytest.fixture(scope="module")
def measured_pair():
    return {name: measure(PAIR, name, COMM, enough=0) for name in ("condensed", "full")}


def test_rows_of_solve_cost_say_what_was_counted(measured):
    condensed, full = measured["condensed"].row, measured["full"].row
    assert list(condensed) == list(full) == KEYS
    assert condensed["dofs"] == CASE.dofs == 2 * 41**2
    assert condensed["contact_dofs"] == 2 * 21  # the middle half of the top
    assert condensed["ranks"] == COMM.size
    assert condensed["ratio"] == condensed["frictional_seconds"] / condensed["linear_seconds"] > 0
    assert condensed["factorisations"] == 1
    assert full["factorisations"] == full["newton"] > 1
    assert condensed["preconditioner_setups"] == full["preconditioner_setups"] == 0
    assert condensed["bodies"] == 1
    memory = condensed["peak_memory_mb"]
    assert math.isnan(memory) or 1 < memory < 1000


def test_rows_of_two_bodies_count_both_and_the_time_of_pairing(measured_pair):
    row = measured_pair["condensed"].row
    assert list(row) == KEYS
    assert row["bodies"] == 2
    assert row["dofs"] == PAIR.dofs == 2 * (41 * 21 + 31 * 15)
    # The middles: 8 of 20 facets below, whose centres are within .22, and 7 of 15 above.
    assert row["contact_dofs"] == 2 * (17 + 15)
    assert 0 < row["pairing_seconds"] < row["frictional_seconds"]
    assert limit_of(row) == (1.4 if COMM.size == 1 else None)
    assert limit_of(measured_pair["full"].row) is None


@pytest.mark.parametrize("case", [PAIR, Case("P1 tets", (8, 8, 2), upper=(6, 6, 2))])
def test_foot_of_the_upper_block_is_round_and_touches_the_lower_one(case):
    body = body_of(case, COMM)
    problem = Problem.on_mesh(scene_of(case, "condensed"), body)
    assert problem.spaces.parts.count == 2
    nodes, last = problem.spaces.nodes(body.groups["upper"]), case.dimension - 1
    points = problem.spaces.coordinates[nodes]
    lift = ((points[:, :last] - 0.5) ** 2).sum(axis=1) / 2
    lower = case.heights[0]
    assert np.allclose(points[:, last], lower + lift, rtol=0, atol=1 / case.upper[0] ** 2 / 4)
    highest = largest(COMM, body.mesh.geometry.x[:, last])
    assert highest == pytest.approx(lower + case.heights[1] + last * 0.5**2 / 2)


def test_quick_runs_of_solve_cost_have_two_bodies_once():
    assert [case for case, _ in quick_runs() if case.upper] == PAIRS[:1]


@pytest.mark.parametrize("pair", [False, True])
def test_solvers_of_solve_cost_agree_where_part_sticks_and_part_slips(
    measured, measured_pair, pair
):
    found = measured_pair if pair else measured
    one, other = found["condensed"], found["full"]
    assert 0 < one.quantities["stick_area"] < one.quantities["contact_area"] < 0.5
    # Two meshes of the same case may be dealt out to ranks otherwise: so by numbers of the whole.
    for key in ("normal_force", "friction_force", "max_contact_pressure", "max_slip", "slip_area"):
        assert one.quantities[key] == pytest.approx(other.quantities[key], rel=1e-8), key


def test_further_steps_of_solve_cost_share_the_factorisation():
    case = Case("Q2", (8, 8), steps=3)
    found = measure(case, "condensed", COMM, enough=0)
    assert found.row["steps"] == 3
    assert found.row["factorisations"] == 1
    alone, with_results = found.further
    assert 0 < alone < with_results


def test_limits_of_solve_cost_are_those_asked_for():
    row = {"solver": "condensed", "steps": 1, "ranks": 1, "dimension": 3, "dofs": 10000}
    row["bodies"] = 1
    assert limit_of(row | {"contact_dofs": 250}) == 1.4
    assert limit_of(row | {"contact_dofs": 800}) == 2.0
    assert limit_of(row | {"contact_dofs": 800, "ranks": 2}) == 2.4
    assert limit_of(row | {"contact_dofs": 100, "dimension": 2}) == 1.5
    assert limit_of(row | {"contact_dofs": 100, "solver": "full"}) is None
    pair = row | {"contact_dofs": 800, "bodies": 2}
    assert limit_of(pair) == limit_of(pair | {"dimension": 2}) == 1.4
    assert limit_of(pair | {"ranks": 2}) is None
    assert limit_of(pair | {"solver": "iterative"}) is None
    assert limit_of(pair | {"steps": 21}) is None
