"""Numbers of a scene by their keys, and what values they are part of change by."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import Profile, Value


def found_in(scene: Scene, key: str) -> Any:
    """What a scene has under a key, as of ``--set``.

    Raises:
        InputError: There is no such key.
    """
    part: Any = scene
    for name in key.split("."):
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


def unit_of(value: Value, rest: Sequence[str]) -> Value | None:
    """Derivative of a value in one of its numbers, itself a value; None where it has none.

    Args:
        value: A number, or a profile.
        rest: Of the number's key: nothing, or that of a number of the profile.

    >>> profile = Profile(along="x", at=(0, 2, 4), values=(100, 300, 0))
    >>> unit_of(profile, ["values", "1"]).values
    (0.0, 1.0, 0.0)
    """
    if isinstance(value, float | int) and not rest:
        return 1.0
    if isinstance(value, Profile) and len(rest) == 2 and rest[0] == "values":
        unit = tuple(float(number == int(rest[1])) for number in range(len(value.values)))
        return dataclasses.replace(value, values=unit)
    return None
