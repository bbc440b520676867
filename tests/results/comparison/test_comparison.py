"""Runs side by side, from files that are made up: what differs, and by how many error bars."""

import json
import math

import pytest

from fenics_contact.results.compared_runs import read_runs
from fenics_contact.results.comparison import Comparison
from fenics_contact.results.rounding import NO_BARS, Estimate, difference
from tests.messages import refused
from tests.records import made_run

pytestmark = pytest.mark.serial

SCENE = """
title = "One"
kinematics = "plane strain"

[material]
youngs_modulus = 1000
poissons_ratio = 0.3

[mesh]
file = "../block.geo"

[[support]]
on = "bottom"
displacement = {x = 0, y = 0}

[[contact]]
on = "top"
pressure = 10
"""
CONTACT = {
    "name": "lug",
    "law": "static",
    "parameters": {"friction_coefficient": 0.5},
    "quantities": {
        **{"normal_force": 200.0, "pressure_integral": 200.0},
        **{"friction_force": [30.0, 40.0], "max_slip": None},
    },
    "errors": {"normal_force": {"total": 4.0}, "friction_force": {"total": 1.0}},
}
UNITS = {"length": "mm", "force": "N", "stress": "MPa", "energy": "mJ"}


def written(folder, **content):
    """The folder of a run of which only ``result.json`` is there."""
    folder.mkdir()
    quantities = {"normal_force": 200.0, "reaction": [0.0, -200.0], "contact_area": 1.0}
    filled = {
        "scene": SCENE,
        "contacts": [CONTACT],
        "quantities": quantities,
        "errors": {"normal_force": {"total": 4.0}, "reaction": {"total": None}},
    }
    record = made_run(filled | content)
    (folder / "result.json").write_text(json.dumps(record.as_dict()), encoding="utf-8")
    return folder


def compared(*folders, every=False):
    return Comparison(read_runs(folders), every)


def rows(comparison):
    """All quantities that are shown, by name and group."""
    return {(group.title, row.name): row for group in comparison.groups() for row in group.rows}


def test_bars_are_added():
    """Intervals of 10 ± 1 and 13 ± 2 just touch: one error bar; from 16 on they are apart."""
    one = Estimate(10.0, {"total": 1.0})
    found = difference(one, Estimate(13.0, {"total": 2.0}), 0.0)
    assert (found.count, found.bars, found.is_beyond_bars) == (pytest.approx(1), "1", False)
    found = difference(one, Estimate(16.0, {"total": 2.0}), 0.0)
    assert found.bars == "2" and found.is_beyond_bars and found.share == "60 %"


def test_of_vectors_the_length_of_the_difference_counts():
    """The bar of a vector is that of its length: (3, 4) apart are 5."""
    one, other = (Estimate(v, {"total": 1.25}) for v in ([10.0, 0.0], [13.0, 4.0]))
    found = difference(one, other, 0.0)
    assert (found.words, found.bars) == ("3.0, 4.0", "2")
    assert difference(one, Estimate([1.0, 2.0, 3.0]), 0.0).words == "not comparable"


@pytest.mark.parametrize(
    ("errors", "bars", "beyond"),
    [
        ((None, {"total": 1.0}), "?", False),
        (({"total": 1.0}, {"total": None}), "?", False),
        (({"total": 0.0}, {"total": 1e-12}), NO_BARS, True),
    ],
)
def test_a_bar_that_is_missing_is_never_zero(errors, bars, beyond):
    found = difference(*(Estimate(x, e) for x, e in zip((1.0, 2.0), errors, strict=True)), 0.0)
    assert found.bars == bars and found.is_there and found.is_beyond_bars == beyond
    assert (found.count is None) == (bars == "?") and (found.count == math.inf) == beyond


def test_round_off_is_no_difference():
    row = {"total": None}
    assert not difference(Estimate(100.0, row), Estimate(100.0 + 1e-7, row), 0.0).is_there
    assert not difference(Estimate(0.0, row), Estimate(1e-9, row), 200.0).is_there
    assert difference(Estimate(0.0, row), Estimate(1e-5, row), 200.0).is_there
    # no value in both, for the same reason, is none either
    none = Estimate(None, None, "none, the surface wraps around")
    assert not difference(none, none, 1.0).is_there
    assert difference(none, Estimate(1.0, row), 1.0).is_there


def test_keys_are_those_of_set_and_missing_ones_have_their_defaults(tmp_path):
    changed = SCENE.replace("pressure = 10", "pressure = 12\nfriction_coefficient = 0.25")
    changed += '[[load]]\non = "left"\ntraction = [1, 2.5]\n[solver]\ntolerance = 1e-6\n'
    a, b = written(tmp_path / "a"), written(tmp_path / "b", scene=changed)
    found = {key: values for key, *values in compared(a, b).scene_rows()}
    assert found == {
        "contact.0.pressure": ["10", "12"],
        "contact.0.friction_coefficient": ["0 (default)", "0.25"],
        "load.0.on": ["none", "left"],
        "load.0.traction": ["none", "[1, 2.5]"],
        "solver.tolerance": ["1e-10 (default)", "1e-06"],
    }
    every = [key for key, *_ in compared(a, b, every=True).scene_rows()]
    assert "material.poissons_ratio" in every and set(found) < set(every)


