"""Lives by Smith, Watson and Topper of blocks in tension and in shear, to and fro."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq

from fenics_contact.analyses.fretting.table import FatigueLimits, Fretting, StrainLifeLine
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.scene import Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Finding, solved

_YOUNGS_MODULUS, _AMPLITUDE = 200e3, 300.0
_LINE = StrainLifeLine(900.0, -0.09, 0.4, -0.6)
_LIMITS = FatigueLimits(torsion=250.0, tension=400.0)
_TO_AND_FRO = Path(time=(0, 1, 3, 4), factor=(0, 1, -1, 0))


def _block(ratio: float, loads: tuple[Load, ...]) -> tuple[Scene, Body]:
    """A block that is bonded to the ground, so that the stress is the same all over."""
    scene = Scene(
        kinematics="plane stress",
        material=(Material(_YOUNGS_MODULUS, ratio),),
        load=loads,
        contact=(Contact("block.y0", contact="bonded"),),
        steps=Steps(number=4, end=4),
        cycles=Cycles(end=4, increments=8, number=2),
        solver=SolverSettings(errors="none"),
        fretting=Fretting(depth=0.6, limits=_LIMITS, life=_LINE),
    )
    return scene, boxes((Box("block", (0.0, 0.0), (2.0, 1.0), (4, 2)),))


def findings(quick: bool) -> Iterator[Finding]:
    """Of tension with ν = 0, which the ground does not hinder, and of shear with ν = .3."""
    pull = (Load("block.y1", traction=(0.0, _AMPLITUDE), path=_TO_AND_FRO),)
    sides = {"y1": (1.0, 0.0), "x1": (0.0, 1.0), "x0": (0.0, -1.0)}
    shear = tuple(
        Load(f"block.{side}", traction=(_AMPLITUDE * x, _AMPLITUDE * y), path=_TO_AND_FRO)
        for side, (x, y) in sides.items()
    )
    limit = _LIMITS.torsion
    for words, ratio, loads, factor in (
        ("tension", 0.0, pull, limit / _AMPLITUDE * _LIMITS.tension / limit),
        ("torsion", 0.3, shear, limit / _AMPLITUDE),
    ):
        scene, body = _block(ratio, loads)
        result = solved(scene, body)
        assert result.fretting is not None
        worst = result.fretting.worst
        parameter = _AMPLITUDE**2 * (1 + ratio) / _YOUNGS_MODULUS
        life = worst["swt"].life
        assert life is not None
        yield Finding(f"swt, {words}", worst["swt"].value, parameter, 1e-6)
        yield Finding(f"life, {words}", life, _known_life(parameter), 1e-5)
        for name in ("crossland", "dang_van"):
            found = worst[name].safety_factor
            assert found is not None
            yield Finding(f"safety factor by {name}, {words}", found, factor, 1e-6)


def _known_life(parameter: float) -> float:
    """N of (s²/E)(2N)^{2b} + s e (2N)^{b+c}, by bisection."""
    line = _LINE
    b, c = line.strength_exponent, line.ductility_exponent

    def missing(logarithm: float) -> float:
        reversals = 2 * np.exp(logarithm)
        elastic = line.strength**2 / _YOUNGS_MODULUS * reversals ** (2 * b)
        plastic = line.strength * line.ductility * reversals ** (b + c)
        return float(elastic + plastic - parameter)

    return float(np.exp(brentq(missing, 0.0, 60.0, xtol=1e-13)))
