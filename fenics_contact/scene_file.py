"""Scene files: TOML to the frozen dataclasses of ``fenics_contact.scene``."""

from __future__ import annotations

import dataclasses
import difflib
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from fenics_contact.errors import InputError
from fenics_contact.scene import Scene
from fenics_contact.scene_reference import keys_of
from fenics_contact.scene_values import Profile

_SMALLEST, _LARGEST = 1e-100, 1e100  # sizes of numbers that a scene may hold


def load_scene(path: str | Path, overrides: Sequence[str] = ()) -> Scene:
    """Read a scene file.

    Args:
        path: TOML file; relative mesh files in it are sought beside it.
        overrides: ``table.key=value`` settings that replace those of the file;
            entries of a list are counted from 0 (``contact.0.pressure=200``).

    Raises:
        InputError: Naming the file, the key, the value and what is accepted.
    """
    path = Path(path)
    data = _read(path)
    for setting in overrides:
        _override(data, setting)
    _refuse_extremes(data, path)
    if data.get("mesh", []) == []:
        raise InputError(f"{path}: the table [mesh] is missing; it names the mesh's file")
    try:
        scene = TypeAdapter(Scene).validate_python(data)
    except ValidationError as error:
        raise InputError(f"{path}: {_sentence(error, data)}") from None
    return _beside(scene, path.parent)


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file in UTF-8") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError) as error:  # thousands of digits, or of brackets
        raise InputError(f"{path}: cannot be read: {error}") from None


def _refuse_extremes(data: Any, file: Path, path: tuple[Any, ...] = ()) -> None:
    """Numbers whose squares or products would overflow are slips of the pen."""
    if isinstance(data, dict | list):
        for step, part in data.items() if isinstance(data, dict) else enumerate(data):
            _refuse_extremes(part, file, (*path, step))
    elif isinstance(data, int | float) and data != 0 and not _SMALLEST < abs(data) < _LARGEST:
        raise InputError(
            f"{file}: {_written(path)} = {str(data)[:20]}: must be a finite number, and 0 or of "
            f"a size between {_SMALLEST:g} and {_LARGEST:g}"
        )


def _beside(scene: Scene, folder: Path) -> Scene:
    """The scene with its mesh files' paths taken from the scene file's folder."""
    meshes = [dataclasses.replace(mesh, file=str(folder / mesh.file)) for mesh in scene.mesh]
    return dataclasses.replace(scene, mesh=tuple(meshes))


def _override(data: dict[str, Any], setting: str) -> None:
    """Replace or add one value, such as ``solver.tolerance=1e-8``."""
    path, equals, text = setting.partition("=")
    if not equals or not path.strip():
        raise InputError(f"--set {setting}: write it as table.key=value")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        value = text.strip()  # a bare word is a string
    *tables, key = path.strip().split(".")
    target: Any = data
    for name in tables:
        if isinstance(target, list):
            target = _entry(target, name, setting)
        elif isinstance(target, dict):
            target = target.setdefault(name, {})
        else:
            raise InputError(f"--set {setting}: '{name}' is not a table of the scene")
    if isinstance(target, list):
        _entry(target, key, setting)
        target[int(key)] = value
    elif isinstance(target, dict):
        target[key] = value
    else:
        raise InputError(f"--set {setting}: '{path.strip()}' is not a key of the scene")


def _entry(entries: list[Any], name: str, setting: str) -> Any:
    if not (name.isascii() and name.isdigit()) or int(name) >= len(entries):
        raise InputError(f"--set {setting}: '{name}' must be a number from 0 to {len(entries) - 1}")
    return entries[int(name)]


def _sentence(error: ValidationError, data: dict[str, Any]) -> str:
    """What is wrong first, in one sentence: key, value, what is accepted."""
    every = error.errors(include_url=False)
    problems = [p for p in every if not _beside_the_point(p)] or every
    unknown = [p for p in problems if p["type"] == "unexpected_keyword_argument"]
    first = (unknown or problems)[0]
    path = _known_path(first["loc"], data)
    key = _written(path)
    if unknown:
        return f"unknown key '{key}'{_suggestion(str(first['loc'][-1]), first['loc'][:-1])}"
    # A value of several possible types fails once for each: say them together.
    value = _value_at(path, data)
    same = [p for p in problems if _known_path(p["loc"], data) == path]
    if same[0]["type"] == "missing":
        return f"the key '{_written([*path, same[0]['loc'][-1]])}' is missing"
    messages = " or ".join(dict.fromkeys(_plain(problem) for problem in same))
    if same[0]["type"] == "value_error":
        return f"{key}: {messages}" if key else messages
    return f"{key} = {value!r}: must be {messages}"


def _beside_the_point(problem: Any) -> bool:
    """No function fits in a file, and a table is not a failed number."""
    is_table = isinstance(problem["input"], dict)
    return problem["type"] == "callable_type" or (problem["type"] == "float_type" and is_table)


def _plain(problem: Any) -> str:
    """Pydantic's message in this project's words, to follow 'must be'."""
    words = {
        "float_type": "a number",
        "int_type": "a whole number",
        "bool_type": "true or false",
        "string_type": "a text, in quotes",
        "finite_number": "a finite number",
        "dataclass_type": "a table",
        "tuple_type": "a list",
        "mapping_type": "a table",
        "none_required": "left out",
    }
    if problem["type"] in ("too_short", "too_long"):
        limit, number = next(item for item in problem["ctx"].items() if item[0].endswith("_length"))
        return f"of {'at least' if limit.startswith('min') else 'at most'} {number} entries"
    message = words.get(problem["type"], problem["msg"])
    for prefix in ("Value error, ", "Input should be "):
        message = message.removeprefix(prefix)
    return message


def _value_at(path: Sequence[Any], data: Any) -> Any:
    for step in path:
        data = data[step]
    return data


def _known_path(location: tuple[Any, ...], data: Any) -> list[Any]:
    """The part of pydantic's location that exists in the user's data."""
    path: list[Any] = []
    for step in location:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            continue  # the name of a type that was tried, or a missing key
        path.append(step)
    return path


def _written(path: Sequence[Any]) -> str:
    """A location as users write it: ``contact[0].pressure``."""
    text = ""
    for step in path:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else str(step)
    return text


def _suggestion(key: str, location: tuple[Any, ...]) -> str:
    """The keys accepted at a location, the nearest first."""
    table: type = Scene
    for step in location:
        table = next((k.table for k in keys_of(table) if k.name == step and k.table), table)
        table = Profile if step == Profile.__name__ else table
    accepted = [known.name for known in keys_of(table)]
    near = difflib.get_close_matches(key, accepted, n=1)
    hint = f" (did you mean '{near[0]}'?)" if near else ""
    return f"{hint}; accepted here: {', '.join(accepted)}"
