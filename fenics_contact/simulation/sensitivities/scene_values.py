"""Numbers of a scene by their keys, and scenes with other values for these."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import question
from fenics_contact.scene.scene import Scene
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


def with_changes(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """The scene with some values replaced, all of them at once.

    Args:
        scene: What they are changed of.
        changes: Key → value. Keys are those of ``--set``, such as ``load.0.traction.0``; entries of
            lists are counted from 0.

    Raises:
        InputError: A key is none of the scene, or the scene cannot have such a value.
    """
    tree: dict[str, Any] = {}
    for key, value in changes.items():
        if re.fullmatch(r"material\.(\d+\.)?name", str(key)):
            raise InputError(
                f"change of {key}: the scene already has the values of its name; change these, or "
                "make another scene"
            )
        *path, last = key.split(".") if isinstance(key, str) else [repr(key)]
        branch = tree
        for name in path:
            branch = branch.setdefault(name, {})
            if not isinstance(branch, dict):
                raise InputError(f"change of {key}: another change is of a part of it, or of all")
        if last in branch:
            raise InputError(f"change of {key}: another change is of a part of it, or of all")
        branch[last] = _Value(value)
    changed = _changed(scene, tree, "")
    assert isinstance(changed, Scene)
    return changed


def refuse_accuracy(scene: Scene) -> None:
    """Refuse scenes whose body is another one in each answer, or in each load step.

    One that asks for an accuracy has its own meshes, one that moves masses, and in finite strains
    the stiffness is that of each step.

    Raises:
        InputError: It does.
    """
    if scene.motion is not None:
        raise InputError(
            "motion: a study keeps the stiffness of a body at rest; solve scenes with motion by run"
        )
    if scene.has_finite_strains:
        raise InputError(
            'strains = "finite": a study keeps the stiffness of a body for all answers, which '
            "follows the displacement here; solve such scenes by run"
        )
    if scene.accuracy is not None:
        raise InputError(
            "accuracy: a study keeps one mesh for all answers; leave accuracy out, and look at the "
            "error bars"
        )


@dataclasses.dataclass(frozen=True)
class _Value:
    """The new value of a key, which may itself be a table."""

    value: Any


def _changed(part: Any, tree: dict[str, Any] | _Value, key: str) -> Any:
    """A part of a scene with what a tree of changes says of it.

    Args:
        part: The part as it is.
        tree: Name → changes of the part of that name; or what takes its place.
        key: Of the part, for messages.
    """
    if isinstance(tree, _Value):
        return tree.value
    if dataclasses.is_dataclass(part) and not isinstance(part, type):
        names = [field.name for field in dataclasses.fields(part)]
        for name in tree:
            if name not in names:
                raise InputError(
                    f"change of {_under(key, name)}: there is no such key{question(name, names)}"
                )
        found = {n: _changed(getattr(part, n), t, _under(key, n)) for n, t in tree.items()}
        try:
            return dataclasses.replace(part, **found)
        except InputError as error:
            said = ", ".join(_under(key, name) for name in tree)
            raise InputError(f"change of {said}: {error}") from None
    if isinstance(part, tuple):
        if len(part) == 1 and dataclasses.is_dataclass(part[0]) and not any(map(_counts, tree)):
            return (_changed(part[0], tree, key),)  # a list of one table may be written as that
        entries = list(part)
        for name, below in tree.items():
            if not _counts(name) or int(name) >= len(part):
                raise InputError(
                    f"change of {_under(key, name)}: '{name}' must be a number from 0 to "
                    f"{len(part) - 1}"
                )
            entries[int(name)] = _changed(part[int(name)], below, _under(key, name))
        return tuple(entries)
    if part is None or isinstance(part, Mapping):
        below = part or {}
        return {**below, **{n: _changed(below.get(n), t, _under(key, n)) for n, t in tree.items()}}
    raise InputError(f"change of {_under(key, next(iter(tree)))}: '{key}' is not a table")


def _counts(name: str) -> bool:
    """Whether it is the number of an entry of a list."""
    return name.isascii() and name.isdigit()


def _under(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name
