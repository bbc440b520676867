"""Friction with micro-slip: a bar pulled over a surface, and a block that goes to and fro."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt, tanh

import numpy as np

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.friction_laws import MicroSlipFriction
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.scene.steps import Steps
from fenics_contact.scene.values import CONSTANT, Path
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.laws.stiff_block import LENGTH, block_of

_COEFFICIENT, _PRESSURE, _ELASTIC = 0.5, 60.0, 2e-3
_BOUND = _COEFFICIENT * _PRESSURE
# Of the bar, so flat that shear across it adds less than 1e-4.
_HEIGHT, _MODULUS = 0.01, 1e3
# Of the block, which gives way by less than 1e-4 of the elastic slip.
_STIFF = 1e9
_TURNS = (0.0, 1.0, -1.0, 1.0)
# Between what differs by round-off alone.
_SAME = 1e-8


def _contact(on: str, elastic_slip: float) -> Contact:
    return Contact(
        on,
        pressure=_PRESSURE,
        friction_coefficient=_COEFFICIENT,
        friction_law=MicroSlipFriction(kind="micro-slip", elastic_slip=elastic_slip),
        law="incremental",
    )


def _bar(reach: float) -> Finding:
    """A bar whose end is drawn out so far that all of it stays elastic.

    Args:
        reach: κ L, the length over that within which friction takes up the force.
    """
    drawn = 1e-4
    elastic_slip = _BOUND * LENGTH**2 / (_MODULUS * _HEIGHT * reach**2)
    half = LENGTH / 2
    body = boxes((Box("bar", (-half, 0.0), (half, _HEIGHT), (100, 1)),))
    scene = Scene(
        kinematics="plane strain",
        material=(Material(_MODULUS, 0.0),),
        support=(Support("bar.y1", {"y": 0.0}), Support("bar.x1", {"x": drawn * elastic_slip})),
        contact=(_contact("bar.y0", elastic_slip),),
        discretisation=Discretisation(degree=2),
    )
    result = solved(scene, body)
    force = drawn * elastic_slip * _MODULUS * _HEIGHT * reach / LENGTH * tanh(reach)
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


def _cases(quick: bool) -> Iterator[Finding]:
    yield from (_bar(reach) for reach in (0.5, sqrt(2), 3.0))
    yield from _loops(quick)


CASES: tuple[Case, ...] = (
    Case(
        "micro_slip",
        "friction with micro-slip: a bar pulled over a surface, a block moved to and fro",
        "shear lag, F = u E A κ tanh κL with κ² = τ/(l E A); hysteresis 4 τ A (s − l) of a cycle",
        _cases,
    ),
)
