"""All numbers of a scene by their keys, and what each is, as the scene's own classes say it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic.fields import FieldInfo

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import question
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import Dimension, description_of, dimension_of
from fenics_contact.scene.units.table import names_of
from fenics_contact.scene.values import AXES

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
        names = names_of(scene)
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
    """Those of a part of a scene.

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
