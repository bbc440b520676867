"""Loads by masses and by moments: rotors, a tube that twists, a beam whose end is rigid.

Stresses of discs that rotate in plane stress, of the density ρ at the angular velocity ω (S. P.
Timoshenko and J. N. Goodier, Theory of Elasticity, 1970, Section 32).
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, sqrt
from typing import Any

import numpy as np

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.records.contacts import CouplingRecord
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Point
from fenics_contact.scene.loading.couplings import Coupling
from fenics_contact.scene.loading.inertia_kinds import Rotation
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.verification.boxes import Box, boxes, quarter_rings
from fenics_contact.verification.case import Case, Finding, solved

_MODULUS, _RATIO, _DENSITY = 210e3, 0.3, 7.85e-9  # MPa, -, t/mm³
_BORE, _RIM = 20.0, 40.0
_INTERFERENCE = 0.0024
_RPM = 2 * pi / 60
_SPEED = 10_000.0  # rpm
_STEEL = Material(_MODULUS, _RATIO, density=_DENSITY)
# Of the thickness of discs in axisymmetric models, over their radius: nearly plane stress.
_THIN = 1 / 40


def _centrifugal(speed: float) -> float:
    """ρ ω² at a speed in rpm (force/volume over length)."""
    return _DENSITY * (speed * _RPM) ** 2


def bore_stress(speed: float) -> float:
    """Hoop stress at the bore of a ring (stress).

    Args:
        speed: In rpm.
    """
    return _centrifugal(speed) / 4 * ((3 + _RATIO) * _RIM**2 + (1 - _RATIO) * _BORE**2)


def centre_stress(speed: float) -> float:
    """Stress at the centre of a solid disc (stress).

    Args:
        speed: In rpm.
    """
    return (3 + _RATIO) / 8 * _centrifugal(speed) * _RIM**2


def fit_pressure(speed: float) -> float:
    """Pressure between a solid shaft and a hub of the same material, fitted at rest (stress).

    Args:
        speed: In rpm.
    """
    at_rest = _MODULUS * _INTERFERENCE / (2 * _BORE) * (1 - (_BORE / _RIM) ** 2)
    return at_rest * (1 - (speed / lift_off()) ** 2)


def lift_off() -> float:
    """Speed at which the hub comes off the shaft (rpm): ω₀² = 4 E δ/(ρ b (3 + ν) c²)."""
    square = 4 * _MODULUS * _INTERFERENCE / (_DENSITY * _BORE * (3 + _RATIO) * _RIM**2)
    return sqrt(square) / _RPM


def _ring(cells: int) -> float:
    """Hoop stress at the bore of a ring by the displacement there, E u/b (stress)."""
    body = quarter_rings([Box("ring", (_BORE, 0), (_RIM, 1), (cells, cells))])
    scene = Scene(
        kinematics="plane stress",
        material=(_STEEL,),
        symmetry=("ring.y0", "ring.y1"),
        load=(Load("ring", rotation=Rotation(_SPEED * _RPM)),),
        point=(Point("bore", (_BORE, 0.0)),),
    )
    return float(_MODULUS * solved(scene, body).quantities["displacement_bore"][0] / _BORE)


def disc(speed: float, cells: int, is_fitted: bool) -> tuple[Scene, Body]:
    """A thin solid disc that rotates, of one piece or a shaft in a hub, and its mesh.

    Args:
        speed: In rpm.
        cells: Along the radius of either part.
        is_fitted: Whether it is a hub with interference on its shaft.
    """
    thickness = _THIN * _RIM
    parts = (
        Box("shaft", (0.0, 0.0), (_BORE, thickness), (cells, 1)),
        Box("hub", (_BORE, 0.0), (_RIM, thickness), (cells, 1)),
    )
    names = [part.name for part in parts]
    fit = Contact("shaft.x1", against="hub.x0", interference=_INTERFERENCE)
    rotation = Rotation(speed * _RPM, axis=(0.0, 1.0))
    scene = Scene(
        kinematics="axisymmetric",
        material=(_STEEL,),
        support=tuple(Support(f"{name}.y0", {"y": 0.0}) for name in names),
        load=tuple(Load(name, rotation=rotation) for name in names) if speed else (),
        contact=(fit,) if is_fitted else (),
        point=() if is_fitted else tuple(Point(f"at{r:g}", (r, 0.0)) for r in _RADII),
    )
    return scene, boxes(parts, welded=() if is_fitted else (names,))


_RADII = (5.0, 10.0)


def _centre(cells: int) -> float:
    """Stress at the centre of a disc: E A/(1 − ν), of u = A r − B r³ by two points (stress)."""
    found = solved(*disc(_SPEED, cells, is_fitted=False)).quantities
    strains = [found[f"displacement_at{radius:g}"][0] / radius for radius in _RADII]
    squares = np.square(_RADII)
    linear = (strains[0] * squares[1] - strains[1] * squares[0]) / (squares[1] - squares[0])
    return float(_MODULUS * linear / (1 - _RATIO))


def _fit(speed: float, cells: int) -> float:
    """Mean pressure of a fit (stress)."""
    thickness = _THIN * _RIM
    found = solved(*disc(speed, cells, is_fitted=True)).quantities["pressure_integral"]
    return float(found / (2 * pi * _BORE * thickness))


def _rotor(quick: bool) -> Iterator[Finding]:
    cells = 6 if quick else 12
    yield Finding("hoop stress at the bore of a ring", _ring(cells), bore_stress(_SPEED), 1e-3)
    yield Finding("stress at the centre of a disc", _centre(cells), centre_stress(_SPEED), 1e-3)
    pressures = {speed: _fit(speed, cells) for speed in (0.0, _SPEED)}
    for speed, value in pressures.items():
        reference = fit_pressure(speed)
        yield Finding(f"pressure of a fit at {speed:g} rpm", value, reference, 2e-3)
    left = 1 - pressures[_SPEED] / pressures[0.0]
    yield Finding("speed of lift-off", _SPEED / sqrt(left), lift_off(), 1e-2)
    beyond = _fit(1.01 * lift_off(), cells)
    yield Finding("pressure at 1.01 of that speed", beyond, 0.0, 1e-9, absolute=True)


ROTOR_CASES: tuple[Case, ...] = (
    Case(
        "rotor",
        "a ring, a disc and a shrunk hub that rotate, up to where the hub comes off",
        "S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 1970, Section 32, and G. Lamé's "
        "pressure",
        _rotor,
    ),
)


_LENGTH, _TORQUE = 60.0, 50e3


def _twist(quick: bool) -> Iterator[Finding]:
    around = 12 if quick else 24
    part = Box("tube", (0.0, _BORE, 0.0), (2 * pi, _RIM, _LENGTH), (around, 2, 4))
    body = boxes([part], "hexahedron", order=2, closed=("tube",))
    places = body.mesh.geometry.x
    angle, radius = places[:, 0].copy(), places[:, 1].copy()
    places[:, 0], places[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    scene = Scene(
        kinematics="3D",
        material=(_STEEL,),
        support=(Support("tube.z0", {"x": 0.0, "y": 0.0, "z": 0.0}),),
        load=(Load("tube.z1", moment=(0.0, 0.0, _TORQUE)),),
        point=(Point("rim", (_RIM, 0.0, _LENGTH)),),
    )
    found = solved(scene, body).quantities["displacement_rim"]
    stiffness = _MODULUS / (2 * (1 + _RATIO)) * pi / 2 * (_RIM**4 - _BORE**4)
    twist = _TORQUE * _LENGTH / stiffness
    yield Finding("angle of twist", float(found[1] / _RIM), twist, 1e-3)
    yield Finding("lengthening", float(found[2] / _LENGTH), 0.0, 1e-3 * twist, absolute=True)


SHAFT_TORQUE_CASES: tuple[Case, ...] = (
    Case(
        "shaft_torque",
        "a hollow shaft that a torque twists",
        "C. A. Coulomb's M L/(G J): S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, "
        "1970, Section 101",
        _twist,
    ),
)


# Of the bar whose end is rigid.
_SIDE, _SPAN = 10.0, 100.0
_AREA, _BENDING = _SIDE**2, _MODULUS * _SIDE**4 / 12
# Of a square section, by the shear modulus at ν = 0: 6/5 over G A.
_SHEAR = 1.2 / (_MODULUS / 2 * _AREA)
_FORCE, _MOMENT, _SINKS = 1000.0, 1e5, 0.2


def _end(cells: int = 20, **given: Any) -> CouplingRecord:
    """The rigid end of a bar along x that is clamped at the other one, without lateral contraction.

    Args:
        cells: Along the bar.
        **given: Of its coupling.
    """
    scene = Scene(
        kinematics="3D",
        material=(Material(_MODULUS, 0.0),),
        support=(Support("bar.x0", {"x": 0.0, "y": 0.0, "z": 0.0}),),
        coupling=(Coupling("bar.x1", **given),),
    )
    bar = Box("bar", (0.0, 0.0, 0.0), (_SPAN, _SIDE, _SIDE), (cells, 2, 2))
    return solved(scene, boxes([bar], "hexahedron")).couplings[0]


def tip_sag(force: float) -> float:
    """Sag of a cantilever under a force at its end, P L³/(3 E I) + 6 P L/(5 G A) (length).

    Args:
        force: P.
    """
    return force * (_SPAN**3 / (3 * _BENDING) + _SHEAR * _SPAN)


def _loaded_end(quick: bool) -> Iterator[Finding]:
    pulled = _end(force=(_FORCE, 0.0, 0.0))
    expected = _FORCE * _SPAN / (_MODULUS * _AREA)
    yield Finding("elongation", pulled.displacement[0], expected, 1e-10)
    bent = _end(moment=(0.0, 0.0, _MOMENT))
    yield Finding("rotation by a moment", bent.rotation[2], _MOMENT * _SPAN / _BENDING, 1e-8)
    sag = _MOMENT * _SPAN**2 / (2 * _BENDING)
    yield Finding("sag by a moment", bent.displacement[1], sag, 1e-8)
    tip = _end(force=(0.0, _FORCE, 0.0)).displacement[1]
    yield Finding("sag by a force", tip, tip_sag(_FORCE), 6e-4)


def _moved_end(quick: bool) -> Iterator[Finding]:
    across = {"x": 0.0, "y": _SINKS, "z": 0.0}
    hinge = _end(displacement=across)
    yield Finding("force of a hinge that sinks", hinge.force[1], _SINKS / tip_sag(1.0), 1e-3)
    clamp = _end(displacement=across, rotation={"x": 0.0, "y": 0.0, "z": 0.0})
    force = _SINKS / (_SPAN**3 / (12 * _BENDING) + _SHEAR * _SPAN)
    yield Finding("force of a clamp that sinks", clamp.force[1], force, 2e-3)
    yield Finding("moment of a clamp that sinks", clamp.moment[2], -force * _SPAN / 2, 2e-3)


def _rigid_end(quick: bool) -> Iterator[Finding]:
    yield from _loaded_end(quick)
    yield from _moved_end(quick)


COUPLING_CASES: tuple[Case, ...] = (
    Case(
        "coupling",
        "a beam whose end is rigid, loaded, held and moved at a point",
        "beams with shear: S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 1970, "
        "Sections 21 and 113",
        _rigid_end,
    ),
)
