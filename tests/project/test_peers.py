"""The comparison with other programs: what its page says follows from the rows that it keeps."""

from __future__ import annotations

import json
import sys
from itertools import pairwise

import pytest
from mpi4py import MPI

from fenics_contact.analytic import contact as formulas
from tests.scenes import ROOT

# Their files find each other as where they are run: beside the program.
sys.path.append(str(ROOT / "benchmarks"))
sys.path.append(str(ROOT / "benchmarks" / "peers"))

from answers import crossing, sample_places
from comparison import BARE, OURS, PROCESS, SOLVE, WHOLE, compare
from page import tables
from page_tables import filled
from pictures import draw, picture_of
from problems import PROBLEMS, growing, problem_named
from programs import programs
from rows import curve, envelope, merged, program_envelope, ratios, seconds_to
from run import MEASURED, Series, measured

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")
PROBLEM = problem_named("indentation")


def made(program, setting, *runs):
    """Rows of one program and setting, from (seconds of solve, error of the force) by level."""
    return [
        {
            **{"problem": "indentation", "program": program, "setting": setting, "level": level},
            **{"solve_seconds": seconds, "process_seconds": seconds + 2.0},
            "values": {"force": PROBLEM.references["force"] * (1 + error)},
        }
        for level, (seconds, error) in enumerate(runs, 1)
    ]


def kept():
    return json.loads(MEASURED.read_text(encoding="utf-8"))


def test_the_page_has_the_tables_of_the_rows_that_are_kept():
    page = (ROOT / "docs" / "peers.md").read_text(encoding="utf-8")
    rows = kept()
    assert filled(page, tables(rows)) == page
    changed = [row | {"solve_seconds": 2 * row.get("solve_seconds", 0)} for row in rows]
    assert filled(page, tables(changed)) != page
    for problem in PROBLEMS:
        assert (ROOT / "docs" / "pictures" / picture_of(problem)).exists()
        assert f"pictures/{picture_of(problem)}" in page


def test_every_run_that_is_tried_is_on_the_page():
    """With its answer or with why there is none; finer meshes than a very slow one are left out."""
    found = {(row["problem"], row["program"], row["setting"]) for row in kept()}
    wanted = {
        (problem.name, program.NAME, setting)
        for program in programs()
        for problem in PROBLEMS
        for setting in program.SETTINGS.get(problem.name, {})
    }
    assert found == wanted


def test_an_error_that_is_small_by_chance_does_not_count():
    rows = made("peer", "a", (1.0, 1e-2), (4.0, -1e-6), (16.0, 1e-3))
    found = curve(rows, "force", PROBLEM.references["force"], SOLVE)
    assert [point.error for point in found] == pytest.approx([1e-2, 1e-3, 1e-3])
    best = envelope(found)
    assert [point.seconds for point in best] == [1.0, 4.0]


def test_the_envelope_is_the_best_of_all_settings():
    rows = made("peer", "a", (1.0, 1e-2), (4.0, 1e-3)) + made("peer", "b", (2.0, 2e-2), (3.0, 5e-4))
    found = program_envelope(rows, "force", PROBLEM.references["force"], SOLVE)
    assert [point.seconds for point in found] == [1.0, 3.0]


def test_ratios_are_of_seconds_at_equal_error():
    rows = made("peer", "a", (1.0, 1e-2), (8.0, 1e-3), (50.0, 1e-5))
    rows += made(OURS, BARE, (0.1, 5e-2), (0.5, 4e-3), (2.0, 2e-4))
    rows += made(OURS, WHOLE, (0.4, 5e-2), (1.0, 4e-3), (4.0, 2e-4))
    found = compare(PROBLEM, rows, "peer", "force", BARE, SOLVE)
    assert found.found == pytest.approx([1.0 / 0.5, 8.0 / 2.0])  # none of ours has 1e-5
    assert found.beyond == 1
    assert str(found) == "**2.8** (2 to 4); at 1 of 3 none of ours"
    with_bars = compare(PROBLEM, rows, "peer", "force", WHOLE, PROCESS)
    assert with_bars.found == pytest.approx([3.0 / 3.0, 10.0 / 6.0])
    assert compare(PROBLEM, rows, "another", "force", BARE, SOLVE) is None
    assert seconds_to([], 1e-3) is None and ratios([], []) == []


def test_of_two_runs_the_faster_counts_and_an_answer_more_than_none():
    first = {"solve_seconds": 1.0, "process_seconds": 3.0, "runs": 1}
    second = {"solve_seconds": 2.0, "process_seconds": 2.5, "runs": 1}
    both = {"solve_seconds": 1.0, "process_seconds": 2.5, "runs": 2}
    assert merged(first, second) == both
    assert merged(None, second) == second
    failed = {"failed": "why", "process_seconds": 1.0, "runs": 1}
    assert merged(failed, second) == second == merged(second, failed)


