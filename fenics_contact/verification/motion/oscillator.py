"""A mass on a spring, rubbed on both sides under a given pressure: Coulomb's oscillator.

It is a single cell, held along one side, that can move along x alone: half of its mass is at the
other side, and there is one degree of freedom. Between turns it swings about ±μ N/k, so that each
turn is 2 μ N/k nearer, until one is nearer than μ N/k.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Point, Support
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.motion.bars import along, times_of

_STIFFNESS, _MASS, _COEFFICIENT = 100.0, 1.0, 0.5
FREQUENCY = (_STIFFNESS / _MASS) ** 0.5
_PERIOD = 2 * np.pi / FREQUENCY
# μ N/k (length).
LARGEST_FRICTION = 1e-4


def oscillator(steps: int, periods: float, first_turn: float | None) -> tuple[Scene, Body]:
    """The scene and its mesh.

    Args:
        steps: In a period.
        periods: That it moves.
        first_turn: Where it turns first, over μ N/k; None for no friction.
    """
    speed = FREQUENCY * LARGEST_FRICTION
    contacts: tuple[Contact, ...] = ()
    if first_turn is not None:
        speed *= ((first_turn + 1) ** 2 - 1) ** 0.5
        pressure = _STIFFNESS * LARGEST_FRICTION / _COEFFICIENT  # on half of each of two sides
        rough = {"friction_coefficient": _COEFFICIENT, "law": "incremental"}
        sides = ("mass.y0", "mass.y1")
        contacts = tuple(Contact(side, pressure=pressure, **rough) for side in sides)  # type: ignore[arg-type]
    scene = Scene(
        kinematics="plane strain",
        material=(Material(_STIFFNESS, 0.0, density=2 * _MASS),),
        discretisation=Discretisation(1),
        support=(Support("mass.x0", {"x": 0}), Support("mass", {"y": 0})),
        contact=contacts,
        point=(Point(name="mass", at=(1.0, 0.5)),),
        motion=Motion(step=_PERIOD / steps, end=periods * _PERIOD, velocity={"mass": (speed, 0.0)}),
    )
    return scene, boxes([Box("mass", (0.0, 0.0), (1.0, 1.0), (1, 1))])


def period_of(result: Result) -> float:
    """Of a free oscillation of some periods, over that of the mass on the spring.

    By its passages through 0 upwards, between steps in straight lines.
    """
    times = np.concatenate([[0.0], times_of(result)])
    places = np.concatenate([[0.0], along(result, "displacement_mass")[:, 0]])
    upwards = np.flatnonzero((places[1:-1] < 0) & (places[2:] >= 0)) + 1
    before, after = places[upwards], places[upwards + 1]
    passed = times[upwards] - before / (after - before) * (times[upwards + 1] - times[upwards])
    return float(passed[-1] / len(passed) / _PERIOD)
