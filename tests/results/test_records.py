"""Every key of a run's ``result.json`` is a record's attribute, and is in the documentation."""

import json
from dataclasses import fields, replace

import pytest
from mpi4py import MPI

from fenics_contact import Run, SolverSettings
from fenics_contact.quantities import table
from fenics_contact.results.records.record import Record, meanings
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.reference import records, with_tables
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output import run_folder as files
from tests.records import made_run
from tests.scenes import ROOT, slab
from tests.simulation.output.test_run_folder import block, cycled

pytestmark = pytest.mark.serial
SOLVED = {
    "prescribed pressure": lambda: (slab(100), None),
    "load steps": lambda: (cycled(), block(MPI.COMM_SELF)),
    "in space": lambda: (cycled(kinematics="3D"), block(MPI.COMM_SELF, (2, 2, 1))),
    "not converged": lambda: (
        replace(cycled(), solver=SolverSettings(max_iterations=1)),
        block(MPI.COMM_SELF),
    ),
}


@pytest.mark.parametrize("name", SOLVED)
def test_every_key_that_is_written_is_in_the_record(name, tmp_path):
    """A reader that knew fewer keys, or other ones, would not give back the same file."""
    scene, body = SOLVED[name]()
    result = files.solve_and_write(Run(scene, MPI.COMM_SELF, body), tmp_path)
    written = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    read = read_result(tmp_path)
    assert json.dumps(read.as_dict()) == json.dumps(written)
    assert written["converged"] is (name != "not converged")
    assert read.passed is result.passed and dict(read) == written
    known = {one.name for one in table.every()}
    for step in read.steps:
        for found in (step, *step.contacts):
            assert {key for key in found.quantities if not key.startswith("displacement_")} <= known


@pytest.mark.parametrize("record", records())
def test_every_attribute_says_what_it_is(record):
    said = meanings(record)
    assert [one.name for one in fields(record) if not said.get(one.name, "").endswith(".")] == []


def test_tables_of_the_documentation_are_those_of_the_code():
    page = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    assert with_tables(page) == page  # else: python docs/make_results.py
    changed = page.replace("| `load_factor` |", "| `time` |")
    assert with_tables(changed) == page
    for record in records():
        assert all(f"| `{one.name}` |" in page for one in fields(record))
    assert all(f"| `{name}` |" in page for name in table.with_true_value())


def test_records_have_the_keys_of_their_file():
    contact = made_run({"contacts": [{"name": "top"}]}).contacts[0]
    assert contact["name"] == "top" == contact.name
    assert "slave" not in contact and contact.slave is None
    assert contact.get("errors", 1) == 1
    for unknown in ("slave", "carries_shear", "LEFT_OUT", "__iter__"):
        with pytest.raises(KeyError):
            contact[unknown]
    assert replace(contact, slave="top")["slave"] == "top"


def test_levels_are_written_where_an_accuracy_was_asked_for():
    assert not {"levels", "accuracy"} & made_run({}).keys()
    asked = made_run({"accuracy": {"asked": {"normal_force": 0.1}, "reached": False}})
    assert asked["levels"] == [] and asked["accuracy"]["asked"] == {"normal_force": 0.1}


def test_a_step_without_an_answer_has_only_how_far_it_came():
    steps = made_run({"steps": [{}, {"quantities": {"normal_force": 1.0}}]}).steps
    missing = steps[1].keys() - steps[0].keys()
    assert missing == {
        *("outer_contraction", "imbalance_limit", "contacts", "supports", "linear_range")
    }


def test_order_is_that_of_the_file():
    assert list(made_run({}))[:4] == ["title", "converged", "passed", "verdict"]
    assert issubclass(RunRecord, Record) and list(made_run({}))[-1] == "scene"
