"""A scene under a multiple of all that loads it: along this, every edge moves."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.load_kinds import times
from fenics_contact.scene.scene import Scene


def driven(scene: Scene, factor: float) -> Scene:
    """The scene with loads, given displacements, pressures, obstacles and preloads times a factor.

    Args:
        scene: A scene.
        factor: 1 leaves it as it is.
    """
    supports = [
        replace(one, displacement={axis: times(v, factor) for axis, v in one.displacement.items()})
        for one in scene.support
    ]
    loads = [
        replace(one, **{one.kind: one.definition.times(one.value, factor)}) for one in scene.load
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
    changes: dict[str, Any] = {"interference": times(contact.interference, factor)}
    if contact.pressure is not None:
        changes["pressure"] = times(contact.pressure, factor)
    if contact.obstacle is not None:
        names = ("indentation", "force", "displacement")
        found = {name: getattr(contact.obstacle, name) for name in names}
        moved = {name: times(value, factor) for name, value in found.items() if value is not None}
        changes["obstacle"] = replace(contact.obstacle, **moved)
    return replace(contact, **changes)
