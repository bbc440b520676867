"""Layers on each other, glued or not: springs in series where they are confined."""

from __future__ import annotations

import itertools

from fenics_contact import Contact, Material, Obstacle, Support
from fenics_contact.verification.boxes import Box
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
    modulus_of,
    size_of,
)
from tests.random.scenes import Known, RandomScene


def layers(dice: Dice) -> RandomScene:
    """Two or three, stiff and soft; pressed by something round, or confined and by a plane."""
    elements = dice.of(*PLANE, *SPACE)
    dimension, length, number = elements.dimension, size_of(dice), dice.of(2, 2, 3)
    last, modulus = AXES[dimension - 1], modulus_of(dice)
    heights = [dice.between(0.1, 0.5) for _ in range(number)]
    parts, bottom = [], 0.0
    for index, height in enumerate(heights):
        low, high = (0.0,) * (dimension - 1), (1.0,) * (dimension - 1)
        cells = cells_of(dice, elements, *high, height)
        top = bottom + height
        parts.append(Box(f"l{index}", (*low, bottom), (*high, top), cells))
        bottom = top
    materials = tuple(
        Material(short(modulus * dice.logarithmic(0.01, 100)), dice.of(0.0, 0.3), on=part.name)
        for part in parts
    )
    confined = dice.chance(40)
    contacts = [
        _between(dice, below, above, last, confined) for below, above in itertools.pairwise(parts)
    ]
    depth = short(length * bottom * dice.logarithmic(1e-4, 5e-3))
    middle = (0.5 * length,) * (dimension - 1)
    supports: list[Support] = [held(f"l0.{last}0", dimension)]
    known: tuple[Known, ...] = ()
    obstacle, friction = Obstacle("plane", position=(*middle, length * bottom)), {}
    if confined:
        supports = [Support(f"l0.{last}0", {last: 0.0})]
        for part in parts:
            for axis in AXES[: dimension - 1]:
                supports += [Support(f"{part.name}.{axis}{end}", {axis: 0.0}) for end in (0, 1)]
        known = (
            Known("top.normal_force", _in_series(elements, heights, materials, depth, length)),
        )
    else:
        half = length * dice.between(0.15, 0.4)
        radius = short(half**2 / (2 * depth))
        shape = "parabola" if dimension == 2 else "paraboloid"
        obstacle = Obstacle(shape, radius=radius, position=(*middle, length * bottom))
        friction = friction_of(dice)
    driven = Obstacle(
        obstacle.shape, obstacle.radius, position=obstacle.position, indentation=depth
    )
    on_top = Contact(f"{parts[-1].name}.{last}1", name="top", obstacle=driven, **friction)
    return made(
        "layers", elements, tuple(parts), Turned(length=length), known,
        "answered" if confined else "",
        material=materials, support=tuple(supports), contact=(*contacts, on_top),
    )  # fmt: skip


def _between(dice, below, above, last, confined):
    """Glued, or with friction."""
    surfaces = {"on": f"{above.name}.{last}0", "against": f"{below.name}.{last}1"}
    if confined or dice.chance(60):
        return Contact(contact="bonded", **surfaces)
    return Contact(**surfaces, **friction_of(dice))


def _in_series(elements, heights, materials, depth, length) -> float:
    """Force that moves the top of confined layers by depth: none of them gives way sideways."""
    give = 0.0
    for height, material in zip(heights, materials, strict=True):
        young, poisson = material.youngs_modulus, material.poissons_ratio
        modulus = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
        if elements.kinematics == "plane stress":
            modulus = young / (1 - poisson**2)
        give += length * height / modulus
    return depth / give * length ** (elements.dimension - 1)
