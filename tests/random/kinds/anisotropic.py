"""Elastic tensors: cubic and orthotropic ones, turned; isotropic ones against the two numbers."""

from __future__ import annotations

import dataclasses
from itertools import product

import numpy as np

from fenics_contact import Contact, Material, Obstacle
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    Array,
    Elements,
    Turned,
    cells_of,
    friction_of,
    held,
    made,
    modulus_of,
    size_of,
)
from tests.random.scenes import RandomScene, Twin

ELEMENTS = (
    Elements("plane strain", "quadrilateral", 2),
    Elements("plane stress", "quadrilateral", 1),
    Elements("plane strain", "triangle", 1),
    Elements("3D", "hexahedron", 1),
)
_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
SAME = ("normal_force", "friction_force", "strain_energy", "max_contact_pressure", "contact_area")


def anisotropic(dice: Dice) -> RandomScene:
    """Something round is pressed onto a block."""
    elements = dice.of(*ELEMENTS)
    dimension, length = elements.dimension, size_of(dice)
    sides = (1.0, *(1.0,) * (dimension - 2), dice.between(0.4, 0.9))
    body = Box("body", (0.0,) * dimension, sides, cells_of(dice, elements, *sides))
    modulus, last = modulus_of(dice), AXES[dimension - 1]
    half = 0.35 * length
    radius = short(half * dice.between(4, 15))
    obstacle = Obstacle(
        "parabola" if dimension == 2 else "paraboloid",
        radius=radius,
        position=(*(0.5 * length,) * (dimension - 1), length * sides[-1]),
        indentation=short(half**2 / (2 * radius)),
    )
    keys = {
        "support": (held(f"body.{last}0", dimension),),
        "contact": (Contact(f"body.{last}1", obstacle=obstacle, **friction_of(dice)),),
    }
    shape, twin = Turned(length=length), None
    if dice.chance(30):
        poisson = dice.of(0.0, 0.2, 0.3, 0.45)
        plain = Material(modulus, poisson)
        stiffness = _isotropic(modulus, poisson)
        other = made("isotropic", elements, (body,), shape, material=plain, **keys)
        twin = Twin(other, dict.fromkeys(SAME, 1.0))
    else:
        stiffness = _turned(_orthotropic(dice, modulus), dice)
    rows = tuple(tuple(row) for row in stiffness.tolist())
    found = made("anisotropy", elements, (body,), shape, material=Material(stiffness=rows), **keys)
    return dataclasses.replace(found, twin=twin)


def _isotropic(modulus: float, poisson: float) -> Array:
    shear = modulus / (2 * (1 + poisson))
    lame = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson))
    stiffness = np.diag([2.0 * shear] * 3 + [shear] * 3)
    stiffness[:3, :3] += lame
    return stiffness


def _orthotropic(dice: Dice, modulus: float) -> Array:
    """Of three moduli, ratios small enough, and three shear moduli."""
    moduli = [modulus * dice.logarithmic(0.2, 5) for _ in range(3)]
    compliance = np.diag([1 / value for value in moduli] + [0.0] * 3)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        compliance[i, j] = compliance[j, i] = -dice.between(0, 0.35) / np.sqrt(
            moduli[i] * moduli[j]
        )
    for row in (3, 4, 5):
        compliance[row, row] = 1 / (modulus * dice.logarithmic(0.1, 1))
    return np.linalg.inv(compliance)


def _turned(stiffness: Array, dice: Dice) -> Array:
    """About z: planes of the model stay planes of the material."""
    angle = dice.between(0, 3.1)
    cosine, sine = np.cos(angle), np.sin(angle)
    rotation = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    tensor = np.zeros((3, 3, 3, 3))
    for (row, (i, j)), (column, (k, m)) in product(enumerate(_PAIRS), enumerate(_PAIRS)):
        for (a, b), (c, d) in product({(i, j), (j, i)}, {(k, m), (m, k)}):
            tensor[a, b, c, d] = stiffness[row, column]
    tensor = np.einsum("ia,jb,kc,ld,abcd->ijkl", *[rotation] * 4, tensor)
    matrix = np.array([[tensor[i, j, k, m] for k, m in _PAIRS] for i, j in _PAIRS])
    return 0.5 * (matrix + matrix.T)
