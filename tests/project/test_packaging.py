"""What is installed without the repository."""

import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from tests.scenes import ROOT


@pytest.mark.serial
def test_wheel_has_types_templates_and_meshes(tmp_path: Path) -> None:
    """What `fenics-contact new` writes, and what tells type checkers that there are types."""
    pytest.importorskip("setuptools")
    project = tmp_path / "project"
    project.mkdir()
    for name in ("pyproject.toml", "setup.py", "README.md", "COPYING", "COPYING.LESSER"):
        shutil.copy(ROOT / name, project)
    compiled = shutil.ignore_patterns("__pycache__")
    for name in ("fenics_contact", "meshes"):
        shutil.copytree(ROOT / name, project / name, ignore=compiled)
    build = "from setuptools.build_meta import build_wheel; build_wheel('dist')"
    done = subprocess.run(
        [sys.executable, "-c", build], cwd=project, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    (wheel,) = (project / "dist").glob("*.whl")
    files = set(zipfile.ZipFile(wheel).namelist())
    sources = (ROOT / "fenics_contact").rglob("*.*")
    wanted = {path.relative_to(ROOT) for path in sources if path.suffix != ".pyc"}
    assert len(wanted) > 100 and "fenics_contact/py.typed" in files
    assert {path.as_posix() for path in wanted} <= files
    for geometry in (ROOT / "meshes").glob("*.geo"):
        assert f"fenics_contact/meshes/{geometry.name}" in files


def test_every_other_file_of_the_package_is_installed() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    data = settings["tool"]["setuptools"]["package-data"]
    files = {path for path in (ROOT / "fenics_contact").rglob("*.*") if path.is_file()}
    folders = {package: ROOT.joinpath(*package.split(".")) for package in data}
    kept = {
        path
        for package, patterns in data.items()
        for pattern in patterns
        for path in folders[package].glob(pattern)
    }
    assert {path.name for path in files - kept if path.suffix not in (".py", ".pyc")} == set()
