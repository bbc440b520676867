"""Blocks on slopes at .999 and 1.001 of what they slide or tip at."""

from __future__ import annotations

import dataclasses
from math import atan, cos, sin, tan

from fenics_contact import Contact, Load
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    PLANE,
    SPACE,
    Turned,
    cells_of,
    held,
    made,
    material_of,
    size_of,
)
from tests.random.scenes import Known, RandomScene


def incline(dice: Dice) -> RandomScene:
    """A block of its own weight on a rigid or elastic slope: held below the limit, else refused."""
    elements = dice.of(*PLANE, *SPACE)
    dimension, length = elements.dimension, size_of(dice)
    holds, tips = dice.chance(50), dice.chance(25)
    share = 0.999 if holds else 1.001
    slope = dice.logarithmic(0.02, 0.8)
    if tips:  # the weight's line leaves the base
        sides = (1.0, *(0.6,) * (dimension - 2), short(1 / slope))
        coefficient, angle = min(3 * slope, 2.0) + 0.2, atan(share / sides[-1])
    else:
        sides = (1.0, *(0.6,) * (dimension - 2), min(dice.between(0.3, 0.8), 0.5 / slope))
        coefficient, angle = short(slope), atan(share * short(slope))
    if max(sides) > 3:  # not that slender
        return incline(dice)
    turned = Turned(angle, length)
    material = material_of(dice)
    body = Box("body", (0.0,) * dimension, sides, cells_of(dice, elements, *sides))
    parts, last = (body,), AXES[dimension - 1]
    density = short(material.youngs_modulus / length * dice.logarithmic(1e-6, 1e-4))
    volume = length**dimension
    for side in sides:
        volume *= side
    weight = density * volume
    down = (0.0,) * (dimension - 1) + (-density,)
    contact = Contact(
        f"body.{last}0", friction_coefficient=coefficient, law=dice.of("static", "incremental")
    )
    supports: tuple = ()
    if dice.chance(40):
        low = (-0.3, *(-0.1,) * (dimension - 2), -0.4)
        high = (1.3, *(0.7,) * (dimension - 2), 0.0)
        spans = [b - a for a, b in zip(low, high, strict=True)]
        parts = (body, Box("ground", low, high, cells_of(dice, elements, *spans)))
        contact = dataclasses.replace(contact, against=f"ground.{last}1")
        supports = (held(f"ground.{last}0", dimension),)
    known: tuple[Known, ...] = ()
    if holds:
        pull = weight * sin(angle)
        along = turned.vector(pull, *(0.0,) * (dimension - 1))
        normal = Known("normal_force", weight * cos(angle))
        known = (normal, Known("friction_force", along, size=weight))
    assert tan(angle) > 0
    return made(
        "incline tips" if tips else "incline slides", elements, parts, turned, known,
        "answered" if holds else "refused", material=material, support=supports,
        load=(Load("body", body_force=down),), contact=(contact,),
    )  # fmt: skip
