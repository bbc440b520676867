"""Heat by conduction against formulas: a pipe, and two bars that conduct by their pressure."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Point
from fenics_contact.scene.loading.heat import Conductance, Heat
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import Scene, SolverSettings
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

LENGTH, HEIGHT = 100.0, 10.0
_COLD = 20.0  # at which bars are free of stress
#: Conductance over pressure of the bars: .01 at 10 (MPa).
_GROWTH = 1e-3
_MODULI, _ALPHAS, _CONDUCTIVITIES = (210e3, 70e3), (12e-6, 23e-6), (0.05, 0.2)
_NO_ERRORS = SolverSettings(errors="none")


def bars(
    walls: Sequence[float],
    gap: float,
    conductance: float | Conductance | None = None,
    **more: Any,
) -> tuple[Scene, Body]:
    """Two bars between walls with a gap, which expand along their axis alone, and their mesh.

    Args:
        walls: Temperatures of both walls.
        gap: Between the bars, as they are drawn (length).
        conductance: Of their contact; by default proportional to the pressure.
        **more: Further keys of the scene.
    """
    left = Box("a", (0, 0), (LENGTH, HEIGHT), (4, 1))
    right = Box("b", (LENGTH + gap, 0), (2 * LENGTH + gap, HEIGHT), (5, 2))
    materials = tuple(
        Material(
            modulus,
            0.0,
            on=name,
            thermal_expansion=(alpha, 0, 0),
            reference_temperature=_COLD,
            conductivity=conductivity,
        )
        for name, modulus, alpha, conductivity in zip(
            "ab", _MODULI, _ALPHAS, _CONDUCTIVITIES, strict=True
        )
    )
    growing = Conductance(pressures=(0, 1000), values=(0, 1000 * _GROWTH))
    contact = Contact(
        "a.x1", against="b.x0", conductance=conductance or growing, penalty_parameter=1e-10
    )
    given = {"solver": _NO_ERRORS, "contact": (contact,), **more}
    scene = Scene(
        kinematics="plane stress",
        material=materials,
        support=(
            *(Support(side, {"x": 0.0}) for side in ("a.x0", "b.x1")),
            *(Support(side, {"y": 0.0}) for side in ("a.y0", "b.y0")),
        ),
        heat=(Heat("a.x0", temperature=walls[0]), Heat("b.x1", temperature=walls[1])),
        **given,
    )
    return scene, boxes([left, right])


def flux(walls: Sequence[float], conductance: float) -> float:
    """Heat flow over area from the first wall to the second, of resistances in series."""
    resistance = sum(LENGTH / one for one in _CONDUCTIVITIES) + 1 / conductance
    return (walls[0] - walls[1]) / resistance


def pressures(walls: Sequence[float], gap: float) -> Array:
    """All pressures > 0 at which two bars that conduct by their pressure are in balance, sorted.

    With the flux q = ΔT/(R + 1/(c p)), p Σ L/E = Σ α L θ − gap of their mean rises θ of temperature
    is a quadratic equation in p.

    Args:
        walls: Temperatures of both walls.
        gap: Between the bars, as they are drawn (length).
    """
    resistance = sum(LENGTH / one for one in _CONDUCTIVITIES)
    apart = sum(alpha * LENGTH * (wall - _COLD) for alpha, wall in zip(_ALPHAS, walls, strict=True))
    by_flux = sum(
        sign * alpha * LENGTH**2 / (2 * conductivity)
        for sign, alpha, conductivity in zip((-1, 1), _ALPHAS, _CONDUCTIVITIES, strict=True)
    )
    softness = sum(LENGTH / modulus for modulus in _MODULI)
    free, flow = apart - gap, by_flux * (walls[0] - walls[1])
    found = np.roots(
        [
            softness * resistance * _GROWTH,
            softness - (free * resistance + flow) * _GROWTH,
            -free,
        ]
    )
    return np.sort(found[(found.imag == 0) & (found.real > 0)].real)


def _bars() -> Iterator[Finding]:
    walls, gap = (120.0, 20.0), 0.05
    result = solved(*bars(walls, gap))
    (pressure,) = pressures(walls, gap)
    found = result.quantities["normal_force"] / HEIGHT
    yield Finding("pressure of two bars", found, pressure, 1e-6)
    flow = -result.quantities["heat_flow"] / HEIGHT
    yield Finding("flux from one to the other", flow, flux(walls, _GROWTH * pressure), 1e-5)
    walls, gap = (20.0, 120.0), 0.24
    scene, body = bars(walls, gap)
    every = dataclasses.replace(_NO_ERRORS, branches=True)
    result = solved(dataclasses.replace(scene, solver=every), body)
    forces = sorted(branch.quantities["normal_force"] / HEIGHT for branch in result.branches)
    expected = [0.0, *pressures(walls, gap)]
    yield Finding("answers beyond a gap", len(forces), len(expected), 0.0, absolute=True)
    for words, force, pressure in zip(
        ("barely", "pressed"), forces[1:], expected[1:], strict=False
    ):
        yield Finding(f"pressure of bars that are {words} in touch", force, pressure, 1e-5)


def pipe(inner: float, outer: float, rise: float, cells: int) -> tuple[Scene, Body]:
    """A long pipe that is hot inside, with points at its bore, its rim and between, and its mesh.

    Args:
        inner: Radius of the bore (length).
        outer: That of the rim (length).
        rise: Of the temperature at the bore.
        cells: From one to the other.
    """
    middle = (inner + outer) / 2
    places = {"bore": inner, "rim": outer, "middle": middle}
    scene = Scene(
        kinematics="axisymmetric",
        material=(Material(210e3, 0.3, thermal_expansion=12e-6, conductivity=0.05),),
        support=(Support("pipe.y0", {"y": 0.0}), Support("pipe.y1", {"y": 0.0})),
        heat=(Heat("pipe.x0", temperature=rise), Heat("pipe.x1", temperature=0)),
        point=tuple(Point(name, (radius, 1.0)) for name, radius in places.items()),
        solver=_NO_ERRORS,
    )
    return scene, boxes([Box("pipe", (inner, 0), (outer, 2), (cells, 2))])


def hoop_stresses(inner: float, outer: float, rise: float) -> tuple[float, float]:
    """Stress around a long pipe that is hotter inside, at its bore and at its rim (stress).

    S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, article 151; the arguments are those
    of ``pipe``.
    """
    ratio, squares = math.log(outer / inner), outer**2 / (outer**2 - inner**2)
    size = 210e3 * 12e-6 * rise / (2 * (1 - 0.3) * ratio)
    return size * (1 - 2 * squares * ratio), size * (1 - 2 * (squares - 1) * ratio)


def _pipe(cells: int) -> Iterator[Finding]:
    sizes = 20.0, 40.0, 60.0
    result = solved(*pipe(*sizes, cells))
    inner, outer, rise = sizes
    temperature = rise * math.log(2 * outer / (inner + outer)) / math.log(outer / inner)
    found = result.quantities
    yield Finding("temperature in a pipe", found["temperature_middle"], temperature, 1e-5)
    for name, stress in zip(("bore", "rim"), hoop_stresses(*sizes), strict=True):
        yield Finding(f"stress around its {name}", found[f"stress_{name}_zz"], stress, 0.01)


def _heat(quick: bool) -> Iterator[Finding]:
    yield from _pipe(24 if quick else 48)
    yield from _bars()


HEAT_CASES: tuple[Case, ...] = (
    Case(
        "heat",
        "a pipe that is hot inside, and bars that conduct by the pressure on each other",
        "S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 1970, article 151; resistances "
        "in series, and a quadratic equation of the pressure",
        _heat,
    ),
)
