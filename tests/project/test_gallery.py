"""When the documentation's demos are run again."""

import importlib.util

import pytest
from mpi4py import MPI

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
