"""Halves and quarters that supports hold in place of planes of symmetry."""

from __future__ import annotations

import dataclasses
from math import pi

from fenics_contact import Contact, Support
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import Elements, Ring, friction_of, made, material_of, size_of
from tests.random.kinds.symmetric import symmetric
from tests.random.scenes import RandomScene, Twin

ELEMENTS = (
    Elements("plane strain", "quadrilateral", 2, order=2),
    Elements("plane stress", "quadrilateral", 2, order=2),
    Elements("plane strain", "triangle", 2, order=2),
    Elements("3D", "hexahedron", 2, order=2),
)
SAME = (
    *("normal_force", "pressure_integral", "max_contact_pressure", "contact_area"),
    *("strain_energy", "friction_work"),
)


def quarter(dice: Dice) -> RandomScene:
    """The scene with supports; its twin has the planes."""
    planes = _press_fit(dice) if dice.chance(60) else symmetric(dice)
    sides = planes.scene.symmetry
    supports = tuple(Support(side, {_across(side): 0.0}) for side in sides)
    scene = dataclasses.replace(
        planes.scene, symmetry=(), support=(*planes.scene.support, *supports)
    )
    twin = Twin(dataclasses.replace(planes, twin=None), dict.fromkeys(SAME, 1.0))
    return dataclasses.replace(
        planes, scene=scene, twin=twin, kind=f"supports: {planes.kind}", must_be="answered"
    )


def _across(side: str) -> str:
    """The axis across a plane of symmetry: sides of rings lie at angles of 0 and 90 degrees."""
    body, axis = side.split(".")
    if body in ("shaft", "hub"):
        return {"x0": "x", "x1": "y", "z0": "z", "z1": "z"}[axis]
    return axis[0]


def _press_fit(dice: Dice) -> RandomScene:
    """A quarter of a shaft in a hub, with an overlap; in space half of its length."""
    elements, length = dice.of(*ELEMENTS), size_of(dice)
    space = elements.dimension == 3
    bore, outside = dice.between(0.3, 0.6), dice.between(1.4, 2.0)
    cells = (4, 2) if space else (dice.whole(6, 14), dice.whole(2, 4))
    start, end, layers = ((0.0,), (0.6,), (2,)) if space else ((), (), ())
    parts = (
        Box("shaft", (0.0, bore, *start), (pi / 2, 1.0, *end), (*cells, *layers)),
        Box("hub", (0.0, 1.0, *start), (pi / 2, outside, *end), (cells[0] + 1, cells[1], *layers)),
    )
    contact = Contact(
        "shaft.y1",
        against="hub.y0",
        interference=short(1e-3 * length),
        slave=dice.of("auto", "on", "against"),
        **friction_of(dice),
    )
    sides = ("x0", "x1", "z0") if space else ("x0", "x1")
    planes = tuple(f"{name}.{side}" for name in ("shaft", "hub") for side in sides)
    return made(
        "press fit", elements, parts, Ring(length), material=material_of(dice),
        contact=(contact,), symmetry=planes,
    )  # fmt: skip
