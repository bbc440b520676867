"""Loading and taking the load back, and cycles of shear: what friction dissipates on the way."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
from scipy.integrate import trapezoid

from fenics_contact.analytic import contact as formulas
from fenics_contact.results.result import Result
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.case import Case, Finding, solved
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
