"""Bars and balls that hit a wall or a floor, by the theory of waves and by energy.

Bars that hit a wall: one of cells in a row flies against it, another falls and bounces. While the
wave runs through a bar and back, 2 L/c, the force is √(E ρ) v times its area; then the bar leaves,
as fast as it came. The falling one is the example of D. Doyen, A. Ern and S. Piperno, SIAM J. Sci.
Comput. 33 (2011) 223-249.

A ball that hits a plane so slowly that it answers as in statics: its greatest force. Waves run
through it many times in a contact; so it moves by m d'' = −F(d), with F the force of the same
ball, on the same mesh, that rests under a weight of F, and d its mean displacement.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.program import mesh_file
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.motion import Motion, MotionModes
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene
from fenics_contact.scene.settings import SolverSettings, Steps
from fenics_contact.scene.values import CONSTANT
from fenics_contact.verification.boxes import Box, boxes


def bar_on_wall(
    cells: int, courant: float, end: float = 2.2, degree: int = 1, penalty: float | None = None
) -> tuple[Scene, Body]:
    """A bar of length 1 with E = 100, ρ = 1 (c = 10) that flies against a wall with .01.

    Args:
        cells: Along it.
        courant: c times the step over the length of a cell.
        end: Of the motion, over L/c.
        degree: Of the elements.
        penalty: ε₁, by default as chosen automatically (length/stress).
    """
    size = 1 / cells
    wall = Obstacle("plane", position=(0.0, 0.0), normal=(1.0, 0.0))
    scene = Scene(
        kinematics="plane strain",
        material=(Material(100.0, 0.0, density=1.0),),
        discretisation=Discretisation(degree),
        contact=(Contact("bar.x0", obstacle=wall, penalty_parameter=penalty or "auto"),),
        motion=Motion(step=courant * size / 10, end=end / 10, velocity={"bar": (-0.01, 0.0)}),
    )
    return scene, boxes([Box("bar", (0.0, 0.0), (1.0, size), (cells, 1))])


def force_of_wave(cells: int) -> float:
    """√(E ρ) v A of ``bar_on_wall``, which is as high as a cell."""
    return 10 * 0.01 / cells


def falling_bar(cells: int, courant: float, end: float) -> tuple[Scene, Body]:
    """A bar of length 10 with E = 900, ρ = 1 (c = 30) that falls from a height of 5, g = 10.

    Args:
        cells: Along it.
        courant: As of ``bar_on_wall``.
        end: Of the motion (time).
    """
    size = 10 / cells
    floor = Obstacle("plane", position=(0.0, -5.0), normal=(0.0, 1.0))
    scene = Scene(
        kinematics="plane strain",
        material=(Material(900.0, 0.0, density=1.0),),
        discretisation=Discretisation(1),
        load=(Load("bar", body_force=(0.0, -10.0), path=CONSTANT),),
        contact=(Contact("bar.y0", obstacle=floor),),
        motion=Motion(step=courant * size / 30, end=end),
    )
    return scene, boxes([Box("bar", (0.0, 0.0), (size, 10.0), (1, cells))])


def times_of(result: Result) -> Array:
    """Ends of the steps."""
    return np.array([step.load_factor for step in result.steps])


def along(result: Result, quantity: str) -> Array:
    """A quantity of every step."""
    return np.array([step.quantities[quantity] for step in result.steps])


def worst_defect(result: Result) -> float:
    """Largest part of the energy that a step left open, over all that there is."""
    defects, kinetic = along(result, "energy_defect"), along(result, "kinetic_energy")
    return float(np.abs(defects).max() / kinetic.max())


def touching(result: Result) -> Flags:
    """In which steps the only contact presses."""
    return np.asarray(along(result, "normal_force") > 0)


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
