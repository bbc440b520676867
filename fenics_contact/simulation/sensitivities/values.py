"""Numbers of a scene by their keys, and the values that they are part of."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.scene.values import Profile, Value


def found_in(scene: Any, key: str) -> Any:
    """Return the value of a scene, or of a part of it, under a key, as of ``--set``.

    Raises:
        InputError: There is no such key.
    """
    part: Any = scene
    for name in numbered(scene, key).split("."):
        if dataclasses.is_dataclass(part) and name in {f.name for f in dataclasses.fields(part)}:
            part = getattr(part, name)
        elif (
            isinstance(part, tuple) and name.isascii() and name.isdigit() and int(name) < len(part)
        ):
            part = part[int(name)]
        elif isinstance(part, Mapping) and name in part:
            part = part[name]
        else:
            raise InputError(f"by: '{key}': the scene has no such key")
    return part


def numbered(scene: Any, key: str) -> str:
    """A key of a table that there is once, as files may write it, with the number of the entry.

    Args:
        scene: A scene, or a part of it.
        key: As of ``--set``: ``material.youngs_modulus`` is that of the only material.
    """
    table, _, rest = key.partition(".")
    entries = getattr(scene, table, None)
    if not isinstance(entries, tuple) or len(entries) != 1 or not rest or rest[0].isdigit():
        return key
    return f"{table}.0.{rest}" if dataclasses.is_dataclass(entries[0]) else key


def numbers_of(part: Any, key: str = "") -> Iterator[str]:
    """Keys of all numbers of a scene or of a part of it that are not the default."""
    if isinstance(part, bool):
        return
    if isinstance(part, float | int):
        yield key
    below: Mapping[Any, Any] | dict[Any, Any] = {}
    if dataclasses.is_dataclass(part) and not isinstance(part, type):
        given = [(field, getattr(part, field.name)) for field in dataclasses.fields(part)]
        below = {field.name: value for field, value in given if value != field.default}
    elif isinstance(part, tuple):
        below = dict(enumerate(part))
    elif isinstance(part, Mapping):
        below = part
    for name, value in below.items():
        yield from numbers_of(value, f"{key}.{name}" if key else str(name))


def value_under(part: Any, names: Sequence[str]) -> tuple[str, Value, list[str]]:
    """The value that a number is, or is part of, such as a profile.

    Args:
        part: Of a scene, such as a contact.
        names: Of the number's key there; ``found_in`` has found it.

    Returns:
        The value's key, itself, and of the key what is left to the number.
    """
    rest = list(names)
    while rest and not isinstance(part, float | int | Profile):
        part = found_in(part, rest.pop(0))
    return ".".join(names[: len(names) - len(rest)]), part, rest
