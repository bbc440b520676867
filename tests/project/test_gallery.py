"""When the documentation's demos are run again."""

import importlib.util

import pytest
from mpi4py import MPI

from fenics_contact.verification.case import Finding
from tests.scenes import ROOT

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")


@pytest.fixture
def gallery(tmp_path, monkeypatch):
    """The module ``docs/make_gallery.py``, of a repository with a package of three files."""
    source = ROOT / "docs/make_gallery.py"
    specification = importlib.util.spec_from_file_location("make_gallery", source)
    module = importlib.util.module_from_spec(specification)
    monkeypatch.syspath_prepend(source.parent)
    specification.loader.exec_module(module)
    monkeypatch.setattr(module, "ROOT", tmp_path)
    for name in ("__init__.py", "report.css", "templates/slab.toml"):
        path = tmp_path / "fenics_contact" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text("1")
    return module


@pytest.mark.parametrize("name", ["__init__.py", "report.css", "templates/slab.toml"])
def test_every_file_of_the_package_counts(gallery, name):
    """The page's style and script, too: reports are made anew when they change."""
    before = gallery.fingerprint([])
    assert gallery.fingerprint([]) == before
    (gallery.ROOT / "fenics_contact" / name).write_text("2")
    assert gallery.fingerprint([]) != before


def test_what_python_makes_does_not_count(gallery):
    before = gallery.fingerprint([])
    made = gallery.ROOT / "fenics_contact/__pycache__/x.pyc"
    made.parent.mkdir()
    made.write_bytes(b"1")
    assert gallery.fingerprint([]) == before


def test_numbers_have_the_figures_that_their_bars_leave(gallery):
    findings = [
        Finding("normal force", 4246.48, 4244.13, 0.01, bar=4.66),
        Finding("friction work", 12.0301, 12.0, 0.01, bar=None),
        Finding("reaction", 2400.0, 2400.0, 0.01, bar=1e-12),
    ]
    rows = gallery._table(findings, "demos/slab.toml").splitlines()[2:]
    assert [[cell.strip() for cell in row.split("|")[1:-1]] for row in rows] == [
        ["normal force", "4244.13", "4246", "0.055 %", "± 5"],
        ["friction work", "12", "12.0301", "0.25 %", "?"],
        ["reaction", "2400", "2400", "0 %", ""],
    ]
