"""Plates with a bolt through them, and plates that clips hold together at their edges."""

from __future__ import annotations

import dataclasses
import itertools
from math import pi

from fenics_contact import Contact, Load, Preload
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import AXES, Turned, held, made, material_of
from tests.random.kinds.joints import (
    BORE,
    ELEMENTS,
    SPACE,
    Around,
    across,
    along,
    around,
    clearance_of,
    rubbing,
)
from tests.random.scenes import Known, RandomScene

_TURN = 2 * pi


def bolted_plates(dice: Dice) -> RandomScene:
    """Two to four rings and a bolt through them, pushed sideways by less than friction holds."""
    elements = dice.of(*SPACE)
    count, material = around(dice, elements), material_of(dice)
    clearance = clearance_of(dice, _TURN / count, 0.01)
    hole = 1.0 + clearance
    head, wide = 2.0, dice.of(2.0, 2.5, 3.0)
    plates = 2 if elements.degree == 2 else dice.of(2, 2, 3, 4)
    thick, fine = 2.0 / plates, 2 if elements.degree == 2 else 4
    bolt = [
        Box("shank", (0.0, BORE, 0.0), (_TURN, 1.0, 2.0), (count, 1, 2)),
        Box("nut", (0.0, BORE, -0.5), (_TURN, 1.0, 0.0), (count, 1, 1)),
        Box("nut_rim", (0.0, 1.0, -0.5), (_TURN, head, 0.0), (count, fine, 1)),
        Box("head", (0.0, BORE, 2.0), (_TURN, 1.0, 2.5), (count, 1, 1)),
        Box("head_rim", (0.0, 1.0, 2.0), (_TURN, head, 2.5), (count, fine, 1)),
    ]
    rings = []
    for number in range(plates):
        low, high = (0.0, hole, number * thick), (_TURN, wide, (number + 1) * thick)
        cells = (count + dice.whole(0, 3), fine, 1)
        rings.append(Box(f"plate_{number}", low, high, cells))
    top, friction = rings[-1].name, rubbing(dice)
    force = short(material.youngs_modulus * dice.logarithmic(1e-5, 1e-2))
    pairs = {
        f"face_{number}": (f"{above.name}.z0", f"{below.name}.z1")
        for number, (below, above) in enumerate(itertools.pairwise(rings))
    }
    pairs |= {"nut": ("nut_rim.z1", "plate_0.z0"), "head": ("head_rim.z0", f"{top}.z1")}
    # A shank that touches the hole carries some of the force by friction.
    is_clear = clearance >= 0.1 * _TURN / count
    known = tuple(Known(f"{name}.normal_force", force) for name in pairs) * is_clear
    pairs |= {"hole": (f"{top}.y0", "shank.y1")}
    volume = pi * (wide**2 - hole**2) * thick
    coefficient = friction["friction_coefficient"]
    push = short(coefficient * force * dice.of(0.0, dice.between(0.05, 0.6)) / volume)
    parts = (*bolt, *rings)
    random = made(
        "assembly: bolt", elements, parts, Around(), known,
        closed=tuple(part.name for part in parts), material=material,
        support=(held("plate_0.y1", 3),), contact=_contacts(pairs, friction),
        load=(Load(top, body_force=(push, 0.0, 0.0)),),
        preload=(Preload("shank", (0, 0, 1), force),),
    )  # fmt: skip
    return dataclasses.replace(random, welded=(tuple(part.name for part in bolt),))


def _contacts(pairs: dict[str, tuple[str, str]], friction: dict) -> tuple[Contact, ...]:
    return tuple(
        Contact(on, against=other, name=name, **friction) for name, (on, other) in pairs.items()
    )


_THICK, _REACH, _WIDE = 0.5, 0.5, 1.5


