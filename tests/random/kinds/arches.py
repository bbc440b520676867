"""Arches of three and more stones, held by friction and thrust; statics give their weight."""

from __future__ import annotations

import itertools

import numpy as np

from fenics_contact import Contact, Load, Material
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import PLANE, Ring, held, made, modulus_of, size_of
from tests.random.scenes import Known, RandomScene


def arch(dice: Dice) -> RandomScene:
    """Of its own weight, now and then with a load on one stone."""
    elements = dice.of(*PLANE)
    number, length = dice.of(3, 3, 4, 5), size_of(dice)
    half, inner = dice.between(0.6, 1.2), dice.between(0.55, 0.75)
    ends = np.linspace(-half, half, number + 1)
    cells = (dice.whole(3, 5), dice.whole(4, 6))
    parts = tuple(
        Box(f"s{index}", (float(a), inner), (float(b), 1.0), cells)
        for index, (a, b) in enumerate(itertools.pairwise(ends))
    )
    modulus = modulus_of(dice)
    density = short(modulus / length * dice.logarithmic(1e-6, 1e-4))
    friction = {"friction_coefficient": dice.between(0.6, 1.0), "law": "static"}
    contacts = [
        Contact(f"s{index + 1}.x0", against=f"s{index}.x1", **friction)
        for index in range(number - 1)
    ]
    loads = [Load(part.name, body_force=(0.0, -density)) for part in parts]
    step = 2 * half / number / cells[0]
    area = length**2 * number * cells[0] * np.sin(step) / 2 * (1 - inner**2)
    weight = float(density * area)
    loose, known, supports = dice.chance(60), [], ()
    springings = ("s0.x0", f"s{number - 1}.x1")
    if loose:
        contacts += [Contact(side, **friction) for side in springings]
        if elements.cell == "quadrilateral":  # triangles are not those of the mirror
            thrust = ((f"{side}.vertical", weight / 2) for side in springings)
            known = [Known(name, value) for name, value in thrust]
    else:
        supports = tuple(held(side, 2) for side in springings)
        known = [Known("vertical_reaction", weight)]
    return made(
        "arch", elements, parts, Ring(length), tuple(known), "answered",
        material=Material(modulus, 0.2), support=supports, load=tuple(loads),
        contact=tuple(contacts),
    )  # fmt: skip
