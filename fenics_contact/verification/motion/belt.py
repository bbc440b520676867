"""A mass that rests on a belt by friction that falls when it slides, and is held by a spring.

Seen from the belt: the mass lies still on what does not move, and the spring is pulled at a given
speed v. With D = (μ_s − μ_k) N/k it slides for (2/ω)(π − atan(D ω/v)), each time by as much, and
sticks for 2 D/v until the spring carries μ_s N again.
"""

from __future__ import annotations

from dataclasses import replace
from math import atan, pi

import numpy as np

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.laws.friction_laws import SpeedDependentFriction
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import Path
from fenics_contact.verification.motion.bars import along, times_of
from fenics_contact.verification.motion.oscillator import FREQUENCY, LARGEST_FRICTION, oscillator

# μ_k/μ_s, and v over D ω.
_KINETIC, _SPEED = 2 / 3, 0.5
_SHORTER = (1 - _KINETIC) * LARGEST_FRICTION  # D (length)
_PULLED = _SPEED * _SHORTER * FREQUENCY
# Of the pull's speed, from which friction is μ_k: nearly at once, as the formula has it.
_SLIDES = 1e-5
PERIOD = (2 / FREQUENCY) * (pi - atan(1 / _SPEED)) + 2 * _SHORTER / _PULLED


def belt(steps: int, periods: float, kinetic: float = _KINETIC) -> tuple[Scene, Body]:
    """The scene and its mesh.

    Args:
        steps: In a period.
        periods: That it moves.
        kinetic: μ_k/μ_s.
    """
    scene, body = oscillator(steps, periods, first_turn=1.0)
    law = SpeedDependentFriction("speed dependent", (0, _SLIDES * _PULLED), (1, kinetic))
    end = periods * PERIOD
    pulled = Support("mass.x0", {"x": _PULLED * end}, path=Path(time=(0, end), factor=(0, 1)))
    scene = replace(
        scene,
        support=(pulled, Support("mass", {"y": 0})),
        contact=tuple(replace(contact, friction_law=law) for contact in scene.contact),
        motion=Motion(step=PERIOD / steps, end=end),
    )
    return scene, body


def period_of(result: Result) -> float:
    """Of stick and slip, over that of the formula.

    By the passages of the spring's length through its middle, between steps in straight lines.
    """
    times = times_of(result)
    shorter = along(result, "displacement_mass")[:, 0] - _PULLED * times
    settled = shorter[len(shorter) // 2 :]
    off = shorter - 0.5 * (settled.max() + settled.min())
    before = np.flatnonzero((off[:-1] < 0) & (off[1:] >= 0))
    share = off[before] / (off[before] - off[before + 1])
    passed = times[before] + share * (times[before + 1] - times[before])
    return float((passed[-1] - passed[0]) / (len(passed) - 1) / PERIOD)
