"""The runs that are compared, from their folders, and how their scenes differ."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import one_line
from fenics_contact.results.records.record import UnitsRecord
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.result import read_result
from fenics_contact.scene.reference import keys_of
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.writing import MADE_IN_PYTHON

_SWEEP = ("sweep.json", "sweep.csv")


@dataclass(frozen=True)
class ComparedRun:
    """A run with its name in a comparison.

    Attributes:
        name: Of its folder; the folder's path where several have this name.
        folder: Where its files are.
        result: The content of its ``result.json``.
    """

    name: str
    folder: Path
    result: RunRecord

    @property
    def outcome(self) -> str:
        """In a few words what came out."""
        checks = self.result.checks.values()
        failed = sum(not check.passed for check in checks)
        if not self.result.converged:
            return "not converged"
        if failed:
            return f"{failed} of {len(checks)} checks FAILED"
        words = f"converged, all {len(checks)} checks passed"
        return words if self.result.passed else f"{words}, but not as accurate as was asked for"


def read_runs(folders: Sequence[Path]) -> list[ComparedRun]:
    """The runs of some folders, in their order.

    Args:
        folders: Two or more.

    Raises:
        InputError: There are fewer, one is none of a run or is given twice, or the numbers of two
            runs are in different units.
    """
    if len(folders) < 2:
        raise InputError("compare: takes the folders of two runs or more")
    places = [folder.resolve() for folder in folders]
    for number, place in enumerate(places):
        if place in places[:number]:
            raise InputError(f"compare: the folder '{folders[number]}' is given twice")
    names = [place.name for place in places]
    named = [
        str(folder) if names.count(place.name) > 1 else place.name
        for folder, place in zip(folders, places, strict=True)
    ]
    runs = [
        ComparedRun(one_line(name), folder, _read(folder))
        for name, folder in zip(named, folders, strict=True)
    ]
    _require_same_units(runs)
    return runs


def _read(folder: Path) -> RunRecord:
    if folder.is_file():
        raise InputError(f"{folder}: is a file; compare takes the folders of runs")
    if not (folder / "result.json").exists() and any((folder / name).exists() for name in _SWEEP):
        raise InputError(
            f"{folder}: is the folder of a sweep, whose runs are side by side in its sweep.html; "
            "compare takes the folders of runs"
        )
    return read_result(folder)


def _require_same_units(runs: list[ComparedRun]) -> None:
    """Refuse numbers of different units; those of a run that says none are taken as the others'."""
    said = {run.name: _words(run.result.units) for run in runs if run.result.units is not None}
    for name, words in said.items():
        first, expected = next(iter(said.items()))
        if words != expected:
            raise InputError(
                f"compare: numbers of '{first}' are in {expected}, those of '{name}' in {words}: "
                "give both scenes the same [units], and run one of them again"
            )


def _words(units: UnitsRecord) -> str:
    return f"{units.of('length')} and {units.of('force')}"


def units_of(runs: Sequence[ComparedRun]) -> UnitsRecord | None:
    """Return the units of all numbers, if any run has units.

    Args:
        runs: That are compared.
    """
    return next((run.result.units for run in runs if run.result.units is not None), None)


#: In place of a value, where a scene has neither the key nor a default for it.
NONE = "none"
_MISSING = object()
_LONGEST = 60  # letters of a value


def scene_rows(runs: Sequence[ComparedRun], every: bool = False) -> list[list[str]]:
    """Key and its value in each run; those that differ.

    Args:
        runs: That are compared.
        every: Whether keys that do not differ are rows as well.

    Raises:
        InputError: The scene that a run keeps is damaged.
    """
    scenes = [_scene(run) for run in runs]
    rows = []
    for path, values in _leaves(scenes, ()):
        words = [_written(value, scene, path) for value, scene in zip(values, scenes, strict=True)]
        if every or len(set(words)) > 1:
            rows.append([_key(path), *map(_short, words)])
    return rows


