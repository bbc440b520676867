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
