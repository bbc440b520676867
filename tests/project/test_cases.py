"""The pages of benchmarks: words and numbers of each."""

import importlib.util
import json

import pytest
from mpi4py import MPI

from fenics_contact.verification import CASES
from tests.scenes import ROOT

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")


@pytest.fixture
def cases(tmp_path, monkeypatch):
    """The module ``docs/make_cases.py``, which writes into a folder of the test."""
    specification = importlib.util.spec_from_file_location(
        "make_cases", ROOT / "docs/make_cases.py"
    )
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    monkeypatch.setattr(module, "PAGES", tmp_path / "cases")
    return module


def test_each_case_has_a_page_with_its_numbers(cases):
    cases.make_all()
    rows = cases.measured()
    for case in CASES:
        text = (cases.PAGES / f"{case.name}.md").read_text()
        for row in rows[case.name]:
            assert f"{row['value']:.7g} | {row['reference']:.7g}" in text
        for mesh in rows[case.name][0]["meshes"]:
            assert mesh in text
    index = (cases.PAGES / "index.md").read_text()
    assert all(f"]({case.name}.md)" in index for case in CASES)


def test_all_numbers_are_within_what_is_allowed(cases):
    rows = [row for found in cases.measured().values() for row in found]
    assert rows and all(row["passed"] and row["error"] <= row["tolerance"] for row in rows)


def test_a_case_without_numbers_is_refused(cases, tmp_path, monkeypatch):
    """So is one without words: a new case is to have its page."""
    rows = [row for row in json.loads(cases.MEASURED.read_text()) if row["name"] != "hertz"]
    fewer = tmp_path / "measured.json"
    fewer.write_text(json.dumps(rows))
    monkeypatch.setattr(cases, "MEASURED", fewer)
    with pytest.raises(cases.CasesError, match=r"measured\.json and the cases differ: hertz"):
        cases.make_all()