def is_made_in_python(runs: Sequence[ComparedRun]) -> bool:
    """Whether a scene has what its text does not tell, such as a function of Python.

    Args:
        runs: That are compared.
    """
    return any(MADE_IN_PYTHON in run.result.scene for run in runs)


def _scene(run: ComparedRun) -> dict[str, Any]:
    """Return a run's scene as tables, with paths of meshes from the present folder."""
    try:
        scene = tomllib.loads(run.result.scene)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{run.folder / 'result.json'}: damaged: its scene: {error}") from None
    meshes = scene.get("mesh", {})
    for mesh in meshes if isinstance(meshes, list) else [meshes]:
        if isinstance(mesh, dict) and isinstance(mesh.get("file"), str):
            mesh["file"] = os.path.relpath((run.folder / mesh["file"]).resolve())
    return scene


def _leaves(
    values: list[Any], path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], list[Any]]]:
    """Paths of keys and their values in each scene, tables and lists of tables taken apart."""
    values = _alike(values)
    there = [value for value in values if value is not _MISSING]
    if all(isinstance(value, dict) for value in there):
        for key in dict.fromkeys(key for value in there for key in value):
            inner = [
                value.get(key, _MISSING) if value is not _MISSING else value for value in values
            ]
            yield from _leaves(inner, (*path, key))
    elif all(_is_tables(value) for value in there):
        for number in range(max(map(len, there))):
            inner = [
                value[number] if value is not _MISSING and number < len(value) else _MISSING
                for value in values
            ]
            yield from _leaves(inner, (*path, str(number)))
    else:
        yield path, values


def _alike(values: list[Any]) -> list[Any]:
    """Return values with single tables as lists, where others are lists, as ``[[mesh]]``."""
    if any(_is_tables(value) for value in values):
        return [[value] if isinstance(value, dict) else value for value in values]
    return values


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(x, dict) for x in value)


def _key(path: tuple[str, ...]) -> str:
    """Return a key as for ``--set``; names with dots are in quotes."""
    return one_line(".".join(f'"{name}"' if "." in name else name for name in path))


def _written(value: Any, scene: dict[str, Any], path: tuple[str, ...]) -> str:
    """A value as a scene has it; where the key is missing its default."""
    if value is not _MISSING:
        return _toml(value)
    default = _default(scene, path)
    return NONE if default in (None, (), "", _MISSING) else f"{_toml(default)} (default)"


def _default(scene: dict[str, Any], path: tuple[str, ...]) -> Any:
    """Return the default of a key that a scene leaves out; missing inside a missing table."""
    tables: list[type] = [Scene]
    value: Any = scene
    for name in path:
        if isinstance(value, list):
            if not name.isdigit() or int(name) >= len(value):
                return _MISSING
            value = value[int(name)]
            continue
        if isinstance(value, Mapping) and name in value:
            value = value[name]
        elif isinstance(value, Mapping):
            value = _of_class(tables, name)
        else:
            value = getattr(value, name, _MISSING)
        keys = [key for table in tables for key in keys_of(table) if key.name == name]
        tables = [table for key in keys for table in key.tables]
    return value


def _of_class(tables: list[type], name: str) -> Any:
    """The default of a key of one of some classes."""
    for table in tables:
        field = table.__pydantic_fields__.get(name)  # type: ignore[attr-defined]
        if field is not None and not field.is_required():
            return field.get_default(call_default_factory=True)
    return _MISSING


def _toml(value: Any) -> str:
    """Return a value as TOML on one line, with numbers in the fewest figures."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.12g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key} = {_toml(part)}' for key, part in value.items())} }}"
    return one_line(str(value))


def _short(words: str) -> str:
    """Begin and end of a long one: two that differ may begin alike."""
    half = _LONGEST // 2
    return words if len(words) <= _LONGEST else f"{words[:half]}…{words[1 - half :]}"
