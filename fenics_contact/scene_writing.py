"""Scenes to TOML: ``scene.toml`` of a run, from which the same run can be made again."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic.fields import FieldInfo

from fenics_contact.errors import InputError
from fenics_contact.scene import Scene
from fenics_contact.scene_file import load_scene
from fenics_contact.scene_values import Path as LoadPath
from fenics_contact.scene_values import Profile
from fenics_contact.writing import replace_file

SCENE_FILE = "scene.toml"
MADE_IN_PYTHON = "made in Python"

_HEAD = "# The scene as it was solved; keys that are not here have their defaults.\n"
_NOT_RUNNABLE = (
    f"# This file cannot be run: what was {MADE_IN_PYTHON} is not in it. Run that script again.\n"
)
_WIDTH = 96  # of a line; longer lists have a line an entry
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}
_WHOLE = 1e15  # below it, floats that are whole numbers are written as these


def write_scene(scene: Scene, folder: Path, own_mesh: bool = False) -> None:
    """Write ``scene.toml`` into the folder of a run; one of the user's own is left as it is.

    Args:
        scene: What is solved; paths of its meshes are from the present folder.
        folder: Of the run, which is there.
        own_mesh: Whether the mesh was passed from Python, instead of the one the scene names.

    Raises:
        InputError: A file of the user's is there, and another scene.
        MachineError: The file could not be written.
    """
    path, here = folder / SCENE_FILE, folder.resolve()
    text = _text_beside(dataclasses.replace(scene, mesh=() if own_mesh else scene.mesh), here)
    if not _is_foreign(path):
        replace_file(path, text.encode())
    elif not _says(path, text):
        raise InputError(
            f"'{path}' is not of an earlier run, and another scene than this one: it would be "
            "lost, so give another --out"
        )


def _is_foreign(path: Path) -> bool:
    """Whether there is a file that this module has not written."""
    return path.exists() and _HEAD not in path.read_text(encoding="utf-8", errors="replace")


def _says(path: Path, text: str) -> bool:
    """Whether a scene file says the same."""
    try:
        return _text_beside(load_scene(path), path.parent.resolve()) == text
    except InputError:
        return False


def _text_beside(scene: Scene, folder: Path) -> str:
    """A scene as TOML, for a file in a folder: the paths of its meshes are from there."""
    meshes = tuple(dataclasses.replace(m, file=_path_from(folder, m.file)) for m in scene.mesh)
    return scene_text(dataclasses.replace(scene, mesh=meshes))


def scene_text(scene: Scene) -> str:
    """A scene as TOML, without what has its default.

    ``load_scene`` makes the same scene of it, unless it has what TOML cannot hold: functions of
    Python, or a mesh that was passed from there. Of these the text says so, in its first line.
    """
    table = _table(scene)
    if not scene.mesh:
        table["mesh"] = _Foreign(MADE_IN_PYTHON)
    titled = {key: table[key] for key in sorted(table, key=lambda key: key != "title")}
    lines = "\n".join(_written(titled, ()))
    foreign = any(isinstance(text, _Foreign) for text in _texts(table))
    return f"{_NOT_RUNNABLE if foreign else ''}{_HEAD}\n{lines}\n"


def _path_from(folder: Path, file: str) -> str:
    """A file's path that works from a folder, wherever the two are moved together."""
    return os.path.relpath(Path(file).resolve(), folder)


def _table(part: Any) -> dict[str, Any]:
    """A part of a scene by keys, without those that have their defaults."""
    found = {}
    for field in dataclasses.fields(part):
        value = getattr(part, field.name)
        if value != _default(field):
            found[field.name] = _plain(value, field.name)
    return found


def _default(field: dataclasses.Field[Any]) -> Any:
    default: Any = field.default
    factory: Any = field.default_factory
    if isinstance(default, FieldInfo):  # pydantic's own way to say it
        factory = default.default_factory
    return default if factory in (None, dataclasses.MISSING) else factory()


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
    return value


def _texts(value: Any) -> Iterator[str]:
    """All texts in a table."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list):
        for entry in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(entry)


def _written(table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    """The lines of a table: its values first, as TOML wants it, then the tables in it."""
    tables = {key: value for key, value in table.items() if _has_header(value)}
    for key, value in table.items():
        if key not in tables:
            yield from _line(f"{_key(key)} = ", value)
    for key, value in tables.items():
        inner = (*path, key)
        name = ".".join(map(_key, inner))
        for entry in value if isinstance(value, list) else [value]:
            yield ""
            yield f"[[{name}]]" if isinstance(value, list) else f"[{name}]"
            yield from _written(entry, inner)


def _has_header(value: Any) -> bool:
    if isinstance(value, list):
        return bool(value) and all(map(_has_header, value))
    return isinstance(value, dict) and not isinstance(value, _Inline)


def _line(start: str, value: Any) -> Iterator[str]:
    line = start + _value(value)
    if len(line) <= _WIDTH or not isinstance(value, list):
        yield line
        return
    yield f"{start}["
    yield from (f"    {_value(entry)}," for entry in value)
    yield "]"


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        is_whole = value.is_integer() and abs(value) < _WHOLE
        return str(int(value)) if is_whole else float.__repr__(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        pairs = ", ".join(f"{_key(key)} = {_value(entry)}" for key, entry in value.items())
        return f"{{ {pairs} }}" if pairs else "{}"
    return _text(value) if isinstance(value, str) else str(value)


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else _text(name)


def _text(text: str) -> str:
    """In quotes; what a line cannot hold is escaped, and what UTF-8 cannot is a question mark."""
    text = text.encode("utf-8", "replace").decode("utf-8")
    return f'"{"".join(_ESCAPES.get(sign) or _unseen(sign) for sign in text)}"'


def _unseen(sign: str) -> str:
    return f"\\u{ord(sign):04x}" if ord(sign) < 0x20 or ord(sign) == 0x7F else sign
