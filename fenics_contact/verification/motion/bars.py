"""Bars that hit a wall: one of cells in a row flies against it, another falls and bounces.

While the wave runs through a bar and back, 2 L/c, the force is √(E ρ) v times its area; then the
bar leaves, as fast as it came. The falling one is the example of D. Doyen, A. Ern and S. Piperno,
SIAM J. Sci. Comput. 33 (2011) 223-249.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene
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
