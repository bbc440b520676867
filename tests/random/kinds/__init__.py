"""Scenes at random of kinds that ``tests.random.scenes.draw`` does not draw: one file a kind."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from tests.random.dice import SeededDice
from tests.random.kinds.anisotropic import anisotropic
from tests.random.kinds.arches import arch
from tests.random.kinds.assemblies import assembly
from tests.random.kinds.common import completed
from tests.random.kinds.conformal import conformal
from tests.random.kinds.corners import corner
from tests.random.kinds.coupled import coupled
from tests.random.kinds.curved import curved
from tests.random.kinds.cycles import cycle
from tests.random.kinds.driven import two_driven
from tests.random.kinds.frictionless import frictionless
from tests.random.kinds.half_spaces import half_space
from tests.random.kinds.heated import conducting, heated
from tests.random.kinds.inclines import incline
from tests.random.kinds.layers import layers
from tests.random.kinds.quarters import quarter
from tests.random.kinds.rollers import bearing
from tests.random.kinds.small_obstacles import small_obstacle
from tests.random.kinds.stacks import stack
from tests.random.kinds.symmetric import symmetric
from tests.random.kinds.thin import thin
from tests.random.kinds.torques import torque
from tests.random.scenes import RandomScene, draw

KINDS = {
    "corner": corner,
    "stack": stack,
    "arch": arch,
    "incline": incline,
    "conformal": conformal,
    "layers": layers,
    "two driven": two_driven,
    "half-space": half_space,
    "symmetry": symmetric,
    "anisotropy": anisotropic,
    "order 2": curved,
    "cycles": cycle,
    "frictionless": frictionless,
    "torque": torque,
    "small obstacle": small_obstacle,
    "thin": thin,
    "bearing": bearing,
    "quarter": quarter,
    "assembly": assembly,
    "coupled": coupled,
    "heated": heated,
    "conducting": conducting,
}
_OTHERS = 4  # one scene in so many is of the kinds of tests.random.scenes


def draw_any(seed: int, number: int, kinds: Sequence[str] = (), errors: str = "all") -> RandomScene:
    """The scene of a number: of all kinds in turn.

    Args:
        seed: Of all.
        number: Of this one.
        kinds: Of which it is, in turn; by default of all, and of those of ``tests.random.scenes``.
        errors: Those that are estimated, with each solver.
    """
    if kinds:
        return with_errors(draw_kind(kinds[number % len(kinds)], seed, number), errors)
    if number % _OTHERS == _OTHERS - 1:
        return with_errors(draw(seed, number), errors)
    turn = number - number // _OTHERS
    return with_errors(draw_kind(list(KINDS)[turn % len(KINDS)], seed, number), errors)


def with_errors(random: RandomScene, errors: str) -> RandomScene:
    """The scene, with errors that are estimated as is said.

    Args:
        random: The scene.
        errors: As its ``solver.errors``.
    """
    settings = dataclasses.replace(random.scene.solver, errors=errors)
    return dataclasses.replace(random, scene=dataclasses.replace(random.scene, solver=settings))


def draw_kind(name: str, seed: int, number: int) -> RandomScene:
    """A scene of a kind.

    Args:
        name: Of the kind.
        seed: Of all.
        number: Of this one.
    """
    dice = SeededDice(seed, number)
    return completed(dice, KINDS[name](dice))
