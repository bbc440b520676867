"""Pieces of half-spaces: Hertz's formulas where there is no friction."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

from fenics_contact import Contact, HalfSpace, Material, Obstacle
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import AXES, Array, Elements, friction_of, made, modulus_of, size_of
from tests.random.scenes import Known, RandomScene

ELEMENTS = (
    Elements("axisymmetric", "quadrilateral", 2),
    Elements("axisymmetric", "triangle", 2),
    Elements("plane strain", "quadrilateral", 2),
    Elements("3D", "hexahedron", 1),
)


@dataclass(frozen=True)
class Graded:
    """A unit box, its upper corner at the origin, with cells that are finer there.

    Attributes:
        power: Of the distance from there.
        length: Of the sides.
    """

    power: float
    length: float

    def __call__(self, points: Array) -> Array:
        found = points.copy()
        found[:, :-1] = points[:, :-1] ** self.power
        found[:, -1] = -((-points[:, -1]) ** self.power)
        return self.length * found


def half_space(dice: Dice) -> RandomScene:
    """A paraboloid or a parabola is pressed onto it; in 3D a quarter, in plane strain a half."""
    elements = dice.of(*ELEMENTS)
    dimension, length = elements.dimension, size_of(dice)
    axial = elements.kinematics == "axisymmetric"
    radius, extent = short(8 * length), dice.between(12.0, 30.0)
    # About the square root of radius times depth.
    half_width = length * dice.between(0.5, 2.0)
    material = Material(modulus_of(dice), dice.of(0.0, 0.2, 0.3, 0.45))
    stiffness = material.youngs_modulus / (1 - material.poissons_ratio**2)
    friction = friction_of(dice, 0.1, 0.6) if dice.chance(50) else {}
    count = 9 if dimension == 3 else dice.whole(14, 22)
    body = Box("body", (0.0,) * (dimension - 1) + (-1.0,), (1.0,) * (dimension - 1) + (0.0,),
               (count,) * dimension)  # fmt: skip
    inner = AXES[: dimension - 1]
    planes = () if axial else tuple(f"body.{axis}0" for axis in inner)
    outer = (*(f"body.{axis}1" for axis in inner), f"body.{AXES[dimension - 1]}0")
    share = 1 if axial else 0.5 ** len(planes)
    depth = short(half_width**2 / radius)
    shape, keys, force = (
        "paraboloid",
        {"indentation": depth},
        4 / 3 * stiffness * sqrt(radius) * depth**1.5,
    )
    if elements.kinematics == "plane strain":
        shape, force = "parabola", short(pi * stiffness * half_width**2 / (4 * radius))
        keys = {"force": share * force}
        peak = sqrt(force * stiffness / (pi * radius))
    else:
        peak = 2 * stiffness / pi * sqrt(depth / radius)
    known = () if friction else (
        Known("normal_force", share * force), Known("max_contact_pressure", peak),
    )  # fmt: skip
    obstacle = Obstacle(shape, radius=radius, position=(0.0,) * dimension, **keys)
    return made(
        "half-space", elements, (body,), Graded(2.0, extent * half_width), known,
        material=material, symmetry=planes, half_space=HalfSpace(outer),
        contact=(Contact(f"body.{AXES[dimension - 1]}1", obstacle=obstacle, **friction),),
    )  # fmt: skip
