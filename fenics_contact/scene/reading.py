"""Scene files: TOML to the frozen dataclasses of ``fenics_contact.scene.scene``."""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, get_type_hints

from pydantic import TypeAdapter, ValidationError

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import nearest_file
from fenics_contact.scene.messages import sentence, written
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import as_list

_SMALLEST, _LARGEST = 1e-100, 1e100  # sizes of numbers that a scene may hold
_DEEPEST = 20  # tables and lists within each other; a scene has half as many
# A point without a digit on one of its sides, outside of quotes.
_POINT = re.compile(
    r"""(?P<quoted>"(?:[^"\\]|\\.)*"|'[^']*')"""
    r"""|(?<![\w.])\.(?=\d)|(?P<last>(?<=\d)\.(?=[eE\s,\]}]|$))"""
)
_LONGEST = 2**26  # bytes of a scene file, which may be one without an end


def load_scene(path: str | Path, overrides: Sequence[str] = ()) -> Scene:
    """Read a scene file.

    Args:
        path: TOML file; relative mesh files in it are sought beside it.
        overrides: ``table.key=value`` settings that replace those of the file;
            entries of a list are counted from 0 (``contact.0.pressure=200``).

    Returns:
        The scene, with paths of meshes that begin at the file's folder.

    Raises:
        InputError: Naming the file, the key, the value and what is accepted.

    >>> from fenics_contact import main
    >>> main(["new", "slab", "--quiet"])  # writes slab.toml and slab.geo
    0
    >>> load_scene("slab.toml", ["contact.0.pressure=200"]).contact[0].pressure
    200.0
    >>> load_scene("nowhere.toml")
    Traceback (most recent call last):
    fenics_contact.common.errors.InputError: nowhere.toml: cannot be read: No such file or directory
    """
    return SceneFile(Path(path)).scene(overrides)


