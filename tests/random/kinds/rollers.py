"""Rings of rollers between two rings: bearings of which many points change at once."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sin

import numpy as np

from fenics_contact import Contact, Load, SolverSettings
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import Array, Elements, held, made, material_of, size_of
from tests.random.scenes import RandomScene

ELEMENTS = (
    Elements("plane strain", "quadrilateral", 2),
    Elements("plane strain", "quadrilateral", 2, order=2),
)
# Radii of roller number n are drawn at 10 (n + 1) more.
_APART = 10.0


@dataclass(frozen=True)
class Bearing:
    """Boxes of angles and radii as rings about the middle, or as rollers on a circle.

    Attributes:
        number: Of rollers.
        circle: Radius of the circle of their middles (length, before scaling).
        length: Scale.
    """

    number: int
    circle: float
    length: float = 1.0

    def __call__(self, points: Array) -> Array:
        angle, given = points.T
        roller = np.floor(given / _APART).astype(int) - 1
        radius = np.where(roller < 0, given, given - _APART * (roller + 1))
        turn = 2 * pi * roller / self.number
        middle = np.where(roller < 0, 0.0, self.circle) * np.stack([np.sin(turn), np.cos(turn)])
        places = middle + radius * np.stack([np.sin(angle + turn), np.cos(angle + turn)])
        return self.length * places.T


def bearing(dice: Dice) -> RandomScene:
    """Held outside, and loaded inside; the rollers are held by contact and friction alone."""
    elements, length, number = dice.of(*ELEMENTS), size_of(dice), dice.of(4, 6, 8, 8)
    material = material_of(dice)
    roller = 0.7 * sin(pi / number) / (1 - 0.7 * sin(pi / number))  # inner ring of radius 1
    cells = (dice.whole(14, 18), 2)
    around = number * dice.whole(4, 6)
    parts = [
        Box("inner", (0.0, 0.6), (2 * pi, 1.0), (around, 2)),
        Box("outer", (0.0, 1 + 2 * roller), (2 * pi, 1.4 + 2 * roller), (around + number, 2)),
    ]
    contacts = []
    friction = {"friction_coefficient": dice.of(0.1, 0.3)} if dice.chance(40) else {}
    # More than what straight cells leave open between a roller and a ring.
    least = 0.02 if elements.order == 1 else 1e-3
    overlap = short(length * roller * least * dice.between(1, 2))
    for index in range(number):
        low = _APART * (index + 1)
        name = f"r{index}"
        parts.append(Box(name, (0.0, low + 0.3 * roller), (2 * pi, low + roller), cells))
        for side in ("inner.y1", "outer.y0"):
            of = {"name": f"{name} {side}", "interference": overlap, "law": "static"}
            contacts.append(Contact(f"{name}.y1", against=side, **of, **friction))
    pressure = short(material.youngs_modulus * dice.logarithmic(1e-5, 1e-3))
    return made(
        f"bearing of {number}", elements, tuple(parts), Bearing(number, 1 + roller, length), (),
        "answered", closed=tuple(part.name for part in parts), material=material,
        support=(held("outer.y1", 2),),
        load=(Load("inner", body_force=(0.0, -short(pressure / length))),),
        contact=tuple(contacts), solver=SolverSettings(stabilisation=True),
    )  # fmt: skip
