"""The arithmetic of ``benchmarks/random_scenes.py`` on made-up rows, and its workers on a stub."""

import json
import os
import subprocess
import sys

import pytest

from tests.scenes import ROOT

sys.path.append(str(ROOT / "benchmarks"))

import random_pool
from random_changes import (
    EDGES,
    SWINGS,
    independent,
    refinements,
    refused_rightly,
    wants_finest,
)
from random_coverage import (
    against_statics,
    coverage,
    rank_differences,
    solver_differences,
    table,
)
from random_scenes import REFERENCES, begin, jobs, read, write_section
from random_summary import failures, section, wrong

from fenics_contact.verification.error_bars.runs import kept

PROGRAM = ROOT / "benchmarks" / "random_scenes.py"
pytestmark = pytest.mark.serial
SIZES = {"force": 100.0, "area": 1.0, "energy": 1.0}


def row(number, stage="coarse", code=0, ranks=1, **quantities):
    """A made-up row; quantities are (value, bar)."""
    return {
        "number": number,
        "ranks": ranks,
        "stage": stage,
        "kind": "made up",
        "code": code,
        "words": "",
        "must_be": "",
        "known": [],
        "sizes": SIZES,
        "quantities": {
            name: [value if isinstance(value, list) else [value], bar]
            for name, (value, bar) in quantities.items()
        },
    }


def refined(number, coarse, bar, fine, name="normal_force", **keys):
    """A coarse row and a fine one."""
    return [
        row(number, **{name: (coarse, bar)}) | keys,
        row(number, "fine", **{name: (fine, None)}),
    ]


def test_a_change_within_the_bar_is_covered():
    rows = refined(1, 100.0, 3.0, 102.0) + refined(2, 100.0, 1.0, 102.0)
    found = coverage(rows)["normal_force"]
    assert (found.changes, found.covered, found.missing) == (2, 1, 0)
    assert found.ratios == [1.5, 0.5]
    assert "| normal_force | 2 | 50 % | 0 | 0 | 1 |" in table(coverage(rows))


def test_a_missing_bar_is_not_covered():
    found = coverage(refined(1, 100.0, None, 102.0))["normal_force"]
    assert (found.changes, found.covered, found.missing, found.endless) == (1, 0, 1, 0)


def test_what_does_not_converge_needs_no_bar():
    for note in ("normal force and reaction do not converge: ...", "Only what loads alone decide"):
        found = coverage(refined(1, 100.0, None, 102.0, notes=[note]))["normal_force"]
        assert (found.changes, found.endless) == (0, 1)


def test_a_peak_that_may_grow_needs_a_third_mesh():
    name = "max_contact_pressure"
    notes = ["The largest contact pressure has no error bar: it grows with every refinement, as"]
    rows = refined(1, 100.0, None, 110.0, name, notes=notes)
    assert coverage(rows)[name].missing == 1
    assert wants_finest(rows)
    rows.append(row(1, "finest", **{name: (121.0, None)}))
    assert coverage(rows)[name].endless == 1


def test_round_off_is_left_out():
    assert not coverage(refined(1, 100.0, 0.0, 100.0 + 1e-8))


def test_vectors_count_by_the_length_of_the_difference():
    name = "friction_force"
    covered = refined(1, [3.0, 4.0], 5.1, [0.0, 0.0], name)
    short = refined(2, [3.0, 4.0], 4.9, [0.0, 0.0], name)
    found = coverage(covered + short)[name]
    assert (found.changes, found.covered) == (2, 1)


def test_a_third_mesh_tells_what_oscillates_and_what_does_converge():
    notes = ["normal force does not converge"]
    growing = [
        *refined(1, 100.0, None, 110.0, notes=notes),
        row(1, "finest", normal_force=(119, None)),
    ]
    falling = [
        *refined(2, 100.0, None, 110.0, notes=notes),
        row(2, "finest", normal_force=(113, None)),
    ]
    found = coverage(growing + falling)["normal_force"]
    assert (found.changes, found.endless, found.missing) == (1, 1, 1)
    swinging = [*refined(3, 100.0, 1.0, 110.0), row(3, "finest", normal_force=(105, None))]
    (change,) = refinements(swinging)
    assert change.causes == (SWINGS,)
    assert wants_finest(swinging) and not wants_finest(refined(4, 100.0, 3.0, 102.0))


def test_edges_inside_cells_are_listed_by_themselves():
    rows = refined(1, 100.0, 1.0, 110.0, edges=True)
    for each, area in zip(rows, (0.5, 0.6), strict=True):
        each["quantities"]["contact_area"] = [[area], 0.2]
    by_name = {change.name: change for change in refinements(rows)}
    assert by_name["normal_force"].wrong and by_name["normal_force"].causes == (EDGES,)
    assert not wrong(rows, listed=False) and len(wrong(rows, listed=True)) == 1
    rows[1]["quantities"]["contact_area"] = [[0.5], 0.2]
    assert len(wrong(rows, listed=False)) == 1
    rows[0]["punch"] = True
    assert not wrong(rows, listed=False)


