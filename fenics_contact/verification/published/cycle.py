"""Cycles of loads: what friction dissipates of shear, and what wears, against closed solutions.

Wear is compared cycle by cycle and in the limit. Fretting ends at a height that stays: half of a
paraboloid on a half-space, in 3D, is moved to and fro by so little that the middle sticks. In the
end pressure and shear are at the edge of that as for a punch, in the ratio of friction: little
holds the edge there, and it moves inwards. So the limit is compared at the run's own circle, by the
shear that it carries.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.integrate import trapezoid

from fenics_contact.analyses.wear_cycles.table import CycleJump
from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle
from fenics_contact.analytic import contact as formulas
from fenics_contact.common.arrays import Array
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact, Wear
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.settings import SolverSettings, Steps
from fenics_contact.scene.values import CONSTANT, Path
from fenics_contact.simulation.studies.study import Study
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, note_mesh, solved
from fenics_contact.verification.published import shear as shear_cases
from fenics_contact.verification.published.friction import with_friction
from fenics_contact.verification.published.indenters import (
    HERTZ,
    INDENTATION,
    JOHNSON,
    POISSONS_RATIO,
    RADIUS,
    half_space_scene,
)
from fenics_contact.verification.published.shear import SPHERE, shear_share, sheared_scene, shift

# Of the indentation, where the way back ends.
_REMAINS = 0.01
# So little friction that all of the contact slips, but for some 2 % of what is dissipated.
_LITTLE, _MUCH = 0.002, 0.6
# Nothing is lost where all sticks; with _MUCH friction the outermost .7 % of the radius slip.
_HARDLY = 1e-3
# Of the cycle of shear, finer than where only force and displacement are compared: the ring that
# slips is a quarter of the contact radius wide, which is 1.
_MESH = {"fine": 1.1, "size": 1.1 / 6, "cells_outside": 3}
_QUICK_MESH = {"fine": 1.1, "size": 1.1 / 5, "cells_outside": 3}


def pressed_and_released(number: int, coefficient: float, size: float = 0.125) -> Scene:
    """A paraboloid that goes down in equal steps, and back in as many; the mesh's cells by size."""
    down = [step / number for step in range(1, number + 1)]
    # The first steps back are those down, and the last one ends where a little is left.
    back = [1 + time for time in down[:-1]] + [2 - _REMAINS]
    obstacle = Obstacle(
        "paraboloid",
        radius=RADIUS,
        indentation=INDENTATION,
        path=Path(time=(0.0, 1.0, 2.0), factor=(0.0, 1.0, 0.0)),
    )
    scene = half_space_scene(obstacle, fine=3.0, size=size, cells_outside=12)
    if coefficient > 0:
        scene = with_friction(scene, coefficient, "incremental")
    return dataclasses.replace(
        scene,
        steps=Steps(times=(*down, *back)),
        solver=SolverSettings(strategy="monolithic"),
    )


def dissipated_share(result: Result) -> float:
    """What friction dissipated there and back, over the work ∫ F dd of going there."""
    found = [step["quantities"] for step in result.steps]
    force, depth = (
        np.array([0.0, *(step[key] for step in found)]) for key in ("normal_force", "indentation")
    )
    there = slice(int(depth.argmax()) + 1)
    return float(found[-1]["friction_work"] / trapezoid(force[there], depth[there]))


def _pressing(quick: bool) -> Iterator[Finding]:
    """The way there and back, without friction, with little and with much.

    With much, nearly all sticks where it came into contact, and the way back is the way there; if
    all slipped, μ = .6 would take .078 of the work.
    """
    number = 5 if quick else 10
    steps = solved(pressed_and_released(number, 0.0)).steps
    force = np.array([step["quantities"]["normal_force"] for step in steps])
    apart = np.abs(force[: number - 1][::-1] - force[number:-1]).max() / HERTZ.force
    yield Finding("force on the way back, μ = 0", float(apart), 0.0, 1e-8, absolute=True)
    share = dissipated_share(solved(pressed_and_released(20, _LITTLE, 0.25)))
    expected = formulas.pressing_loss(_LITTLE, POISSONS_RATIO)
    yield Finding(f"lost / work, μ = {_LITTLE:g}", share, expected, 0.05)
    runs = [(10, 0.125)] if quick else [(20, 0.125), (40, 0.125), (20, 0.0625), (40, 0.0625)]
    for steps_down, size in runs:
        share = dissipated_share(solved(pressed_and_released(steps_down, _MUCH, size)))
        label = f"lost, μ = {_MUCH:g}, {steps_down} steps, h = 1/{1 / size:g}"
        yield Finding(label, share, 0.0, _HARDLY, absolute=True)