class SceneFile:
    """The text of a scene file, read once, of which scenes with other values are made.

    Attributes:
        path: Of the file.

    Args:
        path: TOML file.

    Raises:
        InputError: It cannot be read, is no TOML, or holds numbers or tables beyond all measure.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._data = _parsed(_read(path), path)
        _refuse_extremes(self._data, path)  # tables too deep cannot be copied

    def data(self, overrides: Sequence[str], varied: Sequence[str] = ()) -> dict[str, Any]:
        """Return the file's tables, with other values.

        Args:
            overrides: As of ``load_scene``.
            varied: Likewise, of ``--vary``; they come last.

        Raises:
            InputError: A setting names no table or entry of it.
        """
        data = copy.deepcopy(self._data)
        for setting in overrides:
            _override(data, setting, "--set")
        for setting in varied:
            _override(data, setting, "--vary")
        return data

    def scene(self, overrides: Sequence[str], varied: Sequence[str] = ()) -> Scene:
        """The scene with other values, with paths of meshes that begin at the file's folder.

        Args:
            overrides: As of ``load_scene``.
            varied: As of ``data``.

        Raises:
            InputError: As ``load_scene``.
        """
        path = self.path
        data = self.data(overrides, varied)
        try:
            scene = _scene(data, path)
        except InputError as error:
            if not overrides and not varied:
                raise
            _scene(self._data, path)  # what is wrong with the file itself comes first
            settings = [*(f"--set {one}" for one in overrides), *(f"--vary {v}" for v in varied)]
            said = str(error).removeprefix(f"{path}: ")
            raise InputError(f"{path} with {' '.join(settings)}: {said}") from None
        return _beside(scene, path.parent)


def scene_of_text(text: str, path: Path) -> Scene:
    """A scene of the text of a scene file; paths of its meshes are as they stand there.

    Args:
        text: TOML.
        path: What messages say that it is from.

    Raises:
        InputError: As ``load_scene``.
    """
    return _scene(_parsed(text, path), path)


def _scene(data: dict[str, Any], path: Path) -> Scene:
    _refuse_extremes(data, path)
    if data.get("mesh", []) == []:
        raise InputError(f"{path}: the table [mesh] is missing; it names the mesh's file")
    try:
        return TypeAdapter(Scene).validate_python(data)
    except ValidationError as error:
        raise InputError(f"{path}: {sentence(error, data, Scene)}") from None


def _read(path: Path) -> str:
    try:
        with path.open("rb") as file:
            content = file.read(_LONGEST + 1)
    except (OSError, ValueError) as error:  # a name with a null byte
        said = error.strerror if isinstance(error, OSError) else error
        near = nearest_file(path) if isinstance(error, FileNotFoundError) else ""
        raise InputError(f"{path}: cannot be read: {said}{near}") from None
    if len(content) > _LONGEST:
        raise InputError(f"{path}: cannot be read: it has more than {_LONGEST >> 20} MB")
    try:
        text = content.decode("utf-8-sig")  # Windows may put a mark in front
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: {_of_encoding(content, error.start)}") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _of_encoding(content: bytes, place: int) -> str:
    """Return in words which encoding a file has that is no UTF-8, as far as can be told."""
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "not a text file in UTF-8, but in UTF-16; save it as UTF-8 in the editor"
    line = content.count(b"\n", 0, place) + 1
    letter = content[place : place + 1].decode("cp1252", "replace")
    return (
        f"not a text file in UTF-8: line {line} has a character of another encoding "
        f"('{letter}' in that of Windows); save it as UTF-8 in the editor"
    )


def _parsed(text: str, path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        from fenics_contact.scene.messages.toml_slips import what_is_wrong

        raise InputError(f"{path}: not valid TOML: {what_is_wrong(text, error)}") from None
    except (ValueError, RecursionError) as error:  # thousands of digits, or of brackets
        raise InputError(f"{path}: cannot be read: {error}") from None


def _refuse_extremes(data: object, file: Path, path: tuple[object, ...] = ()) -> None:
    """Numbers whose squares or products would overflow are slips of the pen."""
    if len(path) > _DEEPEST:
        raise InputError(f"{file}: {written(path)[:60]}…: tables within tables, too many")
    if isinstance(data, dict | list):
        for step, part in data.items() if isinstance(data, dict) else enumerate(data):
            _refuse_extremes(part, file, (*path, step))
    elif isinstance(data, int | float) and data != 0 and not _SMALLEST < abs(data) < _LARGEST:
        raise InputError(
            f"{file}: {written(path)} = {_in_short(data)}: must be a finite number, and 0 or of "
            f"a size between {_SMALLEST:g} and {_LARGEST:g}"
        )


def _in_short(number: float) -> str:
    """A number of however many digits: Python writes out a few thousand at the most."""
    is_long = isinstance(number, int) and number.bit_length() > 10000
    return (hex(int(number)) if is_long else str(number))[:20]


def _beside(scene: Scene, folder: Path) -> Scene:
    """The scene with its files' paths taken from the scene file's folder."""
    return scene.with_files(lambda file: str(folder / file))


def _override(data: dict[str, Any], setting: str, option: str) -> None:
    """Replace or add one value, such as ``solver.tolerance=1e-8``, as an option asks for it."""
    path, equals, text = setting.partition("=")
    if not equals or not path.strip():
        raise InputError(f"{option} {setting}: write it as table.key=value")
    value = value_of(text)
    if numbered := re.search(r"\[\d+\]", path):
        dotted = re.sub(r"\[(\d+)\]", r".\1", path.strip())
        raise InputError(f"{option} {setting}: write {numbered[0]} with a dot, as in {dotted}")
    try:
        *tables, key = keys_of(path)
    except ValueError:
        raise InputError(f"{option} {setting}: write it as table.key=value") from None
    target: Any = data
    for number, name in enumerate(tables):
        if number == 1 and name == "0" and isinstance(target, dict) and tables[0] in _lists():
            continue  # the only one, whose table stands alone
        if isinstance(target, list):
            target = _entry(target, name, setting, option)
        elif isinstance(target, dict):
            target = target.setdefault(name, {})
        else:
            raise InputError(f"{option} {setting}: '{name}' is not a table of the scene")
    if isinstance(target, list):
        _entry(target, key, setting, option)
        target[int(key)] = value
    elif isinstance(target, dict):
        target[key] = value
    else:
        raise InputError(f"{option} {setting}: '{path.strip()}' is not a key of the scene")


@cache
def _lists() -> frozenset[str]:
    """Keys of a scene under which a table may stand alone for a list of one."""
    hints = get_type_hints(Scene, include_extras=True)
    return frozenset(
        key
        for key, hint in hints.items()
        if any(getattr(one, "func", None) is as_list for one in getattr(hint, "__metadata__", ()))
    )


def value_of(text: str) -> Any:
    """The value that a setting gives: as in TOML, or a bare word, which is a text.

    Numbers may begin or end with their point, as on calculators.

    >>> value_of("5e-3"), value_of("[1, -.5]"), value_of("static"), value_of("{ x = .4 }")
    (0.005, [1, -0.5], 'static', {'x': 0.4})
    """
    for one in (text, _POINT.sub(_with_zero, text)):
        try:
            return tomllib.loads(f"value = {one}")["value"]
        except (ValueError, RecursionError):
            continue
    return text.strip()


def _with_zero(found: re.Match[str]) -> str:
    """Return a decimal point with the 0 that TOML requires next to it; quoted texts unchanged."""
    return found["quoted"] or (".0" if found["last"] else "0.")


def keys_of(path: str) -> list[str]:
    """Keys between dots; in quotes they may have dots themselves, as in TOML.

    Raises:
        ValueError: They are not written as in TOML.

    >>> keys_of("contact.0.pressure"), keys_of("accuracy.'top.normal_force'")
    (['contact', '0', 'pressure'], ['accuracy', 'top.normal_force'])
    """
    path = path.strip()
    if '"' not in path and "'" not in path:
        return path.split(".")
    try:
        table = tomllib.loads(f"{path} = 0")
    except RecursionError:
        raise ValueError(path) from None
    keys = []
    while isinstance(table, dict):
        key, table = next(iter(table.items()))
        keys.append(key)
    return keys


def _entry(entries: list[Any], name: str, setting: str, option: str) -> Any:
    if not (name.isascii() and name.isdigit()) or int(name) >= len(entries):
        raise InputError(
            f"{option} {setting}: '{name}' must be a number from 0 to {len(entries) - 1}"
        )
    return entries[int(name)]
