"""Stacks of three and more bodies: statics give the force between each two."""

from __future__ import annotations

import itertools

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


def stack(dice: Dice) -> RandomScene:
    """Blocks on each other, pressed from above and pushed by less than friction holds."""
    elements = dice.of(*PLANE, *SPACE)
    dimension, length, number = elements.dimension, size_of(dice), dice.of(3, 3, 4)
    heights = [dice.between(0.3, 0.6) for _ in range(number)]
    parts, bottom, inset = [], 0.0, 0.0
    for index, height in enumerate(heights):
        low = (inset,) * (dimension - 1)
        high = (1.0 - inset,) * (dimension - 1)
        spans = [*(b - a for a, b in zip(low, high, strict=True)), height]
        cells = tuple(max(2, count // 2) for count in cells_of(dice, elements, *spans))
        parts.append(Box(f"b{index}", (*low, bottom), (*high, bottom + height), cells))
        bottom += height
        inset += dice.of(0.0, 0.0, 0.05)
    materials = tuple(material_of(dice, on=part.name) for part in parts)
    coefficient = dice.between(0.2, 0.8)
    area = (length * (1.0 - 2 * parts[-1].low[0])) ** (dimension - 1)
    pressure = short(min(m.youngs_modulus for m in materials) * dice.logarithmic(1e-4, 5e-3))
    most = min(coefficient, 0.3 / bottom)  # so that it does not tip over
    shear = short(dice.of(0.0, dice.between(0.1, 0.9) * most) * pressure)
    top = f"{parts[-1].name}.{AXES[dimension - 1]}1"
    push = (shear, *(0.0,) * (dimension - 2), -pressure)
    contacts, known = _between(dice, parts, coefficient, pressure * area, push, area)
    support, floor = (), Contact(f"b0.{AXES[dimension - 1]}0", friction_coefficient=coefficient)
    if dice.chance(60):
        support, floor = (held(floor.on, dimension),), None
    else:
        contacts.append(floor)
        known.append(Known(f"{floor.label}.normal_force", pressure * area))
    return made(
        "stack", elements, tuple(parts), Turned(length=length), tuple(known), "answered",
        material=materials, support=support, load=(Load(top, traction=push),),
        contact=tuple(contacts),
    )  # fmt: skip


def _between(dice, parts, coefficient, force, push, area):
    """Contacts from body to body, and what they carry."""
    last = AXES[len(parts[0].low) - 1]
    law = dice.of("static", "incremental")
    contacts, known = [], []
    for below, above in itertools.pairwise(parts):
        contact = Contact(
            f"{above.name}.{last}0",
            against=f"{below.name}.{last}1",
            friction_coefficient=coefficient,
            law=law,
            slave=dice.of("auto", "auto", "on", "against"),
        )
        carried = (*(-area * value for value in push[:-1]), 0.0)
        contacts.append(contact)
        known.append(Known(f"{contact.label}.normal_force", force))
        known.append(Known(f"{contact.label}.friction_force", carried, size=force))
    return contacts, known
