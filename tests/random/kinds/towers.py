"""Bodies on each other: plates with gaps between them, and a round bottom in a hollow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact import Contact, Load, Path, Steps
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import AXES, Array, Turned, held, made, material_of
from tests.random.kinds.joints import ELEMENTS, across, along, clearance_of, rubbing
from tests.random.scenes import Known, RandomScene

_LATER = Path((1.0, 2.0), (0.0, 1.0))
_PLATE = 0.3


def tower(dice: Dice) -> RandomScene:
    """Two to eight plates with gaps, pressed together, then sheared by less than friction holds."""
    elements = dice.of(*ELEMENTS)
    fine, material, number = across(dice, elements), material_of(dice), dice.of(2, 3, 4, 5, 6, 8)
    space, last = elements.dimension == 3, AXES[elements.dimension - 1]
    parts, bottom = [], 0.0
    for index in range(number):
        count = max(2, fine + dice.of(-1, 0, 0, 1))
        parts.append(_box(space, f"plate_{index}", (0.5, bottom, bottom + _PLATE), (count, 1)))
        bottom += _PLATE + clearance_of(dice, 1 / fine)
    friction, force = rubbing(dice), short(material.youngs_modulus * dice.logarithmic(1e-4, 5e-3))
    contacts = tuple(
        Contact(f"plate_{index + 1}.{last}0", against=f"plate_{index}.{last}1",
                name=f"face_{index}", **friction)
        for index in range(number - 1)
    )  # fmt: skip
    # By so little that it does not tip over.
    most = min(friction["friction_coefficient"], 0.3 / bottom)
    shear = short(dice.of(0.0, dice.between(0.1, 0.9)) * most * force)
    top = f"plate_{number - 1}.{last}1"
    known = tuple(Known(f"{contact.name}.normal_force", force) for contact in contacts)
    return made(
        "assembly: tower", elements, tuple(parts), Turned(), known, "answered",
        material=material, support=(held(f"plate_0.{last}0", elements.dimension),),
        contact=contacts, steps=Steps(times=(1.0, 2.0)),
        load=(Load(top, traction=along(elements, 0.0, -force)),
              Load(top, traction=along(elements, shear, 0.0), path=_LATER)),
    )  # fmt: skip


def _box(space: bool, name: str, sizes, cells) -> Box:
    """A box about the last axis: half its width, its lower and its upper end."""
    half, low, high = sizes
    count, layers = cells
    if not space:
        return Box(name, (-half, low), (half, high), cells)
    return Box(name, (-half, -half, low), (half, half, high), (count, count, layers))


@dataclass(frozen=True)
class Hollow:
    """Boxes above the last axis' zero with a round bottom, below it with a hollow: parabolas.

    Attributes:
        body: Radius at the middle of what is above (length).
        hollow: Radius at the middle of what is below (length).
    """

    body: float
    hollow: float

    def __call__(self, points: Array) -> Array:
        radius = np.where(points[:, -1] > 0, self.body, self.hollow)
        found = points.copy()
        found[:, -1] += np.square(points[:, :-1]).sum(axis=1) / (2 * radius)
        return found


_HOLLOW = 1.5  # radius of a hollow


def rocker(dice: Dice) -> RandomScene:
    """A body with a round bottom in a hollow, pressed down and a bit sideways."""
    elements = dice.of(*ELEMENTS)
    fine, material = 2 * across(dice, elements), material_of(dice)
    space, last = elements.dimension == 3, AXES[elements.dimension - 1]
    half, wide = 0.6, 0.8
    clearance = clearance_of(dice, 2 * half / fine)  # at the edge; below zero it touches there
    body = 1 / (1 / _HOLLOW + 2 * clearance / half**2)
    lifted = 1e-6 + max(0.0, clearance_of(dice, 2 * half / fine, 0.0)) * dice.of(0, 0, 1)
    parts = [
        _box(space, "body", (half, lifted, 1.0 + lifted), (fine, 2)),
        _box(space, "hollow", (wide, -0.5, 0.0), (fine + dice.whole(0, 3), 1)),
    ]
    friction = rubbing(dice)
    contacts = [Contact(f"body.{last}0", against=f"hollow.{last}1", name="seat", **friction)]
    top = f"body.{last}1"
    force = short(material.youngs_modulus * dice.logarithmic(1e-5, 2e-3))
    push = dice.of(0.0, dice.between(0.02, 0.2)) * friction["friction_coefficient"]
    return made(
        "assembly: rocker", elements, tuple(parts), Hollow(body, _HOLLOW), (),
        material=material, support=(held(f"hollow.{last}0", elements.dimension),),
        contact=tuple(contacts), steps=Steps(times=(1.0, 2.0)),
        load=(Load(top, traction=along(elements, 0.0, -force)),
              Load(top, traction=along(elements, short(push * force), 0.0), path=_LATER)),
    )  # fmt: skip
