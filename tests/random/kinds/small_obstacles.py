"""Obstacles of .1 to 10 cells, wherever they meet the surface, against graded cells."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from math import asinh

import numpy as np

from fenics_contact import Contact, Obstacle
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    Array,
    Elements,
    Turned,
    cells_of,
    friction_of,
    held,
    made,
    material_of,
    size_of,
)
from tests.random.scenes import RandomScene, Twin

PLANE = (
    Elements("plane strain", "quadrilateral", 2),
    Elements("plane strain", "quadrilateral", 1),
    Elements("plane stress", "triangle", 1),
)
SPACE = (Elements("3D", "hexahedron", 1), Elements("3D", "tetrahedron", 1))
SAME = ("normal_force", "max_contact_pressure", "contact_area", "indentation", "strain_energy")
# Above so many cells across half of it an answer is expected.
_ENOUGH = 4.0


@dataclass(frozen=True)
class Graded:
    """Cells of the unit box that become smaller towards a place on its last axis' high side.

    Attributes:
        towards: The place, one coordinate an axis.
        size: Of the region of small cells there (length, before scaling).
        high: Of the box along the last axis.
        length: Scale.
    """

    towards: tuple[float, ...]
    size: float
    high: float
    length: float

    def __call__(self, points: Array) -> Array:
        found = np.empty_like(points)
        for axis, place in enumerate(self.towards):
            most = self.high if axis == len(self.towards) - 1 else 1.0
            low, up = asinh(place / self.size), asinh((most - place) / self.size)
            share = points[:, axis] / most * (low + up) - low
            found[:, axis] = place + self.size * np.sinh(share)
        return self.length * found


def small_obstacle(dice: Dice) -> RandomScene:
    """Something round or flat, pressed onto a block by a force or a way."""
    elements = dice.of(*SPACE) if dice.chance(25) else dice.of(*PLANE)
    dimension, length = elements.dimension, size_of(dice)
    sides = (1.0, *(1.0,) * (dimension - 2), dice.between(0.4, 0.9))
    cells = cells_of(dice, elements, *sides)
    body = Box("body", (0.0,) * dimension, sides, cells)
    count = dice.logarithmic(0.1 if dimension == 2 else 0.3, 10)
    half = min(0.5 * count / cells[0], 0.3)
    place = tuple(dice.between(0.35, 0.65) for _ in range(dimension - 1))
    material = material_of(dice)
    obstacle = _obstacle(dice, dimension, length * half, material.youngs_modulus)
    obstacle = dataclasses.replace(
        obstacle, position=(*(short(length * x) for x in place), length * sides[-1])
    )
    last = AXES[dimension - 1]
    keys = {
        "material": material,
        "support": (held(f"body.{last}0", dimension),),
        "contact": (Contact(f"body.{last}1", obstacle=obstacle, **friction_of(dice)),),
    }
    fine = Elements(elements.kinematics, "quadrilateral" if dimension == 2 else "hexahedron", 2)
    cells = (48, 24) if dimension == 2 else (14, 14, 7)
    graded = Graded((*place, sides[-1]), half, sides[-1], length)
    twin = made("graded", fine, (dataclasses.replace(body, cells=cells),), graded, **keys)
    across = 2 * half * body.cells[0]
    return made(
        f"obstacle of {across:.2g} cells", elements, (body,), Turned(length=length), (),
        "answered" if across >= _ENOUGH else "seen",
        twin=Twin(twin, dict.fromkeys(SAME, 1.0)), **keys,
    )  # fmt: skip


def _obstacle(dice: Dice, dimension: int, half: float, modulus: float) -> Obstacle:
    """That touches over about this half width."""
    shapes = ("parabola", "cylinder") if dimension == 2 else ("paraboloid", "sphere")
    shape = dice.of(*shapes, "flat punch")
    radius = short(half * dice.between(4, 15))
    depth = short(half**2 / (2 * radius))
    size = short(half) if shape == "flat punch" else radius
    if dice.chance(40):
        force = short(0.5 * modulus * depth * half ** (dimension - 2))
        return Obstacle(shape, radius=size, force=force)
    return Obstacle(shape, radius=size, indentation=depth)
