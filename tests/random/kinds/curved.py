"""Cells of order 2: bodies with curved tops, pressed by obstacles or by each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact import Contact, Obstacle, Support
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    Array,
    Elements,
    friction_of,
    held,
    made,
    material_of,
    size_of,
)
from tests.random.scenes import RandomScene

ELEMENTS = (
    Elements("plane strain", "quadrilateral", 2, order=2),
    Elements("plane stress", "triangle", 2, order=2),
    Elements("axisymmetric", "quadrilateral", 2, order=2),
    Elements("3D", "hexahedron", 2, order=2),
)


@dataclass(frozen=True)
class Crowned:
    """A box from height -1 to 0 with a crowned top, and one from 2 to 3 that is lowered onto it.

    Attributes:
        lower: Height of the lower body's crown, at the middle over the edge.
        upper: The same of the upper body, downwards.
        length: Scale.
    """

    lower: float
    upper: float = 0.0
    length: float = 1.0

    def __call__(self, points: Array) -> Array:
        found, above = points.copy(), points[:, -1] > 1
        found[above, -1] -= 2
        crown = np.where(above, self.upper, -self.lower) * np.sum(points[:, :-1] ** 2, axis=1)
        found[:, -1] += crown * (1 - np.abs(found[:, -1]))
        return self.length * found


def curved(dice: Dice) -> RandomScene:
    """A plane on a crowned body, or two crowned bodies."""
    elements = dice.of(*ELEMENTS)
    dimension, length = elements.dimension, size_of(dice)
    axial, pair = elements.kinematics == "axisymmetric", dice.chance(50)
    start = 0.0 if axial else -1.0
    low, high = (start,) * (dimension - 1), (1.0,) * (dimension - 1)
    count = dice.whole(8, 12) if dimension == 2 else 3
    cells = (*(count,) * (dimension - 1), max(2, count // 2))
    last = AXES[dimension - 1]
    parts = [Box("body", (*low, -1.0), (*high, 0.0), cells)]
    shape = Crowned(dice.between(0.05, 0.3), dice.of(-0.04, 0.0, 0.1), length)
    depth = short(length * dice.logarithmic(5e-4, 1e-2))
    supports = [held(f"body.{last}0", dimension)]
    friction = friction_of(dice)
    materials = [material_of(dice, on="body")]
    if pair:
        fewer = tuple(max(2, value - 1) for value in cells)
        parts.append(Box("upper", (*low, 2.0), (*high, 3.0), fewer))
        materials.append(material_of(dice, on="upper"))
        moved = dict.fromkeys(AXES[: dimension - 1], 0.0) | {last: -depth}
        supports.append(Support(f"upper.{last}1", moved))
        contact = Contact(f"upper.{last}0", against=f"body.{last}1", **friction)
    else:
        normal = (0.0,) * (dimension - 1) + (-1.0,)
        obstacle = Obstacle("plane", position=(0.0,) * dimension, normal=normal, indentation=depth)
        contact = Contact(f"body.{last}1", obstacle=obstacle, **friction)
    return made(
        "order 2", elements, tuple(parts), shape,
        material=tuple(materials), support=tuple(supports), contact=(contact,),
    )  # fmt: skip