def cyclic_scene(share: float, number: int, **mesh: float) -> Scene:
    """Pressed in the first step, then moved to where ± this share of μP is expected, and back.

    Equal numbers of steps lead to the end, from there to the other end, and from there back.
    """
    scene = shear_cases.sheared_scene(share, **mesh)
    obstacle = scene.contact[0].obstacle
    assert obstacle is not None
    there_and_back = Path(time=(1.0, 2.0, 4.0, 6.0), factor=(0.0, 1.0, -1.0, 1.0))
    contact = dataclasses.replace(
        scene.contact[0], obstacle=dataclasses.replace(obstacle, displacement_path=there_and_back)
    )
    ends = [(1.0, 2.0), (2.0, 4.0), (4.0, 6.0)]
    times = (1.0, *(t for a, b in ends for t in np.linspace(a, b, number + 1)[1:].tolist()))
    return dataclasses.replace(scene, contact=(contact,), steps=Steps(times=times))


def _cycle(quick: bool) -> Iterator[Finding]:
    """Between the first and the second time at the end of the way; the half body counts twice."""
    number = 1 if quick else 8
    for share in (0.6,) if quick else (0.6, 0.9):
        result = solved(cyclic_scene(share, number, **(_QUICK_MESH if quick else _MESH)))
        begun, ended = (result.steps[step * number]["quantities"] for step in (1, 3))
        expected = shear_cases.loss(share)
        for label, key in (("friction_work", "friction_work"), ("work around", "external_work")):
            if key == "external_work" and quick:
                continue  # straight lines between the ends enclose nothing
            lost = 2 * (ended[key] - begun[key])
            yield Finding(f"{label}, Q = ±{share:g} μP", lost, expected, 0.05)


CYCLE_CASES: tuple[Case, ...] = (
    Case(
        "pressing",
        "paraboloid pressed and taken back",
        f"Hertz's surface displacements, {JOHNSON}, (3.41); what sticks loses nothing",
        _pressing,
    ),
    Case(
        "mindlin_cycle",
        "paraboloid pushed to and fro, in 3D",
        f"R. D. Mindlin & H. Deresiewicz, J. Appl. Mech. 20 (1953) 327-344; {JOHNSON}, section 7.4",
        _cycle,
    ),
)


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
    """Worn volume of a soft block under a slanting plane, with and without cycles passed over."""
    wear = Wear(2e-5)
    plane = Obstacle("plane", position=(0, 1), normal=(0.01, -1), indentation=0.03, path=CONSTANT)
    scene = _rubbed(plane, 1000.0, wear, friction_coefficient=_COEFFICIENT)
    for cycles in (1, 40):
        found = _last(scene, (8, 4), cycles, CycleJump())
        expected = 2e-5 / _COEFFICIENT * found.friction_work
        yield Finding(f"worn_volume, cycle {cycles}", found.worn_volume, expected, 1e-8)


def _springs(quick: bool) -> Iterator[Finding]:
    """Wear of a stiff block on springs at a fixed depth: the pressure falls to 1/e."""
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
_MESH_WEAR = {"fine": 1.5, "size": 0.25, "cells_outside": 3}
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
    scene = sheared_scene(share, **_MESH_WEAR)
    obstacle = scene.contact[0].obstacle
    assert obstacle is not None and obstacle.radius is not None
    moved = replace(
        obstacle,
        force=None,
        indentation=SPHERE.radius**2 / obstacle.radius,
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
    """Difference of a worn contact from its limit, at the edge of what sticks.

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
    yield Finding(f"N_∞/N₀{at}", left, formulas.force_left(stick), 2e-2)
    radius = np.hypot(*last.points.coordinates[:, :2].T) / SPHERE.radius
    found = worn_radius(radius, last.points.own["worn_depth"])
    yield Finding(f"a_∞/a₀{at}", found, formulas.worn_radius(stick), 2e-2)


def worn_radius(radius: Array, depth: Array) -> float:
    """Where a profile comes to an end, by a parabola through its outer side."""
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
