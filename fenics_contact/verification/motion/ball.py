"""A ball that hits a plane so slowly that it answers as in statics: its greatest force.

Waves run through it many times in a contact; so it moves by m d'' = −F(d), with F the force of the
same ball, on the same mesh, that rests under a weight of F, and d its mean displacement.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.program import mesh_file
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.motion import Motion, MotionModes
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene
from fenics_contact.scene.steps import SolverSettings, Steps

# A steel ball of radius 10 mm at 5 m/s, v/√(E/ρ) = .97e-3; it is in touch for about 37 µs.
_YOUNG, _POISSON, _DENSITY, _RADIUS, _SPEED = 210e3, 0.3, 7.85e-9, 10.0, 5000.0
_TOUCH = 37.2e-6
# Forces up to which it rests: beyond the greatest, in as many steps of the displacement, nearly.
_FORCE, _STEPS = 18e3, 40


def ball_scene(steps: int, modes: int | None = None) -> Scene:
    """It flies against a plane that it touches.

    Args:
        steps: While it is in touch.
        modes: In which alone it moves, if not in all that its mesh has.
    """
    few = None if modes is None else MotionModes(number=modes)
    return Scene(
        kinematics="axisymmetric",
        mesh=(MeshSource(mesh_file("ball.geo"), parameters={"size": 0.06}),),
        material=(Material(_YOUNG, _POISSON, density=_DENSITY),),
        discretisation=Discretisation(1),
        contact=(Contact("contact", obstacle=Obstacle("plane", position=(0, 0), normal=(0, 1))),),
        motion=Motion(
            step=_TOUCH / steps, end=1.05 * _TOUCH, velocity={"ball": (0, -_SPEED)}, modes=few
        ),
        solver=SolverSettings(errors="none"),
    )


def resting_scene() -> Scene:
    """The same under a weight that grows."""
    weight = _FORCE / (4 / 3 * pi * _RADIUS**3)
    # F ~ d^1.5: equal steps of the displacement, nearly.
    shares = (np.arange(1, _STEPS + 1) / _STEPS) ** 1.5
    return replace(
        ball_scene(1),
        load=(Load("ball", body_force=(0, -weight)),),
        steps=Steps(times=tuple(shares.tolist())),
        motion=None,
    )


def force_that_stops(found: Result, energy: float) -> float:
    """The force at which the work of F(d) is the kinetic energy.

    Args:
        found: Of ``resting_scene``.
        energy: With which it arrives.
    """
    force = np.array([step.quantities["normal_force"] for step in found.steps])
    moved = np.array([step.loads[0].displacement for step in found.steps])
    # Up to the first step by Hertz's power.
    work = 0.4 * force[0] * moved[0] + _trapezoids(force, moved)
    return float(np.interp(energy, work, force))


def _trapezoids(force: Array, moved: Array) -> Array:
    pieces = 0.5 * (force[1:] + force[:-1]) * np.diff(moved)
    return np.concatenate([[0.0], np.cumsum(pieces)])


def jerk(force: Array) -> float:
    """Greatest second difference of a force over its peak, of all steps."""
    return float(np.abs(np.diff(force, 2)).max() / force.max())
