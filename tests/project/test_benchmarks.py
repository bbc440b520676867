"""The benchmark of costs counts what it says, on a small mesh."""

from __future__ import annotations

import dataclasses
import math
import sys

import numpy as np
import pytest

from fenics_contact import SolverSettings, run
from fenics_contact.common.parallel import largest
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.verification.memory_check import (
    FLAT,
    FLAT_PAIRS,
    PAIRS,
    SLIPPERY,
    BlockCase,
    flat,
    flat_pair,
    slab,
    square,
)
from fenics_contact.verification.memory_worker import body_of, scene_of
from tests.conftest import COMM

# Its files find each other as where they are run: beside the program.
from tests.scenes import ROOT

sys.path.append(str(ROOT / "benchmarks"))

import assemblies
import assembly_calculix
import assembly_scenes
import cost_measure
import derivative_cost
import derivative_table
import fit_coverage
from cost_cases import all_runs, quick_runs
from cost_heat import heat_row, with_heat
from cost_measure import LIMIT_OF_FURTHER_STEP, limit_of, measure
from cost_page import filled
from cost_solves import frictional_solve, linear_seconds, linear_solvers
from study_cost import QUICK, hertz
from study_cost import measure as measure_study

KEYS = [
    *("case", "dimension", "element", "bodies", "full_contact", "dofs", "contact_dofs"),
    *("solver", "solver_chosen", "ranks", "linear_solver", "linear_seconds", "linear_memory_mb"),
    *("frictional_seconds", "pairing_seconds", "ratio", "steps", "newton", "outer"),
    *("factorisations", "preconditioner_setups", "peak_memory_mb", "slip_share"),
    *("further_step_seconds", "further_step_ratio", "further_step_ratio_with_results"),
    "seconds_errors",
]
CASE = BlockCase("Q2", (20, 20))
PAIR = BlockCase("Q2", (20, 10), upper=(15, 7))


