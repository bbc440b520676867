"""Halves and quarters with planes of symmetry, against the whole."""

from __future__ import annotations

import dataclasses

from fenics_contact import Contact, Obstacle, Steps, Support
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    Elements,
    Turned,
    cells_of,
    friction_of,
    held,
    made,
    material_of,
    size_of,
)
from tests.random.scenes import RandomScene, Twin

# Cells that are their own mirror images.
ELEMENTS = (
    Elements("plane strain", "quadrilateral", 2),
    Elements("plane stress", "quadrilateral", 1),
    Elements("3D", "hexahedron", 1),
)
SHARED = ("normal_force", "pressure_integral", "contact_area", "strain_energy", "friction_work")
EQUAL = ("max_contact_pressure", "max_slip", "indentation")


def symmetric(dice: Dice) -> RandomScene:
    """Something pressed onto the middle of a body or a pair, by a force or a way."""
    elements = dice.of(*ELEMENTS)
    dimension, length, pair = elements.dimension, size_of(dice), dice.chance(35)
    names = ("body", "upper") if pair else ("body",)
    spans = (*(1.0,) * (dimension - 1), dice.between(0.4, 0.9))
    cells = cells_of(dice, elements, *spans)
    materials = tuple(material_of(dice, on=name) for name in names)
    last = AXES[dimension - 1]
    keys, total = _driven(dice, dimension, length, materials[-1].youngs_modulus, spans, pair)
    friction = friction_of(dice)
    planes = tuple(f"{name}.{axis}0" for name in names for axis in AXES[: dimension - 1])
    contacts: tuple[Contact, ...] = ()
    if pair:
        contacts = (Contact(f"upper.{last}0", against=f"body.{last}1", **friction),)
    else:
        contacts = (Contact(f"body.{last}1", obstacle=Obstacle(**keys), **friction),)
    supports = [held(f"body.{last}0", dimension)]
    if pair:
        down = -short(length * 2e-3)
        supports.append(
            Support(f"upper.{last}1", dict.fromkeys(AXES[: dimension - 1], 0.0) | {last: down})
        )
    share = 0.5 ** (dimension - 1)
    parts = tuple(_box(name, number, dimension, spans, cells) for number, name in enumerate(names))
    twins = tuple(_mirrored(part) for part in parts)
    scene = {"material": materials, "support": tuple(supports), "steps": Steps(dice.of(1, 2))}
    shape = Turned(length=length)
    whole = made("whole", elements, twins, shape, contact=contacts, **scene)
    if total:
        obstacle = Obstacle(**keys | {"force": short(share * total)})
        whole_obstacle = Obstacle(**keys | {"force": short(share * total) / share})
        contacts = (dataclasses.replace(contacts[0], obstacle=obstacle),)
        twin_contact = dataclasses.replace(contacts[0], obstacle=whole_obstacle)
        whole = dataclasses.replace(
            whole, scene=dataclasses.replace(whole.scene, contact=(twin_contact,))
        )
    factors = dict.fromkeys(SHARED, share) | dict.fromkeys(EQUAL, 1.0)
    return made(
        "symmetry", elements, parts, shape, twin=Twin(whole, factors),
        contact=contacts, symmetry=planes, **scene,
    )  # fmt: skip


def _driven(dice, dimension, length, modulus, spans, pair):
    """Keys of an obstacle in the middle of the whole; its force on the whole, 0 without."""
    half = 0.4 * length
    radius = short(half * dice.between(3, 12))
    depth = short(half**2 / (2 * radius))
    shape = dice.of("parabola" if dimension == 2 else "paraboloid", "flat punch")
    keys = {
        "shape": shape,
        "radius": short(half) if shape == "flat punch" else radius,
        "position": (*(0.0,) * (dimension - 1), length * spans[-1]),
    }
    if not pair and dice.chance(40):
        force = short(modulus * depth * half ** (dimension - 2))
        return keys | {"force": force}, force
    return keys | {"indentation": depth}, 0.0


def _box(name, number, dimension, spans, cells):
    """The part at positive coordinates, on top of those before."""
    bottom = number * spans[-1]
    low, high = (0.0,) * (dimension - 1), spans[:-1]
    coarser = cells if number == 0 else tuple(max(2, count - 1) for count in cells)
    return Box(name, (*low, bottom), (*high, bottom + spans[-1]), coarser)


def _mirrored(part: Box) -> Box:
    low = (*(-value for value in part.high[:-1]), part.low[-1])
    cells = (*(2 * count for count in part.cells[:-1]), part.cells[-1])
    return Box(part.name, low, part.high, cells)
