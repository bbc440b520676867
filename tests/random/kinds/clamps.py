"""A shaft between two half shells, which two clips press together by bolts, then twisted."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from math import pi

import numpy as np

from fenics_contact import Contact, Load, Path, Preload, Profile, Steps
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import Array, held, made, material_of
from tests.random.kinds.joints import BORE, ELEMENTS, around, clearance_of, rubbing
from tests.random.scenes import RandomScene

# Half of the angle that is open between the shells, angle of their lugs, radii of shells and lugs.
_OPEN, _LUG, _OUTER, _RIM = 0.15, 0.5, 1.6, 2.2
_FREE = 0.1  # between a lug and the shank


@dataclass(frozen=True)
class Shells:
    """Boxes of angles and radii: rings up to a radius, and what is further out straight along x."""

    def __call__(self, points: Array) -> Array:
        angle, radius, *height = points.T
        inside = np.minimum(radius, _OUTER)
        beyond = np.sign(np.cos(angle)) * np.maximum(radius - _OUTER, 0.0)
        return np.stack([inside * np.cos(angle) + beyond, -inside * np.sin(angle), *height], axis=1)


def clamp(dice: Dice) -> RandomScene:
    """Twisted by less than friction holds, at once or once it is tightened."""
    elements = dice.of(*ELEMENTS)
    count, material = around(dice, elements), material_of(dice)
    clearance = clearance_of(dice, 2 * pi / count)
    space, half = elements.dimension == 3, count // 2
    bore, fine = 1.0 + clearance, 3 if space else 4
    shaft = _ring(space, "shaft", (0.0, 2 * pi), (BORE, 1.0), (count, 1), 3)
    parts, welded = [shaft], []
    for name, middle in (("over", pi / 2), ("under", 3 * pi / 2)):
        body, lugs = _shell(space, name, middle, bore, half, fine)
        parts += [body, *lugs]
        welded.append((body.name, *(lug.name for lug in lugs)))
    friction = rubbing(dice)
    fits = tuple(
        Contact(f"{name}.y0", against="shaft.y1", name=name, **friction)
        for name in ("over", "under")
    )
    contacts, bolts = list(fits), []
    force = short(material.youngs_modulus * dice.logarithmic(1e-5, 1e-3))
    for name, middle in (("right", 0.0), ("left", pi)):
        clip = _clip(space, name, middle, _width(half), fine)
        parts += clip
        welded.append(tuple(box.name for box in clip))
        first, last = (("under_last", "over_first"), ("over_last", "under_first"))[middle > 0]
        seats = {"before": ("x1", f"{first}.x0"), "after": ("x0", f"{last}.x1")}
        contacts += [
            Contact(f"{name}_{end}.{side}", against=lug, name=f"{name}_{end}", **friction)
            for end, (side, lug) in seats.items()
        ]
        bolts.append(
            Preload(f"{name}_shank", (0, 1, 0)[: elements.dimension], force, locked_from=1.0)
        )
    twist = _twist(dice.of(0.0, dice.between(0.05, 0.6)) * friction["friction_coefficient"] * force)
    random = made(
        "assembly: clamp", elements, tuple(parts), Shells(), closed=("shaft",), material=material,
        support=(held("under.y1", elements.dimension),), contact=tuple(contacts),
        preload=tuple(bolts), steps=Steps(times=(1.0, 2.0)),
        load=(Load("shaft", body_force=(*twist, 0.0)[: elements.dimension],
                   path=Path((1.0, 2.0), (0.0, 1.0))),),
    )  # fmt: skip
    return dataclasses.replace(random, welded=tuple(welded))


def _twist(share: float) -> tuple[Profile, Profile]:
    """A body force about the axis of a shaft of length 1, whose moment is four times this force.

    So much friction holds at least: both clips press both shells on.
    """
    rate = 2 * short(4 * share / (pi / 2 * (1 - BORE**4)))
    return Profile("y", (-2, 2), (rate, -rate)), Profile("x", (-2, 2), (-rate, rate))


def _ring(space: bool, name: str, angles, radii, cells, layers: int) -> Box:
    """A piece of a ring; in space of height 1."""
    (a, b), (low, high) = angles, radii
    if not space:
        return Box(name, (a, low), (b, high), cells)
    return Box(name, (a, low, 0.0), (b, high, 1.0), (*cells, layers))


def _width(half: int) -> float:
    """Angle of a lug: of whole cells of a shell of so many."""
    step = 2 * (pi / 2 - _OPEN) / half
    return max(1, round(_LUG / step)) * step


def _shell(space: bool, name: str, middle: float, bore: float, half: int, fine: int):
    """Half a shell about the shaft, and its two lugs, whose cells match."""
    side, wide = pi / 2 - _OPEN, _width(half)
    body = _ring(space, name, (middle - side, middle + side), (bore, _OUTER), (half, 1), 2)
    count = round(wide * half / (2 * side))
    ends = {
        "first": (middle - side, middle - side + wide),
        "last": (middle + side - wide, middle + side),
    }
    lugs = [
        _ring(space, f"{name}_{end}", angles, (_OUTER, _RIM), (count, fine), 2)
        for end, angles in ends.items()
    ]
    return body, lugs


def _clip(space: bool, name: str, middle: float, wide: float, fine: int) -> list[Box]:
    """A shank beside two lugs, and its two arms."""
    reach, thick = _OPEN + wide, 0.4
    out = (_RIM + _FREE, _RIM + _FREE + 0.4)
    boxes = [_ring(space, f"{name}_shank", (middle - reach, middle + reach), out, (4, 1), 2)]
    for end, (a, b) in {
        "before": (middle - reach - thick, middle - reach),
        "after": (middle + reach, middle + reach + thick),
    }.items():
        boxes.append(_ring(space, f"{name}_{end}", (a, b), (_OUTER + 0.1, out[0]), (2, fine), 2))
        boxes.append(_ring(space, f"{name}_{end}_end", (a, b), out, (2, 1), 2))
    return boxes
