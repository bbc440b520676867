"""A scene under a multiple of all that loads it: along this, every edge moves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from fenics_contact.scene.contact import Contact
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import Profile


def driven(scene: Scene, factor: float) -> Scene:
    """The scene with loads, given displacements, pressures, obstacles and preloads times a factor.

    Args:
        scene: A scene.
        factor: 1 leaves it as it is.
    """
    supports = [
        replace(one, displacement={axis: _times(v, factor) for axis, v in one.displacement.items()})
        for one in scene.support
    ]
    loads = [
        replace(one, **{one.kind: _times(getattr(one, one.kind), factor)}) for one in scene.load
    ]
    preloads = [replace(one, force=factor * one.force) for one in scene.preload]
    return replace(
        scene,
        support=tuple(supports),
        load=tuple(loads),
        preload=tuple(preloads),
        contact=tuple(_contact(one, factor) for one in scene.contact),
    )


def _contact(contact: Contact, factor: float) -> Contact:
    changes: dict[str, Any] = {"interference": _times(contact.interference, factor)}
    if contact.pressure is not None:
        changes["pressure"] = _times(contact.pressure, factor)
    if contact.obstacle is not None:
        names = ("indentation", "force", "displacement")
        found = {name: getattr(contact.obstacle, name) for name in names}
        moved = {name: _times(value, factor) for name, value in found.items() if value is not None}
        changes["obstacle"] = replace(contact.obstacle, **moved)
    return replace(contact, **changes)


def _times(value: Any, factor: float) -> Any:
    """A number, a list of numbers, a profile or a function times a factor."""
    if isinstance(value, tuple):
        return tuple(_times(one, factor) for one in value)
    if isinstance(value, Profile):
        return replace(value, values=tuple(factor * one for one in value.values))
    if callable(value):
        return _product(value, factor)
    return factor * value


def _product(function: Callable[..., Any], factor: float) -> Callable[..., Any]:
    return lambda *places: factor * function(*places)
