"""Two obstacles that are driven into one body: their forces are known where these drive them."""

from __future__ import annotations

from typing import Any

from fenics_contact import Contact, Obstacle
from fenics_contact.verification.boxes import Box
from tests.random.contacts import path_along
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    PLANE,
    SPACE,
    Turned,
    cells_of,
    friction_of,
    held,
    made,
    material_of,
    size_of,
)
from tests.random.scenes import Known, RandomScene


def two_driven(dice: Dice) -> RandomScene:
    """One from above, one from a side, by forces or by ways; each may move along as well."""
    elements = dice.of(*PLANE, *SPACE)
    dimension, length = elements.dimension, size_of(dice)
    sides = (dice.between(0.8, 1.4), *(1.0,) * (dimension - 2), dice.between(0.8, 1.4))
    material = material_of(dice)
    body = Box("body", (0.0,) * dimension, sides, cells_of(dice, elements, *sides))
    last = AXES[dimension - 1]
    contacts, known = [], []
    for name, axis in (("above", dimension - 1), ("beside", 0)):
        friction = friction_of(dice)
        force = dice.chance(60)
        obstacle = _obstacle(dice, sides, axis, length, material.youngs_modulus, force, friction)
        side = f"body.{AXES[axis]}1"
        contacts.append(Contact(side, name=name, obstacle=obstacle, **friction))
        if force:
            known.append(Known(f"{name}.normal_force", float(obstacle.force or 0.0)))
    return made(
        "two driven", elements, (body,), Turned(length=length), tuple(known),
        material=material, support=(held(f"body.{last}0", dimension),), contact=tuple(contacts),
    )  # fmt: skip


def _obstacle(dice, sides, axis, length, modulus, force, friction) -> Obstacle:
    """In the middle of the side at the end of an axis."""
    dimension = len(sides)
    place = [0.5 * length * side for side in sides]
    place[axis] *= 2
    normal = [0.0] * dimension
    normal[axis] = -1.0
    shape = dice.of("parabola" if dimension == 2 else "paraboloid", "plane", "flat punch")
    half = 0.3 * length
    radius = short(half * dice.between(4, 15))
    depth = short(half**2 / (2 * radius))
    keys: dict[str, Any] = {"position": tuple(place), "normal": tuple(normal)}
    if shape == "flat punch":
        keys["radius"] = short(half)
    elif shape != "plane":
        keys["radius"] = radius
    if force:
        keys["force"] = short(modulus * depth * half ** (dimension - 2))
    else:
        keys["indentation"] = depth
    if friction and dice.chance(50):
        along = [0.0] * dimension
        along[0 if axis else dimension - 1] = short(
            dice.between(0.1, 0.8) * friction["friction_coefficient"] * depth
        )
        keys |= {"displacement": tuple(along), "displacement_path": path_along(dice)}
    return Obstacle(shape, **keys)
