"""Assemblies of two to eight solids: bolts, clips, clamps, pins, towers and rockers."""

from __future__ import annotations

from tests.random.dice import Dice
from tests.random.kinds.bolts import bolted_plates, clipped_plates
from tests.random.kinds.clamps import clamp
from tests.random.kinds.pins import clevis, pin_in_lug
from tests.random.kinds.towers import rocker, tower
from tests.random.scenes import RandomScene

ASSEMBLIES = {
    "bolt": bolted_plates,
    "clips": clipped_plates,
    "clamp": clamp,
    "pin": pin_in_lug,
    "clevis": clevis,
    "tower": tower,
    "rocker": rocker,
}


def assembly(dice: Dice) -> RandomScene:
    """One of them; friction alone holds something of each."""
    return dice.of(*ASSEMBLIES.values())(dice)