def without_errors(case, solver):
    """A case measured, but not what error bars take: several times as long as all the rest."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cost_measure, "seconds_of_errors", lambda problem: 1.0)
        return measure(case, solver, COMM, enough=0)


@pytest.fixture(scope="module")
def measured():
    whole = measure(CASE, "condensed", COMM, enough=0)
    return {"condensed": whole, "full": without_errors(CASE, "full")}


@pytest.fixture(scope="module")
def measured_pair():
    return {name: without_errors(PAIR, name) for name in ("condensed", "full")}


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
    assert condensed["solver"] == condensed["solver_chosen"] == "condensed"
    assert condensed["seconds_errors"] > 0
    assert condensed["further_step_ratio"] is None
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


@pytest.mark.parametrize("case", [PAIR, BlockCase("P1 tets", (8, 8, 2), upper=(6, 6, 2))])
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


def test_rows_with_heat_compare_runs_of_blocks_that_conduct():
    """By a conductance of the pressure, so that it is less than where all is pressed hard."""
    case = BlockCase("Q2", (10, 5), upper=(8, 4))
    row = heat_row(case, COMM, enough=0)
    assert row["heat_ratio"] == row["heat_run_seconds"] / row["run_seconds"] > 0
    cold = dataclasses.replace(scene_of(case, "condensed"), solver=SolverSettings(errors="none"))
    flow = -run(with_heat(cold), COMM, body_of(case, COMM)).quantities["heat_flow"]
    assert 10 < flow < 100 / 0.75  # of a width of 1, over a height of 3/4


def test_quick_runs_of_solve_cost_have_full_contact_of_one_body_and_of_two():
    quick = [case for case, _ in quick_runs()]
    assert [case for case in quick if case.upper and not case.full_contact] == PAIRS[:1]
    large = [case for case in quick if case.full_contact and contact_dofs(case) >= 2800]
    assert sorted(len(case.blocks) for case in large) == [1, 2]
    assert all("full contact" in case.name for case in large)


def contact_dofs(case):
    """Of a case in full contact."""
    return sum(3 * (cells[0] + 1) * (cells[1] + 1) for cells in case.blocks)


def test_names_of_cases_are_those_that_scripts_look_for():
    runs = [(case.name, solver) for case, solver in all_runs()]
    assert len(set(runs)) == len(runs)
    assert ("3D Q1 hexes 46k, half-space 3D", "iterative") in runs
    assert ("2D Q2 15k, further steps", "condensed") in runs
    assert ("3D Q1 hexes 39k, two bodies, full contact, slipping", "iterative") in runs


def test_sizes_in_full_contact():
    sizes = [(round(case.dofs / 1000), contact_dofs(case)) for case in (*FLAT, *FLAT_PAIRS)]
    alone = [(15, 1323), (32, 2883), (66, 5043), (201, 11163)]
    assert sizes == [*alone, (39, 4758), (39, 4758), (202, 18366)]


@pytest.mark.parametrize(
    ("case", "slips"),
    [
        (flat(10, 4), (0.3, 0.7)),
        (flat_pair((10, 3), (8, 2)), (0.0, 0.1)),
        (flat_pair((10, 3), (8, 2), SLIPPERY), (0.3, 0.9)),
    ],
)
def test_all_of_the_face_touches_in_full_contact(case, slips):
    found = without_errors(case, "condensed")
    assert found.row["contact_dofs"] == contact_dofs(case)
    assert found.quantities["contact_area"] == pytest.approx(1, rel=1e-9)  # of width 1
    assert slips[0] <= found.row["slip_share"] <= slips[1]
    assert limit_of(found.row) == (4.0 if len(case.blocks) == 1 else None)


def test_a_piece_of_a_half_space_meets_hertz():
    """P = 4/3 E* √R d^(3/2) (K. L. Johnson, Contact Mechanics, 1985, Section 4.2)."""
    case = BlockCase("Q1 hexes", (20, 20, 10), half_space=True)
    problem = Problem.on_mesh(scene_of(case, "iterative"), body_of(case, COMM))
    solution = frictional_solve(problem).solution
    force = contact_quantities(problem, solution, 0)["normal_force"]
    assert force == pytest.approx(4 / 3 * 1000 / (1 - 0.3**2) * 0.02**1.5, rel=0.05)


@pytest.mark.parametrize("case", [square(10), slab("P1 tets", 6)])
def test_every_linear_solver_solves(case):
    """It raises where one does not converge."""
    problem = Problem.on_mesh(scene_of(case, "condensed"), body_of(case, COMM))
    ways = linear_solvers(problem, "condensed")
    assert len(ways) == (4 if case.dimension == 2 else 2)
    for settings in (*ways.values(), *linear_solvers(problem, "iterative").values()):
        assert linear_seconds(problem, settings) > 0


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
    case = BlockCase("Q2", (8, 8), steps=3)
    found = without_errors(case, "condensed")
    assert found.row["steps"] == 3
    assert found.row["factorisations"] == 1
    assert 0 < found.row["further_step_ratio"] < found.row["further_step_ratio_with_results"]
    assert found.row["further_step_ratio"] == pytest.approx(
        found.row["further_step_seconds"] / found.row["linear_seconds"]
    )
    assert LIMIT_OF_FURTHER_STEP == 0.1


def test_limits_of_solve_cost_are_those_asked_for():
    row = {"solver_chosen": "condensed", "steps": 1, "ranks": 1, "dimension": 3, "dofs": 10000}
    row |= {"bodies": 1, "full_contact": False}
    assert limit_of(row | {"contact_dofs": 250}) == 1.4
    assert limit_of(row | {"contact_dofs": 800}) == 2.0
    assert limit_of(row | {"contact_dofs": 800, "ranks": 2}) == 2.4
    assert limit_of(row | {"contact_dofs": 100, "dimension": 2}) == 1.5
    assert limit_of(row | {"contact_dofs": 100, "solver_chosen": "full"}) is None
    pair = row | {"contact_dofs": 800, "bodies": 2}
    assert limit_of(pair) == limit_of(pair | {"dimension": 2}) == 1.4
    assert limit_of(pair | {"ranks": 2}) is None
    assert limit_of(pair | {"solver_chosen": "iterative"}) is None
    assert limit_of(pair | {"steps": 21}) is None


def test_limits_of_full_contact_are_those_asked_for():
    row = {"solver_chosen": "iterative", "steps": 1, "ranks": 1, "dimension": 3, "bodies": 1}
    row |= {"full_contact": True, "dofs": 66_000, "contact_dofs": 5043, "slip_share": 0.5}
    assert limit_of(row) == 3.5
    assert limit_of(row | {"dofs": 201_000}) == 4.0
    condensed = row | {"solver_chosen": "condensed"}
    assert limit_of(condensed | {"dofs": 32_000}) == 4.0
    assert limit_of(condensed) is None
    assert limit_of(row | {"bodies": 2}) == 5.5
    assert limit_of(row | {"bodies": 2, "slip_share": 0.0}) == 4.0


def test_the_page_of_costs_has_a_place_for_every_row(measured, measured_pair):
    page = (ROOT / "docs" / "solve_cost.md").read_text(encoding="utf-8")
    rows = [found.row for found in (*measured.values(), *measured_pair.values())]
    rows.append(rows[0] | {"case": "all of it", "full_contact": True, "ratio": 9.87})
    rows.append(rows[0] | {"case": "several", "steps": 9, "further_step_ratio": 0.3})
    rows[-1]["further_step_ratio_with_results"] = 0.4
    new = filled(page, rows)
    assert new.count("| 2D Q2 3k |") == 2  # by two solvers
    assert new.count("| 2D Q2 3k, two bodies |") == 2
    assert new.count("| all of it |") == 1
    assert "| several | condensed | **0.300** |" in new
    assert filled(new, rows) == new
    with pytest.raises(ValueError, match="is to have"):
        filled(page.replace("table: iterative", "table: other"), rows)


@pytest.mark.serial
def test_rows_of_derivative_cost_say_what_was_asked(monkeypatch):
    monkeypatch.setattr(derivative_cost, "STEPS", 5)
    block = derivative_cost.block(square(8))
    single = derivative_cost.measure(derivative_cost.Asked("block", block), times=1)
    assert "contact.0.friction_coefficient" in single["keys"]
    assert single["ratio"] == single["derivative_seconds"] / single["linear_seconds"] > 0
    assert single["run_seconds"] is single["limit"] is None  # too small for a limit
    several = derivative_cost.history(8)
    row = derivative_cost.measure(derivative_cost.Asked("history", several), times=1)
    assert row["steps"] == 5
    assert row["ratio"] == row["derivative_seconds"] / row["run_seconds"] > 0


def test_a_row_of_the_table_of_derivatives_tells_a_wrong_one(monkeypatch):
    assert derivative_table.row_of("friction around points")["largest"] < 1
    monkeypatch.setattr(SurfaceAverage, "radius_slope", lambda average, values: 0.99 * values)
    row = derivative_table.row_of("friction around points")
    assert row["largest"] > 1e3 and row["key"] == "contact.0.friction_law.averaging_radius"


@pytest.mark.serial
def test_rows_of_study_cost_say_what_was_asked():
    row = measure_study(next(asked for asked in QUICK if asked.name == "slab, load"))
    assert row["factorisations"] == 1
    assert row["warm_start"] == "warm"
    assert 0 < row["warm_seconds"] < row["first_seconds"]
    assert hertz(2)["largest_error"] < 0.005


def test_a_trial_of_fit_coverage_misses_another_truth(monkeypatch):
    """Data of a tenth more force are those of a block that is stiffer and rougher than it says."""
    monkeypatch.setattr(fit_coverage, "STEPS", 8)
    monkeypatch.setattr(fit_coverage, "FITTED", (6, 4))
    times, forces = fit_coverage.true_curve((6, 4))
    assert forces[2] == pytest.approx(0.3 * 8, rel=1e-3)  # μ times the force: it slips
    wrong = fit_coverage.trial(np.random.default_rng(1), times, 1.1 * forces)
    assert wrong.converged and wrong.covered == [False, False] and min(wrong.widths) > 1
    right = fit_coverage.Trial([True, True], [1.1, 1.2], 5, True)
    found = fit_coverage.summary([right, wrong])
    assert list(found["coverage"].values()) == [0.5, 0.5]
    assert found["evaluations_most"] == max(5, wrong.evaluations)


def test_a_row_of_assemblies_is_of_the_run(monkeypatch):
    monkeypatch.setattr(CondensedSystem, "_take_body", CondensedSystem._take_body)
    two = assembly_scenes.stack(assembly_scenes.Mesh(10, 3, degree=1), plates=2)
    row = assemblies.measure(assembly_scenes.Case("two plates", lambda: two), "none")
    assert row["exit_code"] == 0, row["words"]
    assert len(row["newton"]) == len(two.steps.times)
    assert 0 < row["present_dofs"][-1] <= row["contact_dofs"] < row["dofs"]
    assert row["peak_memory_mb"] > 100


@pytest.mark.serial
def test_the_input_of_calculix_is_the_scene():
    """Middle nodes of `C3D10` by its manual, sides where contact is, and forces of tractions.

    Plates of 20 × 20, pressed by 10 and then sheared by 1.
    """
    scene = assembly_scenes.stack(assembly_scenes.Mesh(10, 3), plates=2, shear=0.1)
    lines = list(assembly_calculix.Model(scene).lines(assembly_calculix.SETTINGS[0]))

    def rows(head, first=0):
        start = lines.index(head, first) + 1
        end = next(n for n in range(start, len(lines)) if lines[n].startswith("*"))
        return [[part.strip() for part in line.split(",")] for line in lines[start:end]]

    places = np.array(rows("*NODE, NSET=ALL"), dtype=float)[:, 1:]
    cells = np.array(rows("*ELEMENT, TYPE=C3D10, ELSET=BODY"), dtype=int)[:, 1:] - 1
    ends = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    for middle, (one, other) in enumerate(ends, start=4):
        mean = (places[cells[:, one]] + places[cells[:, other]]) / 2
        np.testing.assert_allclose(places[cells[:, middle]], mean, atol=1e-9)
    sides = {"S1": (0, 1, 2), "S2": (0, 3, 1), "S3": (1, 3, 2), "S4": (2, 3, 0)}
    levels = [
        np.ptp([places[cells[int(n) - 1, list(sides[side])], 2] for n, side in rows(head)])
        for head in ("*SURFACE, NAME=S0, TYPE=ELEMENT", "*SURFACE, NAME=M0, TYPE=ELEMENT")
    ]
    assert max(levels) < 1e-9
    steps = [n for n, line in enumerate(lines) if line.startswith("*STEP")]
    for first, pushed in zip(steps, (0.0, 1.0), strict=True):
        forces = np.zeros(3)
        for _, axis, force in rows("*CLOAD, OP=NEW", first):
            forces[int(axis) - 1] += float(force)
        np.testing.assert_allclose(forces, 400 * np.array([pushed, 0, -10]), atol=1e-6)
