"""Files that come with the program: meshes, and scenes to start from."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent


def mesh_file(name: str) -> str:
    """Path of a mesh: inside the installed package, or in the repository around it."""
    installed = _PACKAGE / "meshes" / name
    return str(installed if installed.is_file() else _PACKAGE.parent / "meshes" / name)


def templates() -> dict[str, Path]:
    """Scenes to start from, by their names in alphabetical order."""
    return {path.stem: path for path in sorted((_PACKAGE / "cli" / "templates").glob("*.toml"))}