def clipped_plates(dice: Dice) -> RandomScene:
    """Two to six plates on a foot, which one or two clips press together at their edges."""
    elements = dice.of(*ELEMENTS)
    material, fine = material_of(dice), across(dice, elements)
    plates, sides = dice.of(2, 2, 3, 4, 6), dice.of((1,), (1, -1))
    space = elements.dimension == 3
    clearance = clearance_of(dice, 1 / fine, 0.0)
    friction = rubbing(dice)
    boxes, pairs = [_box(space, "foot", (-0.5, -1.0), (0.5, 0.0), fine, 2)], {}
    for number in range(plates):
        low, high = number * _THICK, (number + 1) * _THICK
        # Cells of neighbours do not match; those of the lowest match those of its foot.
        count = 3 * fine + (dice.whole(0, 2) if number else 0)
        boxes.append(_box(space, f"plate_{number}", (-_WIDE, low), (_WIDE, high), count, 1))
    for number in range(plates - 1):
        pairs[f"face_{number}"] = _faces(elements, f"plate_{number + 1}", 0, f"plate_{number}", 1)
    top, up, welded = f"plate_{plates - 1}", plates * _THICK, [("foot", "plate_0")]
    force = short(material.youngs_modulus * dice.logarithmic(1e-5, 1e-3))
    bolts = []
    for side in sides:
        clip = _clip(space, side, clearance, up, fine)
        boxes += clip
        welded.append(tuple(box.name for box in clip))
        pairs[f"nut{side}"] = _faces(elements, f"low{side}", 1, "plate_0", 0)
        pairs[f"head{side}"] = _faces(elements, f"high{side}", 0, top, 1)
        inner, outer = (0, 1) if side > 0 else (1, 0)
        pairs[f"edge{side}"] = (f"shank{side}.x{inner}", f"{top}.x{outer}")
        bolts.append(Preload(f"shank{side}", along(elements, 0, 1), force))
    # A shank that touches a plate carries some of the force by friction.
    known = [(f"face_{number}", len(sides) * force) for number in range(plates - 1)]
    known += [(f"{end}{side}", force) for side in sides for end in ("nut", "head")]
    known = [Known(f"{name}.normal_force", value) for name, value in known]
    known *= clearance >= 0.1 / fine
    # Pushed away from the clip, lest the shank carries what is pushed.
    size = 2 * _WIDE * _THICK
    holds = len(sides) * force * friction["friction_coefficient"]
    push = short(holds * dice.of(0.0, dice.between(0.05, 0.6)) / size)
    random = made(
        "assembly: clips", elements, tuple(boxes), Turned(), tuple(known),
        material=material, support=(held(f"foot.{_last(elements)}0", elements.dimension),),
        contact=_contacts(pairs, friction), preload=tuple(bolts),
        load=(Load(top, body_force=along(elements, -push, 0.0)),),
    )  # fmt: skip
    return dataclasses.replace(random, welded=tuple(welded))


def _last(elements) -> str:
    return AXES[elements.dimension - 1]


def _faces(elements, above: str, end: int, below: str, other: int) -> tuple[str, str]:
    last = _last(elements)
    return f"{above}.{last}{end}", f"{below}.{last}{other}"


def _box(space: bool, name: str, low, high, count: int, layers: int) -> Box:
    """A box of the first and the last axis; in space of depth 1."""
    if not space:
        return Box(name, low, high, (count, layers))
    return Box(name, (low[0], 0.0, low[1]), (high[0], 1.0, high[1]), (count, 2, layers))


def _clip(space: bool, side: int, clearance: float, up: float, fine: int) -> list[Box]:
    """A shank beside the plates and two arms over them, at the right (1) or the left (-1)."""
    inner = _WIDE + clearance
    spans = {"arm": (_WIDE - _REACH, inner), "end": (inner, inner + 0.4)}
    boxes = [_mirrored(space, side, f"shank{side}", spans["end"], (0.0, up), 1, 4)]
    count = max(4, fine)
    for name, heights in (("low", (-0.6, 0.0)), ("high", (up, up + 0.6))):
        boxes.append(_mirrored(space, side, f"{name}{side}", spans["arm"], heights, count, 2))
        boxes.append(_mirrored(space, side, f"{name}_end{side}", spans["end"], heights, 1, 2))
    return boxes


def _mirrored(space, side, name, span, heights, count, layers) -> Box:
    low, high = sorted(side * end for end in span)
    return _box(space, name, (low, heights[0]), (high, heights[1]), count, layers)
