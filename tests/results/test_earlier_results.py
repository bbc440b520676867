"""Folders of before quantities had today's meaning: read, shown and gone on from."""

import csv
import json
import shutil

import pytest
from mpi4py import MPI

from fenics_contact import main
from fenics_contact.common.parallel import on_root
from fenics_contact.report.histories.load_steps import draw_forces
from fenics_contact.report.report import write_report
from fenics_contact.results.earlier_results import result_in_todays_terms
from fenics_contact.results.load_history import History
from fenics_contact.results.result_file import read_result
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
BEFORE = ROOT / "tests" / "data" / "written_before"
NOT_KNOWN = ("pressure_integral", "contact_force", "max_slip")


@pytest.fixture
def folder(tmp_path):
    """A copy: two blocks on a floor, shoved; in the upper contact `against` is the slave."""
    place = on_root(COMM, lambda: tmp_path / "copy")
    on_root(COMM, lambda: shutil.copytree(BEFORE, place))
    return place


def test_what_was_written_is_read_in_todays_terms():
    written = json.loads((BEFORE / "run" / "result.json").read_text(encoding="utf-8"))
    result = read_result(BEFORE / "run")
    for number, contact in enumerate(result["contacts"]):
        was, found = written["contacts"][number]["quantities"], contact["quantities"]
        assert all(found[name] is None for name in NOT_KNOWN)
        assert not {"max_slip"} & contact["errors"].keys()
        assert found["normal_force"] == was["normal_force"]
        sign = -1 if number == 1 else 1  # its slave is `against`
        assert found["friction_force"] == [sign * x for x in was["friction_force"]]
        last = result["steps"][-1]["contacts"][number]["quantities"]
        assert last["friction_force"] == found["friction_force"]
    # what the floor carries, the upper block hands on: now of one sign
    forces = [contact["quantities"]["friction_force"][0] for contact in result["contacts"]]
    assert forces[1] == pytest.approx(forces[0], rel=1e-6)
    assert -result["quantities"]["reaction"][0] == pytest.approx(forces[0], rel=1e-6)
    for quantities in (result["quantities"], result["steps"][-1]["quantities"]):
        names = ("normal_force", "friction_force", *NOT_KNOWN)
        assert all(quantities[name] is None for name in names)
        assert quantities["contact_area"] == written["quantities"]["contact_area"]
    assert "friction_force" not in result["errors"]


def test_whose_force_it_is_may_not_be_known():
    """Of a scene that a script made there may be no file."""
    written = json.loads((BEFORE / "run" / "result.json").read_text(encoding="utf-8"))
    result = result_in_todays_terms(written | {"scene": "# This file cannot be run: [["})
    forces = [contact["quantities"]["friction_force"] for contact in result["contacts"]]
    assert forces[0] is not None
    assert forces[1] is None


def test_todays_results_are_left_alone():
    written = json.loads((BEFORE / "run" / "result.json").read_text(encoding="utf-8"))
    result = result_in_todays_terms(written)
    assert result_in_todays_terms(result) == result


@pytest.mark.serial
def test_a_report_says_what_is_not_known(folder):
    (folder / "run" / "fields.pvd").unlink()  # pictures of fields take long
    write_report(folder / "run")
    page = (folder / "run" / "report.html").read_text(encoding="utf-8")
    for words in ("pressure integral", "contact force", "max slip"):
        assert f'<th scope="row">{words}</th><td>not known</td>' in page
    result = read_result(folder / "run")
    picture = draw_forces(History.of(result), result.contacts, folder / "forces.png")
    assert "normal force" in picture.caption.lower()


def test_a_run_goes_on(folder):
    """Its steps are in the table, with empty cells for what is not known of them."""
    scene, out = str(folder / "stack.toml"), folder / "run"
    more = ["--set", "steps.times=[0.5, 1, 1.5, 2]"]
    assert main(["run", scene, "--out", str(out), "--resume", "--quiet", *more]) == 0
    result = read_result(out)
    rows = list(csv.DictReader((out / "steps.csv").read_text(encoding="utf-8").splitlines()))
    assert len(result["steps"]) == len(rows) == 4
    for name in ("lower.bottom", "upper.bottom"):
        known = [row[f"{name}.pressure_integral"] != "" for row in rows]
        assert known == [False, False, False, True]
        force = [float(row[f"{name}.friction_force_x"]) for row in rows]
        assert force[3] < force[2] < 0  # shoved on, and of the same sign as before
    for contact in result["contacts"]:
        assert contact["quantities"]["contact_force"][0] == pytest.approx(
            -result["quantities"]["reaction"][0], rel=1e-6
        )
