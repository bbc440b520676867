"""Wear by Archard's law: its volume, springs that lose their pressure, a punch that spreads it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fenics_contact.analyses.wear_cycles.table import CycleJump
from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.wear import Wear
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.steps import SolverSettings, Steps
from fenics_contact.scene.values import CONSTANT, Path
from fenics_contact.simulation.studies.study import Study
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, note_mesh

_COEFFICIENT, _SPRING, _DEPTH = 0.3, 500.0, 0.01
# Four times this is rubbed in a cycle.
_SWING = 1.0
_TO_AND_FRO = Path(time=(1, 2, 4, 5), factor=(0, 1, -1, 0))
_FORCE = 2.0


def _rubbed(obstacle: Obstacle, stiffness: float, wear: Wear, **more: Any) -> Scene:
    """A block of 2 × 1, clamped below, on whose top an obstacle rubs to and fro; it all slips."""
    moved = replace(obstacle, displacement=(_SWING, 0), displacement_path=_TO_AND_FRO)
    return Scene(
        kinematics="plane strain",
        material=(Material(stiffness, 0.3),),
        support=(Support("block.y0", {"x": 0, "y": 0}),),
        contact=(Contact("block.y1", obstacle=moved, wear=wear, law="incremental", **more),),
        steps=Steps(number=5, end=5),
        solver=SolverSettings(errors="none"),
    )


def _last(scene: Scene, cells: tuple[int, int], cycles: int, jumps: CycleJump) -> WearCycle:
    body = boxes((Box("block", (0, 0), (2, 1), cells),))
    study = Study(scene, body.mesh.comm, body)
    note_mesh(study.prepare().model)
    return list(study.wear_cycles(1.0, cycles, jumps))[-1]


def _volume(quick: bool) -> Iterator[Finding]:
    """Of a soft block that a slanting plane is pressed on, at once and over cycles passed over."""
    wear = Wear(2e-5)
    plane = Obstacle("plane", position=(0, 1), normal=(0.01, -1), indentation=0.03, path=CONSTANT)
    scene = _rubbed(plane, 1000.0, wear, friction_coefficient=_COEFFICIENT)
    for cycles in (1, 40):
        found = _last(scene, (8, 4), cycles, CycleJump())
        expected = 2e-5 / _COEFFICIENT * found.friction_work
        yield Finding(f"worn_volume, cycle {cycles}", found.worn_volume, expected, 1e-8)


def _springs(quick: bool) -> Iterator[Finding]:
    """Of a stiff block on springs, at a fixed depth: the pressure falls to 1/e."""
    cycles = 10_001
    wear = Wear(1 / (_SPRING * 4 * _SWING * cycles))
    plane = Obstacle("plane", position=(0, 1), normal=(0, -1), indentation=_DEPTH, path=CONSTANT)
    scene = _rubbed(plane, 1e9, wear, foundation_stiffness=_SPRING)
    expected, off = _SPRING * _DEPTH * np.exp(-1), {}
    for jumps in (5, 10, 100):
        found = _last(scene, (2, 1), cycles, CycleJump(fixed=cycles // jumps))
        pressure = float(found.points.contact_pressure.max())
        off[jumps] = abs(pressure - expected)
    yield Finding("contact_pressure, 100 jumps", pressure, expected, 1e-4)
    order = float(np.log2(off[5] / off[10]))
    yield Finding("order in the jump", order, 2.0, 0.1)


def _punch(quick: bool) -> Iterator[Finding]:
    """Under a force that stays, the pressure of a flat obstacle becomes F/A everywhere."""
    plane = Obstacle(
        "plane",
        position=(0, 1),
        normal=(0, -1),
        force=_FORCE,
        path=Path(time=(0, 1), factor=(0, 1)),
    )
    scene = _rubbed(plane, 1000.0, Wear(5e-5))
    begun = _last(scene, (8, 4), 1, CycleJump()).points.contact_pressure
    found = _last(scene, (8, 4), 200, CycleJump()).points.contact_pressure
    even = _FORCE / 2.0
    uneven = float(np.abs(begun / even - 1).max())
    left = float(np.abs(found / even - 1).max())
    yield Finding("deviation from F/A, over that at first", left / uneven, 0.0, 1e-2, True)


CASES: tuple[Case, ...] = (
    Case(
        "wear",
        "worn volume where all of a surface slips",
        "k/μ times the friction work (J. F. Archard, J. Appl. Phys. 24 (1953) 981-988)",
        _volume,
    ),
    Case("wear_springs", "wear of springs at a fixed depth", "p₀ exp(−k K v t)", _springs),
    Case("wear_punch", "wear under a flat obstacle and a force", "even pressure F/A", _punch),
)
