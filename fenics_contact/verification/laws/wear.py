"""Wear of a contact, cycle by cycle and in the limit, against closed solutions.

Where fretting ends at a height that stays: half of a paraboloid on a half-space, in 3D. It is
moved to and fro by so little that the middle sticks. In the end pressure and shear are at the edge
of that as for a punch, in the ratio of friction: little holds the edge there, and it moves
inwards. So the limit is compared at the run's own circle, by the shear that it carries.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fenics_contact.analyses.wear_cycles.table import CycleJump
from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle
from fenics_contact.analytic import fretting_limit
from fenics_contact.common.arrays import Array
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
from fenics_contact.verification.published.shear import HERTZ, shear_share, sheared_scene, shift

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


WEAR_CASES: tuple[Case, ...] = (
    Case(
        "wear",
        "worn volume where all of a surface slips",
        "k/μ times the friction work (J. F. Archard, J. Appl. Phys. 24 (1953) 981-988)",
        _volume,
    ),
    Case("wear_springs", "wear of springs at a fixed depth", "p₀ exp(−k K v t)", _springs),
    Case("wear_punch", "wear under a flat obstacle and a force", "even pressure F/A", _punch),
)


# c/a₀ in the first cycle.
_STICK = 0.7
_MESH = {"fine": 1.5, "size": 0.25, "cells_outside": 3}
# After so many what slips carries next to nothing; the circle that sticks goes on shrinking, by
# little from one to another. The way there does not matter: jumps are as long as the
# pressure lets them be, whatever their error.
_CYCLES = 1000
_JUMPS = CycleJump(pressure_change=0.3, error=10.0)
_WEAR = Wear(1.2e-3)
# Parts of the deepest wear between which the profile tells where it ends.
_SHALLOW, _DEEP = 0.04, 0.7


def rubbed_scene(stick: float) -> Scene:
    """Pressed to Hertz's depth, then between ± the shift at which this share of the radius sticks.

    The way of a height that stays is that of a force that does.

    Args:
        stick: c/a₀.
    """
    share = 1 - stick**3
    scene = sheared_scene(share, **_MESH)
    obstacle = scene.contact[0].obstacle
    assert obstacle is not None and obstacle.radius is not None
    moved = replace(
        obstacle,
        force=None,
        indentation=HERTZ.radius**2 / obstacle.radius,
        path=Path(time=(0.0, 1.0), factor=(0.0, 1.0)),
        displacement=(shift(share), 0.0, 0.0),
        displacement_path=Path(time=(1.0, 2.0, 4.0, 6.0), factor=(0.0, 1.0, -1.0, 1.0)),
    )
    return replace(
        scene,
        contact=(replace(scene.contact[0], obstacle=moved, wear=_WEAR),),
        steps=Steps(times=(1.0, 2.0, 4.0, 6.0)),
        solver=SolverSettings(errors="none"),
    )


def compared(first: WearCycle, last: WearCycle) -> Iterator[Finding]:
    """A worn contact beside the limit at what sticks in it.

    Args:
        first: Its first cycle.
        last: One in which what slips carries next to nothing.
    """
    before, after = first.contacts[0], last.contacts[0]
    # What sticks is displaced by u as by a punch: Q = 2 G* u c, with G* u = μ E* d (1 − ξ²) of the
    # first cycle's ξ; over μ N₀ = (4/3) μ E* d a₀. The area of what sticks is that of whole nodes.
    stick = shear_share(after) / (1.5 * (1 - _STICK**2))
    yield Finding("c/a₀, cycle 1", (1 - shear_share(before)) ** (1 / 3), _STICK, 2e-2)
    at = f", c/a₀ = {stick:.3f}"
    left = after["normal_force"] / before["normal_force"]
    yield Finding(f"N_∞/N₀{at}", left, fretting_limit.force_left(stick), 2e-2)
    radius = np.hypot(*last.points.coordinates[:, :2].T) / HERTZ.radius
    found = worn_radius(radius, last.points.own["worn_depth"])
    yield Finding(f"a_∞/a₀{at}", found, fretting_limit.worn_radius(stick), 2e-2)


def worn_radius(radius: Array, depth: Array) -> float:
    """Where a profile comes to an end, by a parabola through its outer side.

    Args:
        radius: Of its points.
        depth: Worn there.
    """
    share = depth / depth.max()
    outer = (share > _SHALLOW) & (share < _DEEP) & (radius > radius[share.argmax()])
    return float(np.polyfit(share[outer], radius[outer], 2)[-1])


def _limit(quick: bool) -> Iterator[Finding]:
    study = Study(rubbed_scene(_STICK))
    note_mesh(study.prepare().model)
    every = list(study.wear_cycles(2.0, _CYCLES, _JUMPS))
    yield from compared(every[0], every[-1])


WEAR_LIMIT_CASES: tuple[Case, ...] = (
    Case(
        "wear_limit",
        "paraboloid rubbed at a fixed height until what slips carries nothing, in 3D",
        "V. L. Popov, Phil. Mag. 94 (2014) 2887; A. V. Dimaki et al., Int. J. Solids Struct. 51 "
        "(2014) 4215-4220",
        _limit,
    ),
)
