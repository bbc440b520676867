"""Temperatures against formulas: shrink fits, a clamped bar, a disc, a bolt in a warm joint.

All bodies are free of stress at 0 degrees, and of steel but where it is said otherwise.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from math import pi

from fenics_contact.analyses.derivatives.record import Derivative
from fenics_contact.analyses.derivatives.table import DerivativeRequest
from fenics_contact.mesh.tagged_mesh import Body, Group
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Point, Preload
from fenics_contact.scene.loading.couplings import Coupling
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.loading.temperatures import Temperature
from fenics_contact.scene.scene import Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

_MODULUS, _RATIO, _ALPHA = 210e3, 0.3, 12e-6  # MPa, -, 1/K
_STEEL = Material(_MODULUS, _RATIO, thermal_expansion=_ALPHA)
_SETTINGS = SolverSettings(errors="all")
_DIFFERENCE = 100.0  # K

_RADIUS, _OUTER, _HIGH = 20.0, 40.0, 5.0  # of the fits
# ε₁ of derivatives (length/stress), which is to add less than 1e-6 to what the parts give.
_HARD = 1e-12


def fit_pressure(colder: float, is_long: bool) -> float:
    """Pressure of a cold hub on a solid shaft of the same material (stress).

    E α ΔT (c² − b²)/(2 c²), in plane strain over 1 − ν.

    Args:
        colder: By how much the hub is (temperature).
        is_long: Whether neither can become longer, which is plane strain.
    """
    stress = _MODULUS * _ALPHA * colder * (1 - (_RADIUS / _OUTER) ** 2) / 2
    return stress / (1 - _RATIO) if is_long else stress


def shrink_fit(is_long: bool, cells: int, penalty: float | None = None) -> tuple[Scene, Body]:
    """A solid shaft in a cold hub, and their mesh.

    Args:
        is_long: Whether neither can become longer.
        cells: Along the radius of either.
        penalty: ε₁, and derivatives by the temperature; None without these (length/stress).
    """
    parts = (
        Box("shaft", (0.0, 0.0), (_RADIUS, _HIGH), (cells, 2)),
        Box("hub", (_RADIUS, 0.0), (_OUTER, _HIGH), (cells, 2 if penalty else 3)),
    )
    ends = (0, 1) if is_long else (0,)
    by = DerivativeRequest(of=("pressure_integral",), by=("temperature.0.value",))
    scene = Scene(
        kinematics="axisymmetric",
        material=(_STEEL,),
        temperature=(Temperature("hub", value=-_DIFFERENCE),),
        support=tuple(Support(f"{part.name}.y{end}", {"y": 0.0}) for part in parts for end in ends),
        contact=(
            Contact("shaft.x1", against="hub.x0", law="none", penalty_parameter=penalty or "auto"),
        ),
        solver=SolverSettings(errors="none") if penalty else _SETTINGS,
        derivatives=by if penalty else None,
    )
    return scene, boxes(parts)


def _fits(cells: int) -> Iterator[Finding]:
    area = 2 * pi * _RADIUS * _HIGH
    for is_long, name in ((False, "plane stress"), (True, "plane strain")):
        result = solved(*shrink_fit(is_long, cells))
        mean = result.quantities["pressure_integral"] / area
        bar = _bar(result, "pressure_integral") / area
        expected = fit_pressure(_DIFFERENCE, is_long)
        yield _within(f"pressure of a shrink fit, {name}", mean, expected, bar)
        slopes = solved(*shrink_fit(is_long, 4 * cells, _HARD)).derivatives
        slope = _slope(slopes["pressure_integral"]) / -area
        expected = fit_pressure(1.0, is_long)
        yield Finding(f"dp/dΔT by the adjoint, {name}", slope, expected, 1e-6)


def _clamped_bar() -> Finding:
    scene = Scene(
        kinematics="plane stress",
        material=(_STEEL,),
        temperature=(Temperature(value=_DIFFERENCE),),
        support=(
            *(Support(f"bar.x{end}", {"x": 0.0}) for end in (0, 1)),
            Support("bar.y0", {"y": 0.0}),
        ),
        point=(Point("inside", (1.3, 0.8)),),
        solver=_SETTINGS,
    )
    result = solved(scene, boxes([Box("bar", (0.0, 0.0), (3.0, 2.0), (3, 2))]))
    stress = result.quantities["stress_inside_xx"]
    return Finding("stress in a clamped bar", stress, -_MODULUS * _ALPHA * _DIFFERENCE, 1e-9)


_DISC, _THICKNESS = 30.0, 0.5


def hot_disc(cells: int) -> tuple[Scene, Body]:
    """A thin free disc with T = ΔT (1 − r²/R²), and its mesh.

    Args:
        cells: Along its radius.
    """
    scene = Scene(
        kinematics="axisymmetric",
        material=(_STEEL,),
        temperature=(Temperature(value=lambda x: _DIFFERENCE * (1 - (x[0] / _DISC) ** 2)),),
        support=(Support("disc.y0", {"y": 0.0}),),
        point=(Point("centre", (0.0, _THICKNESS / 2)), Point("rim", (_DISC, _THICKNESS / 2))),
        solver=_SETTINGS,
    )
    return scene, boxes([Box("disc", (0.0, 0.0), (_DISC, _THICKNESS), (cells, 1))])


def _disc(cells: int) -> Iterator[Finding]:
    """−E α ΔT/4 at the centre; around the rim twice as much, pulling; stresses have no bars."""
    result = solved(*hot_disc(cells))
    found, size = result.quantities, _MODULUS * _ALPHA * _DIFFERENCE / 4
    yield Finding("stress at the centre of a hot disc", found["stress_centre_xx"], -size, 2e-3)
    yield Finding("hoop stress at its rim", found["stress_rim_zz"], 2 * size, 2e-3)
    # The formula is of a disc without thickness, which is some 1e-2 of the radius here.
    moved, expected = float(found["displacement_rim"][0]), _ALPHA * _DIFFERENCE * _DISC / 2
    yield Finding("displacement of its rim", moved, expected, 2e-4)


def _temperature(quick: bool) -> Iterator[Finding]:
    cells = 4 if quick else 8
    yield _clamped_bar()
    yield from _fits(cells)
    yield from _disc(6 * cells)


# Of the joint: bars of ν = 0 and this length, with their stiffness (force/length) and expansion.
_LENGTH, _WARMER = 40.0, 80.0
_BARS = {"bolt": (210e3, 2e5, 12e-6), "plate": (70e3, 8e5, 23e-6)}
_TIGHTENED = 20e3


def more_force(warmer: float) -> float:
    """Force that a bolt gains in a warm joint, (α_p − α_b) ΔT L/(1/k_b + 1/k_p) (force).

    Args:
        warmer: By how much all of it is (temperature).
    """
    (_, bolt, of_bolt), (_, plate, of_plate) = _BARS.values()
    return (of_plate - of_bolt) * warmer * _LENGTH / (1 / bolt + 1 / plate)


def warm_joint() -> tuple[Scene, Body]:
    """A bolt beside the plate that it clamps, and their mesh: both on the ground, under a head.

    The bolt is tightened and locked in the first load step, and all becomes warm in the second one.
    """
    parts, start = [], 0.0
    for name, (modulus, stiffness, _) in _BARS.items():
        width = stiffness * _LENGTH / modulus
        parts.append(Box(name, (start, 0.0), (start + width, _LENGTH), (2, 2)))
        start += width + 10.0
    body = boxes(parts)
    tops = [tag for name in _BARS for tag in body.groups[f"{name}.y1"].tags]
    groups = dict(body.groups) | {"under the head": Group(1, tuple(tops))}
    scene = Scene(
        kinematics="plane stress",
        material=tuple(
            Material(modulus, 0.0, on=name, thermal_expansion=alpha)
            for name, (modulus, _, alpha) in _BARS.items()
        ),
        temperature=(Temperature(value=_WARMER, path=Path(time=(1, 2), factor=(0, 1))),),
        support=tuple(Support(f"{name}.y0", {"x": 0.0, "y": 0.0}) for name in _BARS),
        coupling=(
            Coupling("under the head", name="head", displacement={"x": 0.0}, rotation={"z": 0.0}),
        ),
        preload=(Preload("bolt", (0, 1), _TIGHTENED, path=Path((0, 1), (0, 1)), locked_from=1.0),),
        steps=Steps(times=(1.0, 2.0)),
        solver=_SETTINGS,
        derivatives=DerivativeRequest(of=("bolt.y0.reaction_y",), by=("temperature.0.value",)),
    )
    return scene, dataclasses.replace(body, groups=groups)


def _joint(quick: bool) -> Iterator[Finding]:
    result = solved(*warm_joint())
    first, last = (step.preloads["bolt"].force for step in result.steps)
    yield Finding("force of the bolt, cold", first, _TIGHTENED, 1e-9)
    yield Finding("more force when warm", last - first, more_force(_WARMER), 1e-9)
    slope = -_slope(result.derivatives["bolt.y0.reaction_y"])
    yield Finding("dF/dT by the adjoint", slope, more_force(1.0), 1e-6)


def _slope(by: Mapping[str, Derivative]) -> float:
    """Derivative of the discrete answer by the temperature; not a number without one."""
    found = by["temperature.0.value"].discrete
    return math.nan if found is None else found


def _bar(result: Result, name: str) -> float:
    """Error bar of a quantity; not a number if it has none, so that no error is within it."""
    bar = result.errors.get(name, {}).get("total")
    return math.nan if bar is None else bar


def _within(label: str, value: float, reference: float, bar: float) -> Finding:
    """Held to its error bar, and that to 2 % of the reference."""
    tolerance = min(bar, 0.02 * abs(reference))
    return Finding(label, value, reference, tolerance, absolute=True, bar=bar)


TEMPERATURE_CASES: tuple[Case, ...] = (
    Case(
        "temperature",
        "shrink fits by temperature, a clamped bar that is warm, a disc that is hot inside",
        "G. Lamé's pressure; S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 1970, "
        "Chapter 13",
        _temperature,
    ),
    Case(
        "temperature_joint",
        "a bolt of steel in a joint of aluminium that becomes warm",
        "the joint diagram (VDI 2230) for bars in parallel",
        _joint,
    ),
)
