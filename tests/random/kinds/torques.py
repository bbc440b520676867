"""Torques at .9 to 1.1 of what friction holds: shafts in hubs, blocks that are turned."""

from __future__ import annotations

from math import asinh, pi, sqrt

import numpy as np

from fenics_contact import Contact, Load, Path, Profile, Steps, Support
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    Elements,
    Ring,
    Turned,
    held,
    made,
    material_of,
    size_of,
)
from tests.random.scenes import RandomScene

FITS = (
    Elements("plane strain", "quadrilateral", 2, order=2),
    Elements("plane stress", "quadrilateral", 2, order=2),
    Elements("plane strain", "triangle", 2, order=2),
    Elements("3D", "hexahedron", 2, order=2),
    Elements("3D", "tetrahedron", 2, order=2),
)
BLOCK = Elements("3D", "hexahedron", 1)
SHARES = (0.9, 0.95, 0.98, 1.02, 1.05, 1.1)
# ∫ r dA over a square of side 1, r from its middle.
_MEAN_ARM = (sqrt(2) + asinh(1)) / 6


def torque(dice: Dice) -> RandomScene:
    """Held below the limit; beyond it refused, not converged or not trusted."""
    return _block(dice) if dice.chance(30) else _fit(dice)


def _must_be(share: float) -> str:
    return "answered" if share < 1 else "refused"


def _turning(rate: float, length: float) -> tuple[Profile, Profile]:
    """A traction of this rate times the distance from the middle, along x and y."""
    at = (-length, length)
    along_x = Profile("y", at, (-rate * length, rate * length))
    along_y = Profile("x", at, (rate * length, -rate * length))
    return along_x, along_y


def _fit(dice: Dice) -> RandomScene:
    """A hollow shaft, too large for a hub that is held outside, turned at its bore."""
    elements, length, share = dice.of(*FITS), size_of(dice), dice.of(*SHARES)
    space = elements.dimension == 3
    bore, outside = dice.between(0.3, 0.6), dice.between(1.4, 2.0)
    around = 12 if space else dice.whole(20, 32)
    across = (2, 1) if space else (dice.whole(3, 4), dice.whole(2, 3))
    end, layers = ((0.5,), (1,)) if space else ((), ())
    start = (0.0,) * len(end)
    parts = (
        Box("shaft", (0.0, bore, *start), (2 * pi, 1.0, *end), (around, across[0], *layers)),
        Box("hub", (0.0, 1.0, *start), (2 * pi, outside, *end), (around, across[1], *layers)),
    )
    material = material_of(dice)
    coefficient = dice.between(0.05, 0.3)
    overlap = short(1e-3 * length)
    stress_free = elements.kinematics == "plane stress"
    pressure = _pressure(material, (bore, outside), overlap / length, stress_free)
    # The moments of the traction at the bore, and of friction at the fit.
    rate = share * coefficient * pressure / (bore**3 * length)
    ends = [Support(f"{name}.z{end}", {"z": 0.0}) for name in ("shaft", "hub") for end in (0, 1)]
    turning = _turning(rate, length)
    contact = Contact(
        "shaft.y1",
        against="hub.y0",
        interference=overlap,
        friction_coefficient=coefficient,
        law=dice.of("static", "incremental"),
    )
    load = Load(
        "shaft.y0",
        traction=(*turning, 0.0) if space else turning,
        path=Path((1, 2), (0, 1)),
    )
    return made(
        f"torque on a fit, {share}", elements, parts, Ring(length), (), _must_be(share),
        closed=("shaft", "hub"), material=material,
        support=(held("hub.y1", elements.dimension), *(ends if space else ())),
        load=(load,), contact=(contact,), steps=Steps(times=(1.0, 1.5, 2.0)),
    )  # fmt: skip


def _pressure(material, radii, overlap, stress_free) -> float:
    """Of a fit of radius 1 whose hub is held outside: G. Lamé's u = a r + b/r in both rings."""
    young, ratio = material.youngs_modulus, material.poissons_ratio
    shear = young / (2 * (1 + ratio))
    lame = young * ratio / ((1 + ratio) * (1 - 2 * ratio))
    if stress_free:
        lame = 2 * lame * shear / (lame + 2 * shear)
    bore, outside = radii
    # σ_r = 2(λ + G) a − 2G b/r²; unknown are a and b of the shaft, a and b of the hub.
    stiff, soft = 2 * (lame + shear), 2 * shear
    matrix = np.array(
        [
            [stiff, -soft / bore**2, 0, 0],
            [0, 0, outside, 1 / outside],
            [stiff, -soft, -stiff, soft],
            [-1, -1, 1, 1],
        ]
    )
    a, b = np.linalg.solve(matrix, [0, 0, 0, overlap])[:2]
    return float(-(stiff * a - soft * b))


def _block(dice: Dice) -> RandomScene:
    """A block under a pressure that is given, turned at its top about the middle."""
    length, share = size_of(dice), dice.of(0.9, 0.95, 1.05, 1.1)
    height, cells = dice.between(0.3, 0.8), dice.whole(5, 7)
    half = (-0.5, -0.5)
    body = Box("body", (*half, 0.0), (0.5, 0.5, height), (cells, cells, 3))
    material = material_of(dice)
    pressure = short(material.youngs_modulus * dice.logarithmic(1e-5, 1e-3))
    coefficient = dice.between(0.1, 0.6)
    rate = share * coefficient * pressure * 6 * _MEAN_ARM / length
    contact = Contact(
        "body.z0",
        pressure=pressure,
        friction_coefficient=coefficient,
        law=dice.of("static", "incremental"),
    )
    return made(
        f"torque on a block, {share}", BLOCK, (body,), Turned(length=length), (), _must_be(share),
        material=material, support=(Support("body.z1", {"z": 0.0}),),
        load=(Load("body.z1", traction=(*_turning(rate, length), 0.0)),), contact=(contact,),
    )  # fmt: skip
