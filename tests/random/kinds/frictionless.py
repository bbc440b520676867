"""Pressed without friction: the answer is that of a variational inequality, without penalty."""

from __future__ import annotations

import dataclasses

from tests.random.dice import Dice
from tests.random.scenes import RandomScene, Twin, thrown


def frictionless(dice: Dice) -> RandomScene:
    """A plane or a parabola on a flat top, of ``tests.random.scenes``."""
    random = thrown(dice, dice.of(2, 2, 3), frictionless=True)
    random = dataclasses.replace(random, kind="frictionless")
    return dataclasses.replace(random, twin=Twin(random, {"normal_force": 1.0}, exact=True))
