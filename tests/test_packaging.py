"""What is installed without the repository."""

import tomllib
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]


def test_every_package_is_installed() -> None:
    settings = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = settings["tool"]["setuptools"]["packages"]
    folders = {path.parent for path in (PROJECT / "fenics_contact").rglob("*.py")}
    found = {".".join(folder.relative_to(PROJECT).parts) for folder in folders}
    assert set(listed) - {"fenics_contact.meshes"} == found


def test_every_other_file_of_the_package_is_installed() -> None:
    settings = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = settings["tool"]["setuptools"]["package-data"]["fenics_contact"]
    files = {path for path in (PROJECT / "fenics_contact").rglob("*.*") if path.is_file()}
    kept = {path for pattern in patterns for path in (PROJECT / "fenics_contact").glob(pattern)}
    assert {path.name for path in files - kept if path.suffix not in (".py", ".pyc")} == set()
