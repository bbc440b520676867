"""A block that is pressed onto a plate which slides by: its growth rate, found in two ways.

It is 2 wide and 1 high, with E = 1000, ν = .3 and ρ = 1 in plane strain, its top held by a rigid
plate that presses it down by .01. All of its lower side slides, and with a friction coefficient of
.3 vibrations grow: those of the largest growth rate overtake all others.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fenics_contact.analyses.stability.table import Stability
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.scene.values import CONSTANT, Path
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.motion.bars import along, times_of

# E (1 − ν)/((1 + ν)(1 − 2 ν))/ρ.
_WAVE = (1000 * 0.7 / (1.3 * 0.4)) ** 0.5
_SPEED = 20.0  # of the plate; any that no vibration reaches
_PUSH = 1e-4  # by which it is disturbed (stress)
_PATH = Path(time=(0.0, 0.02, 0.04), factor=(0.0, 1.0, 0.0))


def sliding_block(cells: int, stability: Stability | None) -> tuple[Scene, Body]:
    """The scene at rest, under a plate that has slid by 1.

    Args:
        cells: Along its height.
        stability: What is asked of it.
    """
    plate = Obstacle("plane", position=(0.0, 0.0), normal=(0.0, 1.0), displacement=(-1.0, 0.0))
    scene = Scene(
        kinematics="plane strain",
        material=(Material(1000.0, 0.3, density=1.0),),
        discretisation=Discretisation(1),
        support=(Support("block.y1", {"x": 0.0, "y": -0.01}, path=CONSTANT),),
        contact=(Contact("block.y0", obstacle=plate, friction_coefficient=0.3, law="incremental"),),
        stability=stability,
    )
    return scene, boxes([Box("block", (0.0, 0.0), (2.0, 1.0), (2 * cells, cells))])


def moving_block(cells: int, courant: float, end: float) -> tuple[Scene, Body]:
    """The same as a motion, which begins from that state and is pushed a little on one side.

    Args:
        cells: Along its height.
        courant: Speed of a wave times the step, over the length of a cell.
        end: Of the motion (time).
    """
    scene, body = sliding_block(cells, None)
    (contact,) = scene.contact
    assert contact.obstacle is not None
    path = Path(time=(0.0, end), factor=(1.0, 1.0 + _SPEED * end))
    moved = replace(contact, obstacle=replace(contact.obstacle, displacement_path=path))
    motion = Motion(step=courant / (cells * _WAVE), end=end, start="static")
    push = Load("block.x1", traction=(_PUSH, 0.0), path=_PATH)
    return replace(scene, load=(push,), contact=(moved,), motion=motion), body


def growth_in_time(result: Result, last: float) -> float:
    """Rate at which vibrations of a motion grow: half of that of the kinetic energy.

    The block itself is at rest, so that this is that of vibrations alone.

    Args:
        result: Of ``moving_block``.
        last: How long before its end it is measured (time).
    """
    times, energies = times_of(result), along(result, "kinetic_energy")
    late = times >= times[-1] - last
    return float(np.polyfit(times[late], np.log(energies[late]), 1)[0] / 2)