def test_the_largest_slip_is_that_of_points_at_an_edge():
    slip = refined(1, 1.0, 0.01, 1.1, name="max_slip", edges=True)
    force = refined(2, 100.0, 1.0, 110.0, edges=True)
    assert [change.causes for change in refinements(slip + force)] == [(EDGES,), ()]


def test_what_edges_do_to_refined_answers_they_do_to_those_known():
    rows = refined(1, 100.0, 1.0, 110.0, edges=True, known=[["normal_force", 110.0, 0.0]])
    assert [change.causes for change in independent(rows)] == [()]
    for each, area in zip(rows, (0.5, 0.6), strict=True):
        each["quantities"]["contact_area"] = [[area], 0.2]
    assert [change.causes for change in independent(rows)] == [(EDGES,)]


def test_a_contact_that_the_coarse_cells_miss_ends_inside_them():
    sizes = SIZES | {"area": 0.0}
    rows = refined(1, 0.0, 0.1, 10.0, sizes=sizes)
    for each, area in zip(rows, (0.0, 0.6), strict=True):
        each["quantities"]["contact_area"] = [[area], 0.2]
    assert len(wrong(rows, listed=False)) == 1
    rows[1]["edges"] = True
    assert not wrong(rows, listed=False) and len(wrong(rows, listed=True)) == 1