def test_a_table_beside_a_list_of_them_is_its_first(tmp_path):
    several = SCENE.replace("[material]", "[[material]]").replace("= 1000", "= 2000")
    several += '[[material]]\non = "shaft"\nyoungs_modulus = 500\npoissons_ratio = 0.2\n'
    a, b = written(tmp_path / "a"), written(tmp_path / "b", scene=several)
    found = {key: values for key, *values in compared(a, b).scene_rows()}
    assert found["material.0.youngs_modulus"] == ["1000", "2000"]
    assert found["material.1.on"] == ["none", "shaft"]


def test_paths_of_meshes_are_compared_by_where_they_lead(tmp_path):
    """Each run has them from its own folder."""
    (tmp_path / "deeper").mkdir()
    a = written(tmp_path / "a")
    b = written(tmp_path / "deeper" / "b", scene=SCENE.replace("../block", "../../block"))
    assert compared(a, b).scene_rows() == []
    c = written(tmp_path / "c", scene=SCENE.replace("../block", "../brick"))
    ((key, *files),) = compared(a, c).scene_rows()
    assert key == "mesh.file" and [name[-9:] for name in files] == ["block.geo", "brick.geo"]


def test_quantities_are_those_of_the_files(tmp_path):
    quantities = {"normal_force": 230.0, "reaction": [0.0, -230.0], "contact_area": 1.0}
    errors = {"normal_force": {"total": 6.0}, "reaction": {"total": 6.0}}
    model = {"dofs": 99, "ranks": 2}
    a = written(tmp_path / "a")
    b = written(tmp_path / "b", quantities=quantities, errors=errors, model=model)
    comparison = compared(a, b)
    found = rows(comparison)
    assert set(found) == {("whole model", "normal force"), ("whole model", "reaction")}
    force = found["whole model", "normal force"]
    assert force.values == ["200 ± 4", "230 ± 6"]
    (apart,) = force.differences
    assert (apart.words, apart.share, apart.bars) == ("30", "15 %", "3")
    (apart,) = found["whole model", "reaction"].differences
    assert apart.bars == "?"  # not known of the first
    assert comparison.headline(comparison.groups()) == (
        "1 quantity differs by more than the sum of both error bars; most of all normal force "
        "(whole model), by 3 error bars."
    )
    model = {name: values for name, *values in comparison.model_rows()}
    assert model == {"dofs": ["0", "99"], "ranks": ["1", "2"]}
    assert ("whole model", "contact area") in rows(compared(a, b, every=True))


def test_what_only_one_run_has_is_said(tmp_path):
    a = written(tmp_path / "a")
    b = written(tmp_path / "b", contacts=[CONTACT, CONTACT | {"name": "pin\n<b>"}])
    comparison = compared(a, b)
    assert "The contact 'pin\\n<b>' is only in 'b', not in 'a'." in comparison.notes()
    row = rows(comparison)["contact 'pin\\n<b>'", "normal force"]
    assert row.values == ["–", "200 ± 4"] and row.differences == [None]
    assert ("contact 'lug'", "normal force") not in rows(comparison)  # the same in both


def test_checks_that_failed_are_rows(tmp_path):
    check = {"value": 0.5, "limit": 1.0, "passed": True}
    failed = {"value": 2.0, "limit": 1.0, "passed": False, "kind": "", "place": []}
    a = written(tmp_path / "a", checks={"tension": check, "penetration": check})
    b = written(tmp_path / "b", checks={"tension": failed, "penetration": check}, passed=False)
    comparison = compared(a, b)
    assert comparison.check_rows() == [
        ["tension", "ok, 5.00e-01 of 1.00e+00", "FAILED, 2.00e+00 of 1.00e+00"]
    ]
    assert len(compared(a, b, every=True).check_rows()) == 2
    assert [run.outcome for run in comparison.runs] == [
        "converged, all 2 checks passed",
        "1 of 2 checks FAILED",
    ]


def test_other_kinematics_are_said(tmp_path):
    a, b = written(tmp_path / "a"), written(tmp_path / "b", model={"kinematics": "3D"})
    assert any("differ in their kinematics" in note for note in compared(a, b).notes())


def test_units_that_differ_are_refused_and_missing_ones_said(tmp_path):
    a, b = written(tmp_path / "a", units=UNITS), written(tmp_path / "b")
    assert any("numbers are taken to be in mm and N" in note for note in compared(a, b).notes())
    c = written(tmp_path / "c", units=UNITS | {"force": "kN"})
    with refused("compare_other_forces"):
        compared(a, b, c)
    d = written(tmp_path / "d", units=UNITS | {"per_unit_thickness": True})
    with refused("compare_other_stresses"):
        compared(a, d)


def test_what_is_no_run_is_refused(tmp_path):
    a = written(tmp_path / "a")
    damaged, sweep = tmp_path / "damaged", tmp_path / "sweep"
    damaged.mkdir()
    sweep.mkdir()
    (damaged / "result.json").write_text((a / "result.json").read_text()[:-20])
    (sweep / "sweep.json").write_text("{}")
    broken = written(tmp_path / "broken", scene="= no TOML")
    for folders, message in (
        ((a,), "compare_one_run"),
        ((a, tmp_path / "nowhere"), "result_cannot_be_read"),
        ((a, damaged), "result_is_cut"),
        ((a, sweep), "compare_a_sweep"),
        ((a, a / "result.json"), "compare_a_file"),
        ((a, tmp_path / "a" / ".." / "a"), "compare_a_run_twice"),
    ):
        with refused(message):
            read_runs(folders)
    with refused("compare_damaged_scene"):
        compared(a, broken).scene_rows()
