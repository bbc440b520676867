"""Scenes to TOML: ``scene.toml`` of a run, from which the same run can be made again."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.items import Table

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.scene.given_keys import given_keys, key_of
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import Path as LoadPath
from fenics_contact.scene.values import Profile

SCENE_FILE = "scene.toml"
MADE_IN_PYTHON = "made in Python"

_HEAD = "# The scene as it was solved; keys that are not here have their defaults.\n"
_NOT_RUNNABLE = (
    f"# This file cannot be run: what was {MADE_IN_PYTHON} is not in it. Run that script again.\n"
)
_WIDTH = 96  # of a line; longer lists have a line an entry
_WHOLE = 1e15  # below it, floats that are whole numbers are written as these


def write_scene(scene: Scene, folder: Path, own_mesh: bool = False) -> str:
    """Write ``scene.toml`` into the folder of a run; one of the user's own is left as it is.

    That may say something else by now, so ``result.json`` keeps what was solved.

    Args:
        scene: What is solved; paths of its meshes are from the present folder.
        folder: Of the run, which is there.
        own_mesh: Whether the mesh was passed from Python, instead of the one the scene names.

    Returns:
        The text of the scene that is solved, with paths of meshes from the folder.

    Raises:
        MachineError: The file could not be written.
    """
    path, here = folder / SCENE_FILE, folder.resolve()
    text = text_beside(dataclasses.replace(scene, mesh=() if own_mesh else scene.mesh), here)
    if not _is_foreign(path):
        replace_file(path, text.encode())
    return text


def _is_foreign(path: Path) -> bool:
    """Whether there is a file that this module has not written."""
    return path.exists() and _HEAD not in path.read_text(encoding="utf-8", errors="replace")


def text_beside(scene: Scene, folder: Path) -> str:
    """A scene as TOML, for a file in a folder: the paths of its files are from there.

    Args:
        scene: The scene; paths of its files are from the present folder.
        folder: Where the file is to be.
    """
    return scene_text(scene.with_files(lambda file: _path_from(folder, file)))


def scene_text(scene: Scene) -> str:
    """A scene as TOML, without what has its default.

    ``load_scene`` makes the same scene of it, unless it has what TOML cannot hold: functions of
    Python, or a mesh that was passed from there. Of these the text says so, in its first line.
    """
    table = _table(scene)
    if not scene.mesh:
        table["mesh"] = _Foreign(MADE_IN_PYTHON)
    titled = {key: table[key] for key in sorted(table, key=lambda key: key != "title")}
    foreign = any(isinstance(text, _Foreign) for text in _texts(table))
    return f"{_NOT_RUNNABLE if foreign else ''}{_HEAD}\n{tomlkit.dumps(_item(titled))}"


def _path_from(folder: Path, file: str) -> str:
    """A file's path that works from a folder, wherever the two are moved together."""
    return os.path.relpath(Path(file).resolve(), folder)


def _table(part: Any) -> dict[str, Any]:
    """A part of a scene by keys, without those that have their defaults."""
    return {
        key_of(type(part), name): _plain(value, name) for name, value in given_keys(part).items()
    }


class _Inline(dict[str, Any]):
    """A table on one line."""


class _Foreign(str):
    """In place of what TOML cannot hold."""


def _plain(value: Any, key: str = "") -> Any:
    """A value of a scene in what TOML knows."""
    if isinstance(value, Profile | LoadPath):
        return _Inline(_table(value))
    if dataclasses.is_dataclass(value):
        return _table(value)
    if isinstance(value, Mapping):
        return _Inline({name: _plain(entry) for name, entry in value.items()})
    if isinstance(value, tuple):
        single = key in ("material", "mesh") and len(value) == 1
        return _plain(value[0]) if single else [_plain(entry) for entry in value]
    if callable(value):
        return _Foreign(f"{getattr(value, '__name__', 'a function')}, {MADE_IN_PYTHON}")
    if isinstance(value, float) and value.is_integer() and abs(value) < _WHOLE:
        return int(value)
    return value


def _texts(value: object) -> Iterator[str]:
    """All texts in a table."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list):
        for entry in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(entry)


def _item(value: Any) -> Any:
    """Return a value as an item of tomlkit, which gives tables headers."""
    if isinstance(value, _Inline):
        inline = tomlkit.inline_table()
        inline.update({key: _item(entry) for key, entry in value.items()})
        return inline
    if isinstance(value, dict):
        return tomlkit.item({key: _item(entry) for key, entry in value.items()})
    if not isinstance(value, list):
        # what UTF-8 cannot hold is a question mark
        return value.encode("utf-8", "replace").decode() if isinstance(value, str) else value
    items = [_item(entry) for entry in value]
    if items and all(isinstance(item, Table) for item in items):
        return tomlkit.item(items)
    array = tomlkit.array()
    array.extend(items)
    return array.multiline(len(array.as_string()) > _WIDTH)
