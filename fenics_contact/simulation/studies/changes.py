"""A scene with other values for a study: keys as on the command line, values as in Python."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import question
from fenics_contact.scene.scene import Scene


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
    """One that asks for an accuracy has its own meshes, and one that moves masses.

    Raises:
        InputError: It does.
    """
    if scene.motion is not None:
        raise InputError(
            "motion: a study keeps the stiffness of a body at rest; solve scenes with motion by run"
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
