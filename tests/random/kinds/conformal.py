"""Conformal pairs: a pin in a groove of nearly its own radius, open above."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact import Contact, Support
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import Array, Elements, friction_of, held, made, material_of, size_of
from tests.random.scenes import RandomScene

ELEMENTS = (
    Elements("plane strain", "quadrilateral", 2),
    Elements("plane strain", "quadrilateral", 2, order=2),
    Elements("plane strain", "triangle", 2, order=2),
    Elements("plane strain", "triangle", 1),
)


@dataclass(frozen=True)
class Groove:
    """Boxes of angles (from straight down) and radii as pieces of rings, open above.

    What has radii below 1 is the pin: it is made smaller and lowered until it touches.

    Attributes:
        play: By which the pin's radius is smaller, over that of the groove.
        length: Scale.
    """

    play: float
    length: float = 1.0

    def __call__(self, points: Array) -> Array:
        angle, depth = points.T
        pin = depth < 1.5
        radius = np.where(pin, depth * (1 - self.play), depth - 1)
        lowered = np.where(pin, self.play, 0.0)
        # To the left, so that cells keep their orientation.
        left, up = -radius * np.sin(angle), -radius * np.cos(angle)
        return self.length * np.stack([left, up - lowered], axis=1)


def conformal(dice: Dice) -> RandomScene:
    """The pin is pressed down at its middle, now and then moved sideways too."""
    elements = dice.of(*ELEMENTS)
    length, play = size_of(dice), dice.of(0.0, 1e-4, 1e-3, 0.01, 0.1, 0.1)
    wide, narrow = dice.between(1.0, 1.5), dice.between(0.6, 0.95)
    most = 14 if elements.degree == 1 else 9
    pin = Box("pin", (-narrow, 0.5), (narrow, 1.0), (dice.whole(most // 2, most), 3))
    groove = Box("groove", (-wide, 2.0), (wide, 2.5), (dice.whole(most // 2, most) + 2, 3))
    depth = length * dice.logarithmic(1e-3, 1e-2)
    moved = {"x": short(dice.of(0.0, 0.2, 0.5) * depth), "y": -short(depth)}
    contact = Contact(
        "pin.y1",
        against="groove.y0",
        slave=dice.of("auto", "auto", "on", "against"),
        **friction_of(dice),
    )
    materials = tuple(material_of(dice, on=name) for name in ("pin", "groove"))
    return made(
        "conformal", elements, (pin, groove), Groove(play, length),
        material=materials, contact=(contact,),
        support=(held("groove.y1", 2), Support("pin.y0", moved)),
    )  # fmt: skip
