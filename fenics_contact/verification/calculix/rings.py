"""Sectors of rings around x: rotating, warm, pulled and twisted.

Inputs with reduced integration (``C3D20R``, ``CAX8R``) have two cells from a bore of 0.1 to a rim
of 1; there, scenes have four times as many along each axis, since full integration needs them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import cos, pi, radians, sin, sqrt
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.conditions import Load, Point
from fenics_contact.scene.loading.cyclic_symmetry import CyclicSymmetry
from fenics_contact.scene.loading.inertia_kinds import Rotation
from fenics_contact.scene.loading.support_axes import SupportAxes
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.loading.temperatures import Temperature
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.settings import SolverSettings
from fenics_contact.scene.values import Value
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.calculix.stated import STEEL, SUITE
from fenics_contact.verification.case import Case, Finding, solved

_AXIS = (1.0, 0.0, 0.0)
_BORE = 0.1
# Of coarse cells with reduced integration, at a bore where strain is steep, and of cells like ours.
_COARSE, _STEEP, _SAME = 5e-3, 3e-2, 2e-4
_FREE = SolverSettings(stabilisation=True, errors="none")
# A place in a sector: along the axis, radius and angle (degrees).
_Place = tuple[float, float, float]


def _sector(
    sectors: int, low: Sequence[float], high: Sequence[float], cells: tuple[int, int, int]
) -> Body:
    """One of several sectors of a ring: ``ring.z0`` and ``ring.z1`` are its cut faces.

    Args:
        sectors: In a turn.
        low: Along the axis and along the radius.
        high: Likewise.
        cells: Along the axis, the radius and the angle.
    """
    part = Box("ring", (*low, 0.0), (*high, 1.0), cells)
    body = boxes([part], "hexahedron", order=2)
    places = body.mesh.geometry.x
    radius, angle = places[:, 1].copy(), 2 * pi / sectors * places[:, 2]
    places[:, 1], places[:, 2] = radius * np.cos(angle), radius * np.sin(angle)
    return body


def _cut(sectors: int) -> CyclicSymmetry:
    return CyclicSymmetry("ring.z0", "ring.z1", sectors=sectors, axis=_AXIS)


def _turning(square: float) -> Load:
    """The load of a rotation, by the square of its speed, as inputs of CalculiX give it."""
    return Load("ring", rotation=Rotation(sqrt(square), axis=_AXIS))


def _of_ring(body: Body, places: Sequence[_Place], **given: Any) -> Result:
    """The answer of a ring, with points ``at0``, ``at1``, … at the places."""
    points = tuple(
        Point(f"at{number}", (along, radius * cos(radians(angle)), radius * sin(radians(angle))))
        for number, (along, radius, angle) in enumerate(places)
    )
    parts: dict[str, Any] = {"material": (STEEL,), "solver": _FREE}
    return solved(Scene(kinematics="3D", point=points, **parts | given), body)


def _around(result: Result, number: int, angle: float) -> Array:
    """Displacement of a point along the axis, along the radius and around (length)."""
    along, y, z = result.quantities[f"displacement_at{number}"]
    turned = radians(angle)
    return np.array([along, y * cos(turned) + z * sin(turned), z * cos(turned) - y * sin(turned)])


def _widening(
    label: str, result: Result, places: Sequence[_Place], reference: Sequence[float]
) -> Iterator[Finding]:
    """Displacements along the radius.

    Args:
        label: The input.
        result: Ours.
        places: Of the points.
        reference: CalculiX's (length).
    """
    for number, ((along, radius, angle), theirs) in enumerate(zip(places, reference, strict=True)):
        name = f"{label}: radial, x = {along:g}, r = {radius:g}, {angle:g}°"
        tolerance = _STEEP if radius == _BORE else _COARSE
        yield Finding(name, float(_around(result, number, angle)[1]), theirs, tolerance)


def _disc_in_two(quick: bool) -> Iterator[Finding]:
    """Two rings apart, cut at 5°, which rotate at different speeds."""
    for low, high, square, reference in (
        (1.0, 2.0, 1e6, (1.299631e-07, 1.141482e-07, 1.274128e-07, 1.113627e-07)),
        (2.0, 3.0, 2e6, (1.210182e-06, 1.089371e-06, 1.201383e-06, 1.080165e-06)),
    ):
        places = [(along, radius, 2.5) for along in (0.5, 1.0) for radius in (low, high)]
        body = _sector(72, (0.0, low), (1.0, high), (2, 2, 1))
        found = _of_ring(body, places, load=(_turning(square),), cyclic_symmetry=_cut(72))
        yield from _widening(f"disk2, from {low:g}", found, places, reference)


def _rotating(quick: bool) -> Iterator[Finding]:
    """A wide ring, cut at 30°, whose cut faces may not move around, and by cyclic symmetry."""
    places = [(0.5, _BORE, 15.0), (0.5, 0.55, 15.0), (0.5, 1.0, 15.0), (1.0, _BORE, 15.0)]
    reference = (3.182996e-06, 5.816426e-06, 7.074657e-06, 2.732415e-06)
    body = _sector(12, (0.0, _BORE), (1.0, 1.0), (8, 8, 2))
    axes = SupportAxes(cylindrical=_AXIS)
    held = tuple(Support(f"ring.z{end}", {"around": 0.0}, axes=axes) for end in (0, 1))
    for label, given in (
        ("segment1", {"support": held}),
        ("segment1, cyclic", {"cyclic_symmetry": _cut(12)}),
    ):
        found = _of_ring(body, places, load=(_turning(1e9),), **given)
        yield from _widening(label, found, places, reference)


def _thin(quick: bool) -> Iterator[Finding]:
    """A thin disc with a bore that rotates, axisymmetric, around y."""
    body = boxes([Box("ring", (_BORE, 0.0), (1.0, 0.1), (8, 4))])
    of_radius = {_BORE: 2.999064e-05, 0.55: 5.60344e-05, 1.0: 6.804776e-05}
    scene = Scene(
        kinematics="axisymmetric",
        material=(STEEL,),
        load=(Load("ring", rotation=Rotation(1e5, axis=(0.0, 1.0))),),
        point=tuple(Point(f"at{number}", (r, 0.05)) for number, r in enumerate(of_radius)),
        solver=_FREE,
    )
    found = solved(scene, body).quantities
    for number, (radius, theirs) in enumerate(of_radius.items()):
        ours = float(found[f"displacement_at{number}"][0])
        tolerance = _STEEP if radius == _BORE else _COARSE
        yield Finding(f"axial: radial, r = {radius:g}", ours, theirs, tolerance)


def _warm(quick: bool) -> Iterator[Finding]:
    """A disc of twelve equal sectors, in each of which temperature grows along its middle."""
    middle = radians(15.0)
    temperature = Temperature(
        value=lambda x: 300 + 350 / 0.45 * (cos(middle) * x[1] + sin(middle) * x[2] - _BORE)
    )
    places = [(0.05, radius, angle) for angle in (0.0, 15.0) for radius in (_BORE, 0.55, 1.0)]
    places.append((0.05, 1.0, 7.5))
    reference = (
        *(5.326810e-04, 1.963000e-03, 5.258240e-03),
        *(5.323951e-04, 1.961069e-03, 5.294586e-03),
        5.281301e-03,
    )
    body = _sector(12, (0.0, _BORE), (0.1, 1.0), (2, 12, 4))
    material = Material(210e3, 0.3, thermal_expansion=12e-6, reference_temperature=300.0)
    given = {"material": (material,), "temperature": (temperature,)}
    found = _of_ring(body, places, cyclic_symmetry=_cut(12), **given)
    yield from _widening("segmentlintemp", found, places, reference)
    ours = float(_around(found, 6, 7.5)[2] - _around(found, 5, 15.0)[2])
    # A three-hundredth of what is along the radius.
    yield Finding("segmentlintemp: around, from 15° to 7.5°", ours, -1.662908e-05, 4e-2)
    # Ours come to both sides of these on meshes of as many cells and twice as many.
    for component, theirs in {"yy": 242.505, "zz": -19.4908, "yz": 75.631}.items():
        stress = float(found.quantities[f"stress_at4_{component}"])
        name = f"segmentlintemp: stress {component}, r = 0.55, 15°"
        yield Finding(name, stress, theirs, 2.0, absolute=True)


def _long(quick: bool) -> Iterator[Finding]:
    """A long tube, of whose sectors each is pulled, or twisted, by 1 at its end."""
    area, polar = pi * (1 - _BORE**2) / 12, pi / 2 * (1 - _BORE**4) / 12
    body = _sector(12, (0.0, _BORE), (20.0, 1.0), (2, 12, 4))
    held = Support("ring.x0", {"x": 0.0, "y": 0.0, "z": 0.0})
    places = [(20.0, 1.0, 15.0), (20.0, _BORE, 15.0)]

    def under(*traction: Value) -> Result:
        pull = Load("ring.x1", traction=traction)
        return _of_ring(body, places, support=(held,), load=(pull,), cyclic_symmetry=_cut(12))

    pulled = under(1 / area, 0.0, 0.0)
    rim, bore = (_around(pulled, number, 15.0) for number in (0, 1))
    yield Finding("coupling13: along, r = 1", float(rim[0]), 3.61012e-04, _SAME)
    yield Finding("coupling13: along, r = 0.1", float(bore[0]), 3.61199e-04, _SAME)
    yield Finding("coupling13: radial, r = 1", float(rim[1]), -5.38703e-06, _SAME)
    # The input spreads the moment by nodes, not by area.
    twisted = under(0.0, lambda x: -x[2] / polar, lambda x: x[1] / polar)
    around = float(_around(twisted, 0, 15.0)[2])
    yield Finding("coupling14: around, r = 1", around, 1.896635e-03, _COARSE)


def _rings(quick: bool) -> Iterator[Finding]:
    for part in (_disc_in_two, _rotating, _thin, _warm, _long):
        yield from part(quick)


CALCULIX_RING_CASES: tuple[Case, ...] = (
    Case(
        "calculix_rings",
        "six inputs of CalculiX's tests: sectors that rotate, are warm, pulled and twisted",
        SUITE.format("disk2", "dat.ref") + " (of segmentlintemp, coupling13 and 14 in .frd.ref)",
        _rings,
    ),
)
