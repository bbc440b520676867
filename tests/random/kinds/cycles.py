"""Paths with cycles, and unloading to zero, where nothing is left."""

from __future__ import annotations

import dataclasses
from math import pi

from fenics_contact import Contact, Load, Obstacle, Path, Steps, Support
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    AXIAL,
    PLANE,
    SPACE,
    Turned,
    cells_of,
    friction_of,
    held,
    made,
    material_of,
    size_of,
)
from tests.random.scenes import Known, RandomScene

FROM_THE_START = Path((0,), (1,))


def cycle(dice: Dice) -> RandomScene:
    """Pressed and taken back, rubbed to and fro, loaded and unloaded; once or more."""
    elements = dice.of(*PLANE, *AXIAL, *SPACE)
    dimension, length, cycles = elements.dimension, size_of(dice), dice.of(1, 1, 2)
    sides = (1.0, *(1.0,) * (dimension - 2), dice.between(0.4, 0.9))
    body = Box("body", (0.0,) * dimension, sides, cells_of(dice, elements, *sides))
    axial = elements.kinematics == "axisymmetric"
    kinds = (_pressed, _floor) if axial else (_pressed, _rubbed, _floor, _pair)
    material = material_of(dice)
    random = dice.of(*kinds)(dice, elements, body, length, cycles, material)
    steps = Steps(dice.of(2, 4) * cycles, automatic=dice.chance(15))
    return dataclasses.replace(random, scene=dataclasses.replace(random.scene, steps=steps))


def up_and_down(cycles: int) -> Path:
    """From nothing to all and back, so many times until time 1."""
    return Path((0, 0.5 / cycles, 1 / cycles), (0, 1, 0), cycles)


def to_and_fro(cycles: int) -> Path:
    """To both sides, so many times until time 1."""
    return Path((0, 0.25 / cycles, 0.75 / cycles, 1 / cycles), (0, 1, -1, 0), cycles)


def _obstacle(dice, elements, body, length, **keys) -> tuple[Obstacle, float]:
    """Something round, flat or all over, and how deep it goes."""
    dimension, axial = elements.dimension, elements.kinematics == "axisymmetric"
    half = 0.35 * length
    radius = short(half * dice.between(4, 15))
    depth = short(half**2 / (2 * radius))
    shape = dice.of(
        "parabola" if dimension == 2 and not axial else "paraboloid", "plane", "flat punch"
    )
    size = {"plane": None, "flat punch": short(half)}.get(shape, radius)
    middle = 0.0 if axial else 0.5 * length
    place = (*(middle,) * (dimension - 1), length * body.high[-1])
    normal = (0.0,) * (dimension - 1) + (-1.0,)
    return Obstacle(
        shape, radius=size, position=place, normal=normal, indentation=depth, **keys
    ), depth


def _pressed(dice, elements, body, length, cycles, material) -> RandomScene:
    """Nothing is left at the end."""
    dimension, last = elements.dimension, AXES[elements.dimension - 1]
    obstacle, depth = _obstacle(dice, elements, body, length, path=up_and_down(cycles))
    friction = friction_of(dice)
    if friction and elements.kinematics != "axisymmetric" and dice.chance(50):
        along = (short(0.3 * depth), *(0.0,) * (dimension - 1))
        obstacle = dataclasses.replace(
            obstacle, displacement=along, displacement_path=to_and_fro(cycles)
        )
    size = material.youngs_modulus * depth * length ** (dimension - 2)
    return made(
        "unloaded", elements, (body,), Turned(length=length),
        (Known("normal_force", 0.0, size),), material=material,
        support=(held(f"body.{last}0", dimension),),
        contact=(Contact(f"body.{last}1", obstacle=obstacle, **friction),),
    )  # fmt: skip


def _rubbed(dice, elements, body, length, cycles, material) -> RandomScene:
    """Stays pressed."""
    dimension, last = elements.dimension, AXES[elements.dimension - 1]
    obstacle, depth = _obstacle(dice, elements, body, length, path=FROM_THE_START)
    friction = friction_of(dice) or {"friction_coefficient": 0.2}
    way = short(dice.between(0.2, 1.5) * friction["friction_coefficient"] * depth)
    driven = dataclasses.replace(
        obstacle,
        displacement=(way, *(0.0,) * (dimension - 1)),
        displacement_path=to_and_fro(cycles),
    )
    return made(
        "rubbed", elements, (body,), Turned(length=length), material=material,
        support=(held(f"body.{last}0", dimension),),
        contact=(Contact(f"body.{last}1", obstacle=driven, **friction),),
    )  # fmt: skip


def _floor(dice, elements, body, length, cycles, material) -> RandomScene:
    """A block on a floor; what presses and pushes it goes to zero, its weight stays or not."""
    dimension, last = elements.dimension, AXES[elements.dimension - 1]
    pressure = short(material.youngs_modulus * dice.logarithmic(1e-4, 1e-2))
    loads = [Load(f"body.{last}1", pressure=pressure, path=up_and_down(cycles))]
    weight = 0.0
    if dice.chance(70):
        density = short(0.01 * pressure / length)
        down = (0.0,) * (dimension - 1) + (-density,)
        loads.append(Load("body", body_force=down, path=FROM_THE_START))
        axial = elements.kinematics == "axisymmetric"
        base = pi * length**2 if axial else length ** (dimension - 1)
        weight = density * base * length * body.high[-1]
    supports: tuple[Support, ...] = ()
    if elements.kinematics != "axisymmetric":
        supports = (Support("body.x0", dict.fromkeys(AXES[: dimension - 1], 0.0)),)
        push = short(dice.between(0.1, 0.6) * 0.2 * pressure)
        loads.append(
            Load("body.x1", traction=(push, *(0.0,) * (dimension - 1)), path=up_and_down(cycles))
        )
    return made(
        "unloaded", elements, (body,), Turned(length=length),
        (Known("normal_force", weight, 0.01 * pressure * length ** (dimension - 1)),),
        material=material, support=supports, load=tuple(loads),
        contact=(Contact(f"body.{last}0", **friction_of(dice)),),
    )  # fmt: skip


def _pair(dice, elements, body, length, cycles, material) -> RandomScene:
    """The upper of two bodies is pressed down and taken back."""
    dimension, last = elements.dimension, AXES[elements.dimension - 1]
    low = (*(0.1,) * (dimension - 1), body.high[-1])
    high = (*(0.9,) * (dimension - 1), body.high[-1] + 0.5)
    cells = tuple(max(2, count - 1) for count in body.cells)
    depth = short(length * dice.logarithmic(5e-4, 5e-3))
    moved = dict.fromkeys(AXES[: dimension - 1], 0.0) | {last: -depth}
    size = material.youngs_modulus * depth * length ** (dimension - 2)
    return made(
        "unloaded", elements, (body, Box("upper", low, high, cells)), Turned(length=length),
        (Known("normal_force", 0.0, size),), material=material,
        support=(
            held(f"body.{last}0", dimension),
            Support(f"upper.{last}1", moved, path=up_and_down(cycles)),
        ),
        contact=(Contact(f"upper.{last}0", against=f"body.{last}1", **friction_of(dice)),),
    )  # fmt: skip
