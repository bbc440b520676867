"""Faces that move as rigid bodies: a bar and a beam that are loaded, held and moved at a point."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fenics_contact.results.records.contacts import CouplingRecord
from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.couplings import Coupling
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

_MODULUS, _SIDE, _LENGTH = 210e3, 10.0, 100.0
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
    bar = Box("bar", (0.0, 0.0, 0.0), (_LENGTH, _SIDE, _SIDE), (cells, 2, 2))
    return solved(scene, boxes([bar], "hexahedron")).couplings[0]


def tip_sag(force: float) -> float:
    """Sag of a cantilever under a force at its end, P L³/(3 E I) + 6 P L/(5 G A) (length).

    Args:
        force: P.
    """
    return force * (_LENGTH**3 / (3 * _BENDING) + _SHEAR * _LENGTH)


def _loaded(quick: bool) -> Iterator[Finding]:
    pulled = _end(force=(_FORCE, 0.0, 0.0))
    expected = _FORCE * _LENGTH / (_MODULUS * _AREA)
    yield Finding("elongation", pulled.displacement[0], expected, 1e-10)
    bent = _end(moment=(0.0, 0.0, _MOMENT))
    yield Finding("rotation by a moment", bent.rotation[2], _MOMENT * _LENGTH / _BENDING, 1e-8)
    sag = _MOMENT * _LENGTH**2 / (2 * _BENDING)
    yield Finding("sag by a moment", bent.displacement[1], sag, 1e-8)
    tip = _end(force=(0.0, _FORCE, 0.0)).displacement[1]
    yield Finding("sag by a force", tip, tip_sag(_FORCE), 6e-4)


def _moved(quick: bool) -> Iterator[Finding]:
    across = {"x": 0.0, "y": _SINKS, "z": 0.0}
    hinge = _end(displacement=across)
    yield Finding("force of a hinge that sinks", hinge.force[1], _SINKS / tip_sag(1.0), 1e-3)
    clamp = _end(displacement=across, rotation={"x": 0.0, "y": 0.0, "z": 0.0})
    force = _SINKS / (_LENGTH**3 / (12 * _BENDING) + _SHEAR * _LENGTH)
    yield Finding("force of a clamp that sinks", clamp.force[1], force, 2e-3)
    yield Finding("moment of a clamp that sinks", clamp.moment[2], -force * _LENGTH / 2, 2e-3)


def _all(quick: bool) -> Iterator[Finding]:
    yield from _loaded(quick)
    yield from _moved(quick)


COUPLING_CASES: tuple[Case, ...] = (
    Case(
        "coupling",
        "a beam whose end is rigid, loaded, held and moved at a point",
        "beams with shear: S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 1970, "
        "Sections 21 and 113",
        _all,
    ),
)
