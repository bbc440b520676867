"""Contacts that meet at a corner: a block in a corner of floor and walls, each with friction."""

from __future__ import annotations

from fenics_contact import Contact, Load, Obstacle
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    PLANE,
    SPACE,
    Turned,
    cells_of,
    friction_of,
    made,
    material_of,
    size_of,
)
from tests.random.scenes import Known, RandomScene


def corner(dice: Dice) -> RandomScene:
    """Pushed into the corner by pressures, or by an obstacle from above and a pressure."""
    elements = dice.of(*PLANE, *SPACE)
    dimension, length = elements.dimension, size_of(dice)
    sides = tuple(dice.between(0.5, 1.5) for _ in range(dimension))
    material = material_of(dice)
    pressures = [short(material.youngs_modulus * dice.logarithmic(1e-4, 1e-2)) for _ in sides]
    parts = (Box("body", (0.0,) * dimension, sides, cells_of(dice, elements, *sides)),)
    contacts = [Contact(f"body.{axis}0", **friction_of(dice)) for axis in AXES[:dimension]]
    loads = [
        Load(f"body.{axis}1", pressure=pressure)
        for axis, pressure in zip(AXES, pressures, strict=False)
    ]
    known: list[Known] = []
    if dice.chance(40):
        loads.pop()
        contacts.append(_from_above(dice, dimension, sides, length))
    elif all(contact.friction_coefficient == 0 for contact in contacts):
        areas = _areas(sides, length)
        known = [
            Known(f"{contact.label}.normal_force", pressure * area)
            for contact, pressure, area in zip(contacts, pressures, areas, strict=True)
        ]
    return made(
        "corner", elements, parts, Turned(length=length), tuple(known),
        material=material, load=tuple(loads), contact=tuple(contacts),
    )  # fmt: skip


def _areas(sides: tuple[float, ...], length: float) -> list[float]:
    """Of the sides across each axis."""
    volume = 1.0
    for side in sides:
        volume *= side
    return [length ** (len(sides) - 1) * volume / side for side in sides]


def _from_above(dice: Dice, dimension: int, sides: tuple[float, ...], length: float) -> Contact:
    """A plane, or something round that touches beside the corner or on its edge."""
    at = dice.of(0.0, 0.1, 0.5)
    place = [at * sides[0], *(0.5 * side for side in sides[1:-1]), sides[-1]]
    depth, half = dice.logarithmic(1e-3, 1e-2) * length, dice.between(0.2, 0.5) * length
    radius = half**2 / (2 * depth)
    shape = dice.of("plane", "parabola" if dimension == 2 else "sphere")
    obstacle = Obstacle(
        shape,
        radius=None if shape == "plane" else short(radius),
        position=tuple(length * value for value in place),
        indentation=short(depth),
    )
    return Contact(f"body.{AXES[dimension - 1]}1", obstacle=obstacle, **friction_of(dice))
