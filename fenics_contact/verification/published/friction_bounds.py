"""Friction whose bound follows from pressure or slip, and with micro-slip, against statics."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt, tanh
from typing import Any

import numpy as np

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.friction_laws import MicroSlipFriction, SlipDependentFriction
from fenics_contact.scene.loading.support_axes import ComponentName
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.scene.settings import Steps
from fenics_contact.scene.values import AXES, CONSTANT, Path, Profile
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, of_quantity, solved

LENGTH, HEIGHT = 1.0, 0.2
_MODULUS = 1e8


def stiff_block(
    depth: float, shift: tuple[float, ...], contact: dict[str, Any], **scene: Any
) -> Scene:
    """A block on the ground, pressed into it and moved along it.

    Args:
        depth: How far it is pressed down (length).
        shift: How far it is moved, one entry an axis along the ground (length).
        contact: Keys of the contact at its lower side.
        scene: Other keys of the scene.
    """
    axes = AXES[: len(shift) + 1]
    moved: dict[ComponentName, float] = dict(zip(axes, (*shift, -depth), strict=True))
    return Scene(
        kinematics="3D" if len(shift) == 2 else "plane strain",
        material=(Material(_MODULUS, 0.0),),
        support=(Support(f"block.{axes[-1]}1", moved),),
        contact=(Contact(f"block.{axes[-1]}0", **contact),),
        **scene,
    )


def stiff_pad(contact: dict[str, Any], **scene: Any) -> Scene:
    """A block in the plane that stands fixed, with a contact at its upper side.

    Args:
        contact: Keys of the contact.
        scene: Other keys of the scene.
    """
    return Scene(
        kinematics="plane strain",
        material=(Material(_MODULUS, 0.0),),
        support=(Support("block.y0", {"x": 0, "y": 0}),),
        contact=(Contact("block.y1", **contact),),
        **scene,
    )


def block_of(cells: int, dimension: int = 2) -> Body:
    """Its mesh, from −LENGTH/2 to LENGTH/2 along the ground and upwards from 0.

    Args:
        cells: Along each axis of the ground; one across.
        dimension: 2 or 3.
    """
    half = LENGTH / 2
    low, high = (-half,) * (dimension - 1), (half,) * (dimension - 1)
    box = Box("block", (*low, 0.0), (*high, HEIGHT), (cells,) * (dimension - 1) + (1,))
    return boxes((box,), "quadrilateral" if dimension == 2 else "hexahedron")


_COEFFICIENT, _HIGH, _SHARE = 0.5, 100.0, 0.4
_LAW = {
    "friction_coefficient": _COEFFICIENT,
    "friction_law": {
        "kind": "pressure dependent",
        "pressures": (0.0, _HIGH),
        "shares": (1.0, _SHARE),
    },
}
_SHIFT = 0.01


def _bound(lowest: float, highest: float) -> float:
    """Mean of μ (1 − (1 − s) p/p_h) p of pressures that vary linearly, up to p_h."""
    mean = (lowest + highest) / 2
    square = (lowest**2 + lowest * highest + highest**2) / 3
    return _COEFFICIENT * (mean - (1 - _SHARE) * square / _HIGH)


def _cases(quick: bool) -> Iterator[Finding]:
    body, stiffness = block_of(20 if quick else 60), 1e3
    depth = 0.06
    springs = {"foundation_stiffness": stiffness, **_LAW}
    result = solved(stiff_block(depth, (_SHIFT,), springs), body)
    pressed = stiffness * depth
    expected = LENGTH * _bound(pressed, pressed)
    yield of_quantity(result, "friction_force", expected, 1e-3, ", uniform pressure")
    given = Profile(along="x", at=(-LENGTH / 2, LENGTH / 2), values=(0.0, _HIGH))
    result = solved(stiff_block(0.0, (_SHIFT,), {"pressure": given, **_LAW}), body)
    expected = LENGTH * _bound(0.0, _HIGH)
    yield of_quantity(result, "friction_force", expected, 1e-3, ", pressure that is given")


BY_PRESSURE_CASES: tuple[Case, ...] = (
    Case(
        "pressure_dependent",
        "a friction coefficient that falls with the pressure",
        "the bound integrated over pressures that are known",
        _cases,
    ),
)


_COEFFICIENT_SLIP_WEAKENING, _PRESSURE = 0.5, 60.0
_CRITICAL, _SHARE_SLIP_WEAKENING = 0.02, 0.4
_SHIFT_SLIP_WEAKENING = 0.005
# The last step is so short that the slip before it is that at its end.
_LAST = 1e-4
_LAW_SLIP_WEAKENING = SlipDependentFriction(
    kind="slip dependent", slips=(0.0, _CRITICAL), shares=(1.0, _SHARE_SLIP_WEAKENING)
)


def _scene(times: tuple[float, ...], factors: tuple[float, ...]) -> Scene:
    """A stiff block under a pressure that is given, moved along by a path; no step is too long."""
    path = Path(time=times, factor=factors)
    steps = Steps(times=(*times[1:-1], times[-1] - _LAST, times[-1]))
    return Scene(
        kinematics="plane strain",
        material=(Material(1e8, 0.0),),
        support=(
            Support("block.y1", {"y": 0}, path=CONSTANT),
            Support("block.y1", {"x": _SHIFT_SLIP_WEAKENING}, path=path),
        ),
        contact=(
            Contact(
                "block.y0",
                pressure=_PRESSURE,
                friction_coefficient=_COEFFICIENT_SLIP_WEAKENING,
                friction_law=_LAW_SLIP_WEAKENING,
                law="incremental",
            ),
        ),
        steps=steps,
    )


def _bound_slip_weakening(slid: float) -> float:
    share = 1 - (1 - _SHARE_SLIP_WEAKENING) * min(slid / _CRITICAL, 1.0)
    return LENGTH * _COEFFICIENT_SLIP_WEAKENING * share * _PRESSURE


def _cases_slip_weakening(quick: bool) -> Iterator[Finding]:
    body = block_of(4)
    once = solved(_scene((0.0, 1.0), (0.0, 1.0)), body)
    yield of_quantity(
        once, "friction_force", _bound_slip_weakening(_SHIFT_SLIP_WEAKENING), 1e-3, ", there"
    )
    back = solved(_scene((0.0, 1.0, 2.0), (0.0, 1.0, 0.0)), body)
    yield of_quantity(
        back,
        "friction_force",
        _bound_slip_weakening(2 * _SHIFT_SLIP_WEAKENING),
        1e-3,
        ", there and back",
    )
    often = solved(_scene((0.0, 1.0, 2.0, 3.0), (0.0, 2.0, -1.0, 1.0)), body)
    yield of_quantity(
        often,
        "friction_force",
        _bound_slip_weakening(7 * _SHIFT_SLIP_WEAKENING),
        1e-3,
        ", beyond the table",
    )


SLIP_WEAKENING_CASES: tuple[Case, ...] = (
    Case(
        "slip_weakening",
        "a friction coefficient that falls with the slip so far",
        "the bound at the length of a path that is known",
        _cases_slip_weakening,
    ),
)


_COEFFICIENT_MICRO_SLIP, _PRESSURE_MICRO_SLIP, _ELASTIC = 0.5, 60.0, 2e-3
_BOUND = _COEFFICIENT_MICRO_SLIP * _PRESSURE_MICRO_SLIP
# Of the bar, so flat that shear across it adds less than 1e-4.
_HEIGHT, _MODULUS_MICRO_SLIP = 0.01, 1e3
# Of the block, which gives way by less than 1e-4 of the elastic slip.
_STIFF = 1e9
_TURNS = (0.0, 1.0, -1.0, 1.0)
# Between what differs by round-off alone.
_SAME = 1e-8


def _contact(on: str, elastic_slip: float) -> Contact:
    return Contact(
        on,
        pressure=_PRESSURE_MICRO_SLIP,
        friction_coefficient=_COEFFICIENT_MICRO_SLIP,
        friction_law=MicroSlipFriction(kind="micro-slip", elastic_slip=elastic_slip),
        law="incremental",
    )


def _bar(reach: float) -> Finding:
    """A bar whose end is drawn out so far that all of it stays elastic.

    Args:
        reach: κ L, the length over that within which friction takes up the force.
    """
    drawn = 1e-4
    elastic_slip = _BOUND * LENGTH**2 / (_MODULUS_MICRO_SLIP * _HEIGHT * reach**2)
    half = LENGTH / 2
    body = boxes((Box("bar", (-half, 0.0), (half, _HEIGHT), (100, 1)),))
    scene = Scene(
        kinematics="plane strain",
        material=(Material(_MODULUS_MICRO_SLIP, 0.0),),
        support=(Support("bar.y1", {"y": 0.0}), Support("bar.x1", {"x": drawn * elastic_slip})),
        contact=(_contact("bar.y0", elastic_slip),),
        discretisation=Discretisation(degree=2),
    )
    result = solved(scene, body)
    force = drawn * elastic_slip * _MODULUS_MICRO_SLIP * _HEIGHT * reach / LENGTH * tanh(reach)
    pulled = abs(next(s.reaction[0] for s in result.supports if s.on == "bar.x1"))
    return Finding(f"force that draws a bar, κL = {reach:g}", pulled, force, 1e-3)


def to_and_fro(body: Body, moved: float, increments: int, elastic_slip: float = _ELASTIC) -> Result:
    """A stiff block that is moved along by a path: out, back beyond its beginning, and out again.

    Args:
        body: Its mesh.
        moved: The amplitude (length).
        increments: Load steps from each turn to the next.
        elastic_slip: Of its friction (length).
    """
    turns = len(_TURNS) - 1
    knots = tuple(float(knot) for knot in range(turns + 1))
    times = np.arange(1, turns * increments + 1) / increments
    scene = Scene(
        kinematics="plane strain",
        material=(Material(_STIFF, 0.0),),
        support=(
            Support("block.y1", {"y": 0.0}, path=CONSTANT),
            Support("block.y1", {"x": moved}, path=Path(time=knots, factor=_TURNS)),
        ),
        contact=(_contact("block.y0", elastic_slip),),
        steps=Steps(times=tuple(times)),
    )
    return solved(scene, body)


def _loops(quick: bool) -> Iterator[Finding]:
    body, moved = block_of(2), 2.5 * _ELASTIC
    result = to_and_fro(body, moved, 4)
    # There, and a whole cycle of 4 τ A (s_max − l).
    lost = 5 * _BOUND * LENGTH * (moved - _ELASTIC)
    yield of_quantity(result, "friction_work", lost, 1e-3, ", to and fro")
    kept = _BOUND * LENGTH * _ELASTIC / 2
    yield of_quantity(result, "elastic_slip_energy", kept, 1e-3, ", to and fro")
    finer = to_and_fro(body, moved, 16 if quick else 64)
    for name in ("friction_work", "friction_force", "elastic_slip_energy"):
        value = of_quantity(finer, name, 1.0, 1.0).value
        yield of_quantity(result, name, value, _SAME, ", 4 steps between turns or many")
    within = to_and_fro(body, 0.9 * _ELASTIC, 4).quantities["friction_work"]
    share = within / (_BOUND * LENGTH * _ELASTIC)
    yield Finding("lost within the elastic slip, over τ A l", share, 0.0, _SAME, absolute=True)


def _cases_micro_slip(quick: bool) -> Iterator[Finding]:
    yield from (_bar(reach) for reach in (0.5, sqrt(2), 3.0))
    yield from _loops(quick)


MICRO_SLIP_CASES: tuple[Case, ...] = (
    Case(
        "micro_slip",
        "friction with micro-slip: a bar pulled over a surface, a block moved to and fro",
        "shear lag, F = u E A κ tanh κL with κ² = τ/(l E A); hysteresis 4 τ A (s − l) of a cycle",
        _cases_micro_slip,
    ),
)