def test_a_section_takes_the_place_of_the_one_before(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("# Bars\n\nall of them\n")
    rows = refined(1, 100.0, 1.0, 110.0)
    for _ in range(2):
        write_section(page, section(rows, 7))
    text = page.read_text()
    assert text.startswith("# Bars\n\nall of them\n\n## Scenes at random\n")
    assert text.count("| 1 | made up | normal_force | 10 | 9.1e-02 | 1 |") == 1
    assert kept(text) == "\n" + text[text.index("## Scenes at random") :]


def test_runs_that_are_not_trusted_are_no_reference():
    rows = refined(1, 100.0, 1.0, 150.0)
    rows[1]["code"] = 4
    assert not coverage(rows)


@pytest.mark.parametrize(
    ("bar", "fine", "expected"),
    [(1.0, 103.5, True), (1.0, 102.9, False), (0.1, 100.9, False), (None, 150.0, False)],
)
def test_wrong_is_more_than_three_bars_and_one_percent(bar, fine, expected):
    (change,) = refinements(refined(1, 100.0, bar, fine))
    assert change.wrong == expected


def test_what_is_known_of_one_contact_and_of_several():
    one = row(1, normal_force=(100.0, 0.5)) | {"known": [["floor.normal_force", 103.0, 0.0]]}
    both = row(2, **{"a.normal_force": (100.0, 0.5)}) | {"known": [["a.normal_force", 100.0, 0.0]]}
    (change,) = independent([one, both])
    assert change.wrong and change.number == 1


def test_a_twin_counts_with_its_factors():
    twin = row(1, "twin", normal_force=(210.0, None), max_slip=(5.0, None))
    twin["factors"] = {"normal_force": 0.5}
    (change,) = independent([row(1, normal_force=(100.0, 1.0), max_slip=(1.0, 0.1)), twin])
    assert change.change == pytest.approx(5.0)
    assert change.wrong


@pytest.mark.parametrize(
    ("force", "failed", "code", "is_rightly"),
    [
        (104.0, "unseen_contact", 0, True),
        (104.0, "boundary_stress", 0, True),
        (100.4, "unseen_contact", 0, False),
        (104.0, "equilibrium", 0, False),
        (104.0, "unseen_contact", 4, False),
    ],
)
def test_what_is_not_trusted_must_be_off_its_twin(force, failed, code, is_rightly):
    """By more than 1 %, with a check of cells that fails and a twin that passes; on any ranks."""
    twin = row(1, "twin", code=code, normal_force=(force, None)) | {"factors": {"normal_force": 1}}
    checks = {"checks": {failed: 1.2, "friction_law": 0.1}}
    rows = [row(1, code=4, ranks=n, normal_force=(100.0, None)) | checks for n in (1, 2)]
    assert refused_rightly([*rows, twin]) == ({1} if is_rightly else set())
    found = [text for text in failures([*rows, twin]) if "coarse" in text]
    assert len(found) == (0 if is_rightly else 2)
    assert len(failures(rows)) == 2


@pytest.mark.parametrize(
    ("must", "code", "count"),
    [("refused", 0, 1), ("refused", 2, 0), ("answered", 3, 1), ("answered", 0, 0), ("", 2, 0)],
)
def test_statics_say_how_it_must_end(must, code, count):
    assert len(against_statics([row(1, code=code) | {"must_be": must}])) == count


def test_ranks_must_agree():
    force = {"normal_force": (100.0, 1.0)}
    assert not rank_differences([row(1, **force), row(1, ranks=2, **force)])
    assert rank_differences([row(1, **force), row(1, ranks=2, code=4, **force)])
    other = row(1, ranks=2, normal_force=(100.1, 1.0))
    assert rank_differences([row(1, **force), other])


def test_solvers_must_agree():
    by_full = row(1, normal_force=(100.0, 1.0)) | {"solver": "full"}

    def other(code, force):
        return row(1, "solver", code=code, normal_force=(force, None)) | {"solver": "condensed"}

    assert not solver_differences([by_full, other(0, 100.0)])
    assert solver_differences([by_full, other(0, 100.1)])
    assert solver_differences([by_full, other(3, 100.0)])


STUB = """
import json, os, sys, time
job = json.loads(open(sys.argv[1]).read())
done = {tuple(pair) for pair in job["done"]}
for number in job["numbers"]:
    if (number, "coarse") in done:
        continue
    open(job["now"], "w").write(json.dumps([number, "coarse"]))
    if number == 2:
        os._exit(11)
    if number == 3:
        time.sleep(60)
    row = {"number": number, "ranks": 1, "stage": "coarse", "code": 2}
    with open(job["rows"], "a") as file:
        file.write(json.dumps(row) + chr(10))
"""


@pytest.fixture
def pool(tmp_path, monkeypatch):
    """Of workers that do as they are told by numbers: 2 crashes, 3 hangs."""
    stub = tmp_path / "stub.py"
    stub.write_text(STUB)
    monkeypatch.setattr(random_pool, "WORKER", stub)
    monkeypatch.setattr(random_pool, "_GRACE", 0.0)
    path, told = tmp_path / "rows.jsonl", []
    assert begin(path, {"seed": 1, "kinds": []})
    return random_pool.Pool(path, tmp_path, 1, (), 0.5, 1, told.append), told


def test_crashes_and_hangs_are_rows_and_the_others_go_on(pool):
    pool, told = pool
    pool.run(jobs(read(pool.rows), [1, 2, 3, 4], [1], REFERENCES))
    codes = {row["number"]: row["code"] for row in read(pool.rows)}
    assert codes == {1: 2, 2: random_pool.CRASHED, 3: random_pool.HUNG, 4: 2}
    assert len(told) == 4


def test_it_goes_on_where_it_was_interrupted(pool):
    pool, told = pool

    def stop(row):
        raise KeyboardInterrupt

    pool.tell = stop
    with pytest.raises(KeyboardInterrupt):
        pool.run(jobs(read(pool.rows), [1], [1], ()))
    with pool.rows.open("a") as file:
        file.write('{"number": 7, "ran')  # as if ended while a line was written
    assert begin(pool.rows, {"seed": 1, "kinds": []})
    assert [row["number"] for row in read(pool.rows)] == [1]
    pool.tell = told.append
    pool.run(jobs(read(pool.rows), [1, 4, 5], [1], ()))
    assert sorted(row["number"] for row in read(pool.rows)) == [1, 4, 5]
    assert [row["number"] for row in told] == [4, 5]


def test_a_file_of_another_seed_is_not_mixed_with_this_one(pool, capsys):
    pool, _ = pool
    assert not begin(pool.rows, {"seed": 2, "kinds": []})
    assert "'seed': 1}, not {'seed': 2" in capsys.readouterr().out


def test_what_is_open_is_solved(pool):
    pool, _ = pool
    answered = row(1) | {"has_twin": True}
    rows = [answered, row(2, code=2), row(3), row(3, "fine")]
    (job,) = jobs(rows, [1, 2, 3, 4], [1], REFERENCES)
    assert job.numbers == [1, 4]
    first, second = jobs([], [1], [1, 2], REFERENCES)
    assert first.stages == ("coarse", "twin", "fine", "finest")
    assert second.stages == ("coarse",)


def test_the_program_solves_one_scene(tmp_path):
    """A slope at 1.001 of its limit, which is refused before any form is compiled."""
    path = tmp_path / "rows.jsonl"
    command = [sys.executable, str(PROGRAM), "--seed", "5"]
    command += ["--only", "4", "--refine", "--out", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    (found,) = [json.loads(line) for line in path.read_text().splitlines()[1:]]
    assert (found["number"], found["stage"], found["must_be"]) == (4, "coarse", "refused")
    assert found["code"] in (2, 3)
