"""Where fretting ends at a height that stays: half of a paraboloid on a half-space, in 3D.

It is moved to and fro by so little that the middle sticks. In the end pressure and shear are at the
edge of that as for a punch, in the ratio of friction: little holds the edge there, and it moves
inwards. So the limit is compared at the run's own circle, by the shear that it carries.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fenics_contact.analyses.wear_cycles.table import CycleJump
from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle
from fenics_contact.analytic import fretting_limit
from fenics_contact.common.arrays import Array
from fenics_contact.scene.laws.wear import Wear
from fenics_contact.scene.scene import Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.simulation.studies.study import Study
from fenics_contact.verification.case import Case, Finding, note_mesh
from fenics_contact.verification.published.shear import HERTZ, shear_share, sheared_scene, shift

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


CASES: tuple[Case, ...] = (
    Case(
        "wear_limit",
        "paraboloid rubbed at a fixed height until what slips carries nothing, in 3D",
        "V. L. Popov, Phil. Mag. 94 (2014) 2887; A. V. Dimaki et al., Int. J. Solids Struct. 51 "
        "(2014) 4215-4220",
        _limit,
    ),
)
