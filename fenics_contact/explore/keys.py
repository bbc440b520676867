"""Numbers of a scene by their keys: what each is, and the ranges in which the page moves them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from annotated_types import Ge, Le
from pydantic.fields import FieldInfo

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import question
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import Dimension, description_of, dimension_of
from fenics_contact.scene.values import AXES
from fenics_contact.simulation.studies.study import Study

# Lists that a file writes as one table where they have one entry.
_ALONE = ("material", "mesh")


@dataclasses.dataclass(frozen=True)
class SceneNumber:
    """A number of a scene.

    Attributes:
        key: As of ``--set``.
        value: What the scene has.
        field: Of the class that it is in; or that of the list or table that it is an entry of.
        dimension: What it measures; None of a pure number.
        is_entry: Whether it is one of a list or table of numbers.
        label: What it is, in words, such as ``obstacle radius``.
        of: Whose it is, such as ``contact 'top'``; empty of the scene's own.
    """

    key: str
    value: float
    field: FieldInfo
    dimension: Dimension | None
    is_entry: bool
    label: str
    of: str

    @property
    def is_whole(self) -> bool:
        """Whether it can be a whole number only."""
        return isinstance(self.value, int)  # others are floats, however they are written

    @property
    def meaning(self) -> str:
        """The sentence of the reference."""
        return description_of(self.field)

    def unit(self, scene: Scene) -> str:
        """Return its unit, or its dimension in a scene without units; empty for a pure number."""
        if self.dimension is None:
            return ""
        names = scene.unit_names
        return self.dimension.words if names is None else names.of(self.dimension.words)


def numbers_of(scene: Scene) -> dict[str, SceneNumber]:
    """Key → number, in the order of the scene's classes.

    Args:
        scene: The scene.
    """
    found = list(_of_table(scene, (), None, "", len(AXES[: scene.dimension])))
    return {number.key: number for number in found}


def number_at(scene: Scene, key: str) -> SceneNumber:
    """The number of a key.

    Args:
        scene: The scene.
        key: As of ``--set``.

    Raises:
        InputError: The scene has no such key, or no number there.
    """
    numbers = numbers_of(scene)
    written = {key: number for number in numbers.values() for key in _ways(scene, number.key)}
    if key in written:
        return written[key]
    there = _value_at(scene, key, list(written))
    if there is None:
        raise InputError(f"'{key}' has no value in the scene, and no number to move")
    what = "a table" if not isinstance(there, str) else f"'{there}'"
    raise InputError(f"'{key}' is not a number in the scene, but {what}")


def _ways(scene: Scene, key: str) -> Iterator[str]:
    """How a key can be written."""
    yield key
    head, _, rest = key.partition(".")
    if head in _ALONE and rest.startswith("0.") and len(getattr(scene, head)) == 1:
        yield f"{head}.{rest[2:]}"


def _value_at(scene: Scene, key: str, known: list[str]) -> Any:
    """Return the value at a key that has no number.

    Raises:
        InputError: There is no such key.
    """
    part: Any = scene
    for name in key.split("."):
        if isinstance(part, tuple) and name.isascii() and name.isdigit() and int(name) < len(part):
            part = part[int(name)]
        elif isinstance(part, Mapping) and name in part:
            part = part[name]
        elif dataclasses.is_dataclass(part) and name in getattr(part, "__pydantic_fields__", ()):
            part = getattr(part, name)
        else:
            raise InputError(f"'{key}': the scene has no such key{question(key, known)}")
    return part


def _of_table(
    table: Any, path: tuple[str, ...], outer: Dimension | None, of: str, axes: int
) -> Iterator[SceneNumber]:
    """Yield the numbers in a part of a scene that may be moved on the page.

    Args:
        table: Of a scene class.
        path: Of its key.
        outer: What the key measures in whose place it stands.
        of: Whose it is.
        axes: Components of a vector.
    """
    for name, field in table.__pydantic_fields__.items():
        mark = dimension_of(field)
        dimension = mark.of(table, outer) if mark is not None else None
        yield from _of_value(
            getattr(table, name), (*path, name), field, dimension, of or _owner(table, path), axes
        )


def _of_value(
    value: Any,
    path: tuple[str, ...],
    field: FieldInfo,
    dimension: Dimension | None,
    of: str,
    axes: int,
    is_entry: bool = False,
) -> Iterator[SceneNumber]:
    if isinstance(value, int | float) and not isinstance(value, bool):
        label = _words(path[2:] if of else path, axes)
        yield SceneNumber(".".join(path), value, field, dimension, is_entry, label, of)
    elif hasattr(type(value), "__pydantic_fields__"):
        yield from _of_table(value, path, dimension, of, axes)
    elif isinstance(value, tuple | Mapping):
        pairs = value.items() if isinstance(value, Mapping) else enumerate(value)
        for name, entry in pairs:
            yield from _of_value(entry, (*path, str(name)), field, dimension, of, axes, True)


def _owner(table: Any, path: tuple[str, ...]) -> str:
    """Return the owner of an entry's numbers, such as ``contact 'top'``."""
    if len(path) != 2:
        return ""
    name = getattr(table, "label", "") or getattr(table, "on", "") or getattr(table, "name", "")
    return f"{path[0]} '{name}'" if name else " ".join(path)


def _words(path: tuple[str, ...], axes: int) -> str:
    """The words of a key; entries of vectors by their axes."""
    *names, last = path
    if last.isdigit() and int(last) < axes:
        last = AXES[int(last)]
    return " ".join((*names, last)).replace("_", " ")


