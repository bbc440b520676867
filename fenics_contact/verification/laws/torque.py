"""A ring in a tight ring, turned: what friction holds by Lamé's pressure, and what it does not.

The inner ring is turned by tractions along its bore and held by friction alone, which can carry a
torque of μ p 2π R² a length. The outer one is held at its rim.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Literal, get_args

import numpy as np

from fenics_contact.analytic.two_bodies import Tube
from fenics_contact.common.errors import NoEquilibriumError
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.scene import Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path, Profile
from fenics_contact.simulation.runs import run
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

Kinematics = Literal["plane stress", "3D"]

_BORE, _RADIUS, _OUTER, _LENGTH = 0.5, 1.0, 2.0, 0.5
_MODULUS, _RATIO, _INTERFERENCE, _COEFFICIENT = 1000.0, 0.3, 1e-3, 0.15
_HELD, _TOO_MUCH = (0.5, 0.98), 1.05  # of the torque that friction can carry


def limit_stress(kinematics: Kinematics) -> float:
    """Friction at its limit, μ p (stress); G. Lamé's u = a r + b/r is 0 at the outer ring's rim.

    Args:
        kinematics: ``plane stress``, or ``3D`` between ends that keep their length.
    """
    is_long = kinematics == "3D"
    modulus, ratio = _MODULUS, _RATIO
    if is_long:
        modulus, ratio = modulus / (1 - ratio**2), ratio / (1 - ratio)
    squares = (_OUTER / _RADIUS) ** 2
    hub = _RADIUS / modulus * (1 - ratio**2) * (squares - 1)
    hub /= 1 + ratio + (1 - ratio) * squares
    shaft = Tube(_BORE, _RADIUS, _MODULUS, _RATIO).compliance(_RADIUS, "outside", is_long)
    return _COEFFICIENT * _INTERFERENCE / (shaft + hub)


def turned_fit(kinematics: Kinematics, share: float) -> tuple[Scene, Body]:
    """Rings that are fitted at time 1 and turned at time 2, and their meshes.

    Args:
        kinematics: ``plane stress``, or ``3D`` between ends that keep their length.
        share: Torque over what friction can carry.
    """
    is_flat = kinematics == "plane stress"
    around, start, end, layers = (24, (), (), ()) if is_flat else (12, (0.0,), (_LENGTH,), (1,))
    parts = (
        Box("shaft", (0.0, _BORE, *start), (2 * pi, _RADIUS, *end), (around, 2, *layers)),
        Box("hub", (0.0, _RADIUS, *start), (2 * pi, _OUTER, *end), (around, 2, *layers)),
    )
    cell = "quadrilateral" if is_flat else "hexahedron"
    body = boxes(parts, cell, order=2, closed=("shaft", "hub"))
    places = body.mesh.geometry.x
    angles, radii = places[:, 0].copy(), places[:, 1].copy()
    places[:, 0], places[:, 1] = radii * np.sin(angles), radii * np.cos(angles)
    shear = share * limit_stress(kinematics) * (_RADIUS / _BORE) ** 2  # at the bore
    ends = (-_BORE, _BORE)
    traction = Profile("y", ends, (shear, -shear)), Profile("x", ends, (-shear, shear))
    lengths = [Support(f"{part.name}.z{end}", {"z": 0.0}) for part in parts for end in (0, 1)]
    scene = Scene(
        kinematics=kinematics,
        material=(Material(_MODULUS, _RATIO),),
        support=(Support("hub.y1", {"x": 0.0, "y": 0.0}), *(() if is_flat else lengths)),
        load=(
            Load(
                "shaft.y0",
                traction=traction if is_flat else (*traction, 0.0),
                path=Path(time=(1, 2), factor=(0, 1)),
            ),
        ),
        contact=(
            Contact(
                "shaft.y1",
                against="hub.y0",
                interference=_INTERFERENCE,
                law="incremental",
                friction_coefficient=_COEFFICIENT,
            ),
        ),
        steps=Steps(times=(1.0, 2.0)),
        solver=SolverSettings(errors="none"),
    )
    return scene, body


def _torque(quick: bool) -> Iterator[Finding]:
    for kinematics in get_args(Kinematics)[: 1 if quick else None]:
        for share in _HELD:
            result = solved(*turned_fit(kinematics, share))
            label = f"{kinematics}, {share:g} of the limit"
            assert result.slip_limit is not None
            part = result.slip_limit.parts["shaft"]
            yield Finding(f"slip share, {label}", _number(part), share, 1e-3)
        answers = _answers(kinematics)
        label = f"{kinematics}, {_TOO_MUCH:g} of the limit"
        yield Finding(f"answers that pass, {label}", answers, 0, 0, absolute=True)


def _answers(kinematics: Kinematics) -> float:
    """Number of answers to a torque that friction cannot carry: none may pass."""
    scene, body = turned_fit(kinematics, _TOO_MUCH)
    try:
        return float(run(scene, body=body).passed)
    except NoEquilibriumError:
        return 0.0


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


CASES: tuple[Case, ...] = (
    Case(
        "torque",
        "a shaft in a tight hub, turned by half, nearly all, and more than friction holds",
        "G. Lamé's pressure, and statics: S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, "
        "1970, Section 28",
        _torque,
    ),
)
