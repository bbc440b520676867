"""What assemblies share: elements, clearances, friction, bodies as rings about an axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.random.dice import Dice, short
from tests.random.kinds.common import PLANE, Array, Elements

SPACE = (
    Elements("3D", "hexahedron", 1),
    Elements("3D", "hexahedron", 1),
    Elements("3D", "hexahedron", 2, order=2),
    Elements("3D", "tetrahedron", 2, order=2),
)
ELEMENTS = (*SPACE, *PLANE)
BORE = 0.5  # of a pin or a bolt, so that their cells are no wedges
_CLEARANCES = (-0.01, 0.0, 1e-3, 0.01, 0.1, 0.5)


@dataclass(frozen=True)
class Around:
    """Boxes of angles, radii and heights as rings about z; a pin is lowered until it touches.

    Attributes:
        lowered: Distance by which all with a radius up to 1 is moved against x (length).
    """

    lowered: float = 0.0

    def __call__(self, points: Array) -> Array:
        angle, radius, *height = points.T
        x = radius * np.cos(angle) - np.where(radius <= 1.0, self.lowered, 0.0)
        return np.stack([x, -radius * np.sin(angle), *height], axis=1)


def around(dice: Dice, elements: Elements) -> int:
    """Cells around a circle."""
    if elements.dimension == 2:
        return dice.whole(16, 28) if elements.degree == 1 else dice.whole(12, 16)
    return dice.whole(10, 14) if elements.degree == 1 else dice.whole(6, 8)


def across(dice: Dice, elements: Elements) -> int:
    """Cells along a length of 1 of a straight body."""
    if elements.dimension == 2:
        return dice.whole(4, 6) if elements.degree == 1 else dice.whole(2, 4)
    return dice.whole(2, 4) if elements.degree == 1 else 2


def clearance_of(dice: Dice, cell: float, least: float = -0.01) -> float:
    """A clearance between -.01 and .5 of a cell; below zero bodies overlap.

    Args:
        dice: Draws.
        cell: Length of a side of a cell.
        least: Of it, over the cell.
    """
    return short(cell * dice.of(*(share for share in _CLEARANCES if share >= least)))


def rubbing(dice: Dice) -> dict[str, Any]:
    """Coulomb friction of all contacts of an assembly, of either law."""
    return {
        "friction_coefficient": dice.logarithmic(0.05, 0.8),
        "law": dice.of("static", "incremental"),
    }


def along(elements: Elements, *components: float) -> tuple[float, ...]:
    """Components of a vector in the plane of the first and the last axis, as many as a model has.

    Args:
        elements: Of the model.
        components: The first and the last one.
    """
    first, last = components
    return (first, last) if elements.dimension == 2 else (first, 0.0, last)