# What is done to the body: what else a scene has makes another one, or is of the solver.
_TABLES = ("contact", "coupling", "load", "preload", "support")
_MOST = 24  # sliders on a page that chooses them itself


@dataclass(frozen=True)
class MovedKey:
    """A number that is moved.

    Attributes:
        number: Of the scene.
        low: The smallest value.
        high: The largest value.
        makes_anew: Whether it makes the body anew, so that an answer takes long.
    """

    number: SceneNumber
    low: float
    high: float
    makes_anew: bool = False

    @property
    def key(self) -> str:
        """Key as of ``--set``."""
        return self.number.key

    @property
    def start(self) -> float:
        """Where the slider begins: at the scene's value, or as near as its range has it."""
        return min(max(self.number.value, self.low), self.high)

    def taken(self, value: object) -> float:
        """A value that somebody asks for, as the scene takes it.

        Raises:
            ValueError: It is no number in the range; says what is accepted.
        """
        if not isinstance(value, int | float) or isinstance(value, bool):
            raise ValueError(f"{self.key}: not a number")
        if not self.low <= value <= self.high:  # nor is one that is not a number
            raise ValueError(f"{self.key}: must be between {self.low:g} and {self.high:g}")
        if self.number.is_whole:
            if value != int(value):
                raise ValueError(f"{self.key}: must be a whole number")
            return int(value)
        return float(value)


def moved_keys(study: Study, asked: Sequence[str] | Mapping[str, Any] = ()) -> list[MovedKey]:
    """The numbers that a page moves.

    Args:
        study: What is explored.
        asked: ``KEY=LOW:HIGH`` each, or key → (low, high); by default the page chooses them.

    Raises:
        InputError: A key is not known or no number, or a range is none; or there is nothing to
            choose.
    """
    if not asked:
        return _chosen(study)
    if isinstance(asked, Mapping):
        ranges = [(f"'{key}'", key, _pair(key, between)) for key, between in asked.items()]
    else:
        ranges = [(f"--vary {text}", *_parsed(text)) for text in asked]
    found: dict[str, MovedKey] = {}
    for said, key, (low, high) in ranges:
        try:
            one = _moved(study, number_at(study.scene, key), low, high)
        except InputError as error:
            raise InputError(f"{said}: {error}") from None
        if one.key in found:
            raise InputError(f"{said}: the key is there twice")
        found[one.key] = one
    return list(found.values())


def _pair(key: str, between: Any) -> tuple[float, float]:
    """A range as Python has it.

    Raises:
        InputError: It is none.
    """
    try:
        low, high = (float(end) for end in between)
    except (TypeError, ValueError):
        raise InputError(f"'{key}': give its range as (low, high)") from None
    return low, high


def _parsed(text: str) -> tuple[str, tuple[float, float]]:
    """Key and range of ``KEY=LOW:HIGH``.

    Raises:
        InputError: It is not written so.
    """
    key, equals, between = text.partition("=")
    low, colon, high = between.partition(":")
    if not (equals and colon and key.strip()):
        raise InputError(f"--vary {text}: write it as KEY=LOW:HIGH")
    try:
        return key.strip(), (float(low), float(high))
    except ValueError:
        raise InputError(f"--vary {text}: '{between}' are not two numbers LOW:HIGH") from None


def _moved(study: Study, number: SceneNumber, low: float, high: float) -> MovedKey:
    """A key with the range that somebody gave.

    Raises:
        InputError: The range is none, or the scene does not take its ends.
    """
    if not (math.isfinite(low) and math.isfinite(high)):
        raise InputError("both ends must be finite numbers")
    if low >= high:
        raise InputError(f"the low end, {low:g}, must be less than the high one, {high:g}")
    if number.is_whole:
        if low != int(low) or high != int(high):
            raise InputError("both ends must be whole numbers")
        low, high = int(low), int(high)
    makes_anew = False
    for end in (low, high):
        study.changed({number.key: end})
        makes_anew |= end != number.value and bool(study.other_parts({number.key: end}))
    return MovedKey(number, low, high, makes_anew)


def _chosen(study: Study) -> list[MovedKey]:
    """Return numbers of contacts, loads, preloads and supports with a scale of their own.

    Raises:
        InputError: There is none.
    """
    found = []
    for number in numbers_of(study.scene).values():
        between = _usual(number)
        if between is None or number.key.partition(".")[0] not in _TABLES:
            continue
        try:
            one = _moved(study, number, *between)
        except InputError:  # such as a time at which no load step ends
            continue
        if not one.makes_anew:
            found.append(one)
    if not found:
        raise InputError(
            "there is no number of contacts, loads, preloads or supports to move: name keys by "
            "--vary KEY=LOW:HIGH"
        )
    return sorted(found[:_MOST], key=lambda one: _TABLES.index(one.key.partition(".")[0]))


def _usual(number: SceneNumber) -> tuple[float, float] | None:
    """Between what a number is usually moved; None of directions, places and what is zero."""
    value, dimension = number.value, number.dimension
    if number.is_whole:
        return None
    if dimension is not None:
        if not value or dimension.is_place:
            return None
        low, high = sorted((0.5 * value, 1.5 * value))
        return low, high
    if number.is_entry or value < 0:
        return None
    marks = number.field.metadata
    least = max((float(str(mark.ge)) for mark in marks if isinstance(mark, Ge)), default=0.0)
    most = min((float(str(mark.le)) for mark in marks if isinstance(mark, Le)), default=math.inf)
    return least, min(max(1.0, 2 * value), most)
