"""Thin parts that bend: two leaves, a strip on a cylinder, an axisymmetric plate."""

from __future__ import annotations

import dataclasses
from math import sqrt

from fenics_contact import Contact, Load, Obstacle
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    Elements,
    Turned,
    friction_of,
    held,
    made,
    material_of,
    size_of,
)
from tests.random.kinds.small_obstacles import Graded
from tests.random.scenes import RandomScene, Twin

CELLS = (("quadrilateral", 2), ("quadrilateral", 1), ("triangle", 2), ("triangle", 1))
SAME = ("normal_force", "pressure_integral", "strain_energy", "indentation", "external_work")


def thin(dice: Dice) -> RandomScene:
    """Of a length of 20 to 100 thicknesses, on one to four cells across."""
    kind = dice.of(_leaves, _leaves, _strip, _plate)
    kinematics = "axisymmetric" if kind is _plate else dice.of("plane strain", "plane stress")
    elements = Elements(kinematics, *dice.of(*CELLS))
    length, thickness = size_of(dice), 1 / dice.of(20, 40, 100)
    return kind(dice, elements, length, thickness)


def _strips(dice: Dice, thickness: float, names: tuple[str, ...]) -> tuple[Box, ...]:
    """On top of each other, from y = 0."""
    across, along = dice.whole(1, 4), dice.whole(20, 60)
    return tuple(
        Box(name, (0.0, k * thickness), (1.0, (k + 1) * thickness), (along + 7 * k, across))
        for k, name in enumerate(names)
    )


def _with_twin(kind, elements, parts, length, shape=None, **keys) -> RandomScene:
    """With the same on cells of degree 2, four and more across; these may have their own shape."""
    fine = Elements(elements.kinematics, "quadrilateral", 2)
    finer = tuple(
        dataclasses.replace(part, cells=(3 * part.cells[0], max(4, part.cells[1])))
        for part in parts
    )
    own = Turned(length=length)
    twin = Twin(made("finer", fine, finer, shape or own, **keys), dict.fromkeys(SAME, 1.0))
    return made(kind, elements, parts, own, (), "answered", twin=twin, **keys)


def _leaves(dice, elements, length, thickness) -> RandomScene:
    """Clamped at one end, the upper one loaded at the other."""
    parts = _strips(dice, thickness, ("lower", "upper"))
    material = material_of(dice)
    # Deflects by .01 of the length or less.
    shear = -short(material.youngs_modulus * thickness**2 * dice.logarithmic(1e-5, 1e-2))
    return _with_twin(
        "thin leaves", elements, parts, length, material=material,
        support=tuple(held(f"{part.name}.x0", 2) for part in parts),
        load=(Load("upper.x1", traction=(0.0, shear)),),
        contact=(Contact("upper.y0", against="lower.y1", **friction_of(dice)),),
    )  # fmt: skip


def _strip(dice, elements, length, thickness) -> RandomScene:
    """Clamped at both ends, pressed by a roller somewhere between."""
    parts = _strips(dice, thickness, ("strip",))
    radius = short(length * thickness * dice.between(2, 20))
    place = (length * dice.between(0.3, 0.7), length * thickness)
    depth = short(length * thickness * dice.logarithmic(1e-3, 0.3))
    obstacle = Obstacle("cylinder", radius=radius, position=place, indentation=depth)
    return _with_twin(
        "thin strip", elements, parts, length, material=material_of(dice),
        support=(held("strip.x0", 2), held("strip.x1", 2)),
        contact=(Contact("strip.y1", obstacle=obstacle, **friction_of(dice)),),
    )  # fmt: skip


def _plate(dice, elements, length, thickness) -> RandomScene:
    """Round, clamped at its rim, pressed at its middle by a sphere."""
    parts = _strips(dice, thickness, ("plate",))
    radius = short(length * thickness * dice.between(5, 40))
    depth = short(length * thickness * dice.logarithmic(1e-3, 0.3))
    place = (0.0, length * thickness)
    obstacle = Obstacle("sphere", radius=radius, position=place, indentation=depth)
    touching = sqrt(radius * depth) / length
    graded = Graded((0.0, thickness), touching, thickness, length)
    return _with_twin(
        "thin plate", elements, parts, length, graded, material=material_of(dice),
        support=(held("plate.x1", 2),),
        contact=(Contact("plate.y1", obstacle=obstacle, **friction_of(dice)),),
    )  # fmt: skip
