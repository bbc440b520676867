"""Pins in lugs: of a pin that friction alone holds, and of two eyes and a lug that is pulled."""

from __future__ import annotations

from math import pi

from fenics_contact import Contact, Load, Support
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import held, made, material_of
from tests.random.kinds.joints import (
    BORE,
    ELEMENTS,
    SPACE,
    Around,
    around,
    clearance_of,
    rubbing,
)
from tests.random.scenes import RandomScene

_TURN = 2 * pi


def pin_in_lug(dice: Dice) -> RandomScene:
    """A pin pressed against x by its weight; contact and friction hold it along z and about it."""
    elements = dice.of(*ELEMENTS)
    count, material = around(dice, elements), material_of(dice)
    clearance = clearance_of(dice, _TURN / count)
    bore, space = 1.0 + clearance, elements.dimension == 3
    heights = [((0.0,), (1.0,), (3,)), ((0.3,), (0.8,), (2,))] if space else [((), (), ())] * 2
    others = count + dice.whole(0, 3)
    (low, high, layers), (foot, top, of_lug) = heights
    parts = (
        Box("pin", (0.0, BORE, *low), (_TURN, 1.0, *high), (count, 1, *layers)),
        Box("lug", (0.0, bore, *foot), (_TURN, bore + 0.5, *top), (others, 1, *of_lug)),
    )
    weight = short(material.youngs_modulus * dice.logarithmic(1e-5, 1e-3))
    contact = Contact(
        "lug.y0",
        against="pin.y1",
        slave=dice.of("auto", "auto", "on", "against"),
        **rubbing(dice),
    )
    lowered = dice.of(1.0, 1.0, 1.0, 0.9, 0.0) * max(clearance, 0.0)
    return made(
        "assembly: pin", elements, parts, Around(short(lowered)),
        closed=("pin", "lug"), material=material, support=(held("lug.y1", elements.dimension),),
        contact=(contact,),
        load=(Load("pin", body_force=(-weight, *(0.0,) * (elements.dimension - 1))),),
    )  # fmt: skip


def clevis(dice: Dice) -> RandomScene:
    """A lug that is pulled by a pin in one or two eyes; friction keeps the pin from turning."""
    elements = dice.of(*SPACE)
    count, material = around(dice, elements), material_of(dice)
    clearance = clearance_of(dice, _TURN / count)
    bore = 1.0 + clearance
    rings = [("lug", 0.7, 1.3), ("eye_0", 0.1, 0.5)]
    if dice.chance(70):
        rings.append(("eye_1", 1.5, 1.9))
    parts = [Box("pin", (0.0, BORE, 0.0), (_TURN, 1.0, 2.0), (count, 1, 4))]
    for name, low, high in rings:
        cells = (count + dice.whole(0, 3), 1, 2)
        parts.append(Box(name, (0.0, bore, low), (_TURN, bore + 0.5, high), cells))
    friction = rubbing(dice)
    contacts = tuple(
        Contact(f"{name}.y0", against="pin.y1", name=name, **friction) for name, *_ in rings
    )
    supports = [held(f"{name}.y1", 3) for name, *_ in rings[1:]]
    if dice.chance(60) or len(rings) == 2:  # one eye alone lets the pin tilt
        supports.append(Support("lug.y1", {"y": 0.0, "z": 0.0}))
    pull = short(material.youngs_modulus * dice.logarithmic(1e-5, 1e-3))
    return made(
        "assembly: clevis", elements, tuple(parts), Around(),
        closed=tuple(part.name for part in parts), material=material, support=tuple(supports),
        contact=contacts, load=(Load("lug", body_force=(pull, 0.0, 0.0)),),
    )  # fmt: skip