def test_peak_and_radius_of_the_reference_are_hertz_at_its_force():
    modulus = formulas.plane_strain_modulus(PROBLEM.youngs_modulus, PROBLEM.poissons_ratio)
    depth = (0.75 * PROBLEM.references["force"] / modulus) ** (2 / 3) / PROBLEM.radius ** (1 / 3)
    hertz = formulas.paraboloid(modulus, PROBLEM.radius, depth)
    assert hertz.force == pytest.approx(PROBLEM.references["force"])
    assert hertz.peak == pytest.approx(PROBLEM.references["peak pressure"], rel=3e-5)
    assert hertz.radius == pytest.approx(PROBLEM.references["contact radius"], rel=3e-5)


def test_lines_of_the_mesh_grow_by_one_ratio_from_the_fine_cells():
    lines = PROBLEM.lines(2)
    assert lines[0] == 0.0 and lines[-1] == PROBLEM.extent
    lengths = [there - here for here, there in pairwise(lines)]
    assert lengths[:17] == pytest.approx([0.25] * 17)
    growth = [b / a for a, b in pairwise(lengths[16:])]
    assert growth == pytest.approx([growth[0]] * len(growth), rel=1e-6) and growth[0] > 1
    assert growing(0.0, 3.0, 1.0, 2) == pytest.approx([0.0, 1.0, 3.0])


def test_lines_of_the_slab_make_squares():
    along, up = problem_named("slab").lines(3)
    assert (len(along), len(up)) == (65, 9)
    assert along[1] == up[1] == 0.125 and (along[-1], up[-1]) == (8.0, 1.0)


def test_the_round_body_has_four_cells_where_the_flat_one_has_three():
    pair = problem_named("pair")
    assert pair.upper_cells(3) == (43, 54)  # of .125: 32 on the same width
    assert pair.upper_place(1.0, 0.0) == (4.0, 16 / 400)
    assert pair.upper_place(0.5, 1.0) == (2.0, pair.height)


def test_on_the_half_space_the_references_are_hertz_at_the_force():
    problem = problem_named("half-space")
    depth = problem.contact_radius**2 / problem.radius
    hertz = formulas.paraboloid(problem.modulus, problem.radius, depth)
    assert problem.force == pytest.approx(hertz.force)
    assert problem.references == pytest.approx(
        {"peak pressure": hertz.peak, "contact radius": hertz.radius}
    )


def test_a_quarter_of_the_block_is_fine_at_the_contact():
    block = problem_named("block")
    lines = block.lines(4)
    assert lines[:5] == [0.0, 1.0, 2.0, 3.0, 4.0] and lines[-1] == block.extent
    assert len(lines) == 8


def test_the_edge_of_contact_lies_where_pressure_ends():
    places = sample_places(2.0, 0.5)
    assert len(places) == 160 and places[0] > 0
    assert crossing(places, [1 - x * x for x in places]) == pytest.approx(1, abs=1e-4)
    assert crossing(places, [1.0] * 160) == places[-1]


@pytest.mark.serial
def test_a_run_in_a_process_of_its_own_is_a_row_with_its_answer_or_why_there_is_none():
    row = measured(sys.executable, "fenics_contact_run", ("indentation", OURS, BARE, 1))
    assert row["values"]["force"] == pytest.approx(PROBLEM.references["force"], rel=0.01)
    assert 0 < row["solve_seconds"] < row["process_seconds"]
    row = measured(sys.executable, "fenics_contact_run", ("indentation", OURS, "no such", 1))
    assert row["failed"] == "KeyError: 'no such'"


@pytest.mark.serial
def test_a_picture_is_drawn_of_what_is_kept(tmp_path):
    draw(PROBLEM, kept(), tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000


def test_finer_meshes_than_a_very_slow_one_are_left_out(tmp_path):
    """Also where levels are not numbered one by one."""
    series = Series(tmp_path / "rows.json", ["block"], [])
    run = ("block", "peer", "a", 8)
    assert not series.is_enough(run, 1)
    series.rows["block", "peer", "a", 6] = {"process_seconds": 149.0, "runs": 1}
    assert not series.is_enough(run, 1)
    series.rows["block", "peer", "a", 6] = {"process_seconds": 151.0, "runs": 1}
    assert series.is_enough(run, 1) and not series.is_enough(("block", "peer", "a", 4), 1)
