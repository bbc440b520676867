"""Natural frequencies of a bar along its length, and of a slender cantilever."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fenics_contact.analyses.vibration.table import Modes
from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.steps import SolverSettings
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

_YOUNG, _DENSITY, _LENGTH, _HEIGHT = 1000.0, 2.0, 50.0, 1.0
# (βL)² of a beam that is clamped at one end, and what shear and turning take off here.
_CANTILEVER = ((3.516015, 1e-3), (22.034492, 3e-3), (61.697214, 7e-3))


def _scene(support: tuple[Support, ...]) -> Scene:
    return Scene(
        kinematics="plane stress",
        material=(Material(_YOUNG, 0.0, density=_DENSITY),),
        support=support,
        load=(Load("bar.x1", traction=(1e-3, 0)),),
        modes=Modes(3),
        solver=SolverSettings(errors="none"),
    )


def _modes(quick: bool) -> Iterator[Finding]:
    body = boxes((Box("bar", (0, 0), (_LENGTH, _HEIGHT), (50, 2)),))
    sides = (Support("bar.y0", {"y": 0}), Support("bar.y1", {"y": 0}))
    found = solved(_scene((Support("bar.x0", {"x": 0, "y": 0}), *sides)), body).modes
    speed = math.sqrt(_YOUNG / _DENSITY)
    for mode in found:
        exact = (2 * mode.number - 1) * speed / (4 * _LENGTH)
        yield Finding(f"bar, frequency {mode.number}", mode.natural_frequency, exact, 1e-6)
    found = solved(_scene((Support("bar.x0", {"x": 0, "y": 0}),)), body).modes
    unit = speed * math.sqrt(_HEIGHT**2 / 12) / (2 * math.pi * _LENGTH**2)
    for mode, (square, tolerance) in zip(found, _CANTILEVER, strict=True):
        name = f"cantilever, frequency {mode.number}"
        yield Finding(name, mode.natural_frequency, square * unit, tolerance)


CASES: tuple[Case, ...] = (
    Case(
        "modes",
        "natural frequencies of a bar and of a cantilever",
        "ω = (2j − 1)πc/2L; (βL)² = 3.516015, 22.034492, 61.697214 of Euler's beam",
        _modes,
    ),
)
