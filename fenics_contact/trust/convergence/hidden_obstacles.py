"""Obstacles that a mesh would not see, told before anything is solved.

An obstacle that meets the surface between two of its points comes nearer by some distance before it
meets a point: it is hidden where it is not driven as far. Under a force that is about the force
over E*, per unit thickness, or over E* and the spacing of the points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import gather_rows, smallest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.kinematics.against_obstacle import ObstacleKinematics
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.loading.load_paths import knots

# What is left open between points, over what closes, on cells that show an obstacle.
_SHOWN = 0.1
# Cells become at most so many times smaller at once.
_LEAST = 0.125


@dataclass(frozen=True, eq=False)
class Hidden:
    """An obstacle that no point of a surface would meet, however the answer.

    Attributes:
        label: Of the contact.
        place: Where it meets the surface first, (3,) (length).
        spacing: From one contact point to the next there (length).
        wanted: Size of cells that would show it (length).
    """

    label: str
    place: Array
    spacing: float
    wanted: float


def hidden_obstacles(problem: Problem) -> list[Hidden]:
    """Return the obstacles hidden between points, before the first load step; collective."""
    found = [_hidden(problem, contact) for contact in problem.contacts if contact.is_one_sided]
    return [one for one in found if one is not None]


def words(hidden: list[Hidden], components: int) -> list[str]:
    """Sentences on them.

    Args:
        hidden: The obstacles.
        components: Of a place in the model.
    """
    return [
        f"The mesh is too coarse at '{one.label}': the obstacle meets the surface between its "
        f"points, near ({', '.join(f'{x + 0.0:.4g}' for x in one.place[:components])}), and no "
        f"point before the end of its way; make cells there {one.wanted:.2g} wide, or ask for an "
        "accuracy"
        for one in hidden
    ]


def _hidden(problem: Problem, contact: ContactSurface) -> Hidden | None:
    kinematics = contact.kinematics
    if not isinstance(kinematics, ObstacleKinematics) or not kinematics.direction.any():
        return None
    at_points, between = kinematics.first_distances()
    nearest = smallest(problem.comm, at_points, empty=np.inf)
    rows = np.column_stack([-between.depth, between.places, between.spacing])
    rows = gather_rows(problem.comm, rows[np.lexsort(rows.T[::-1])[:1]])
    if len(rows) == 0:
        return None
    first = rows[np.lexsort(rows.T[::-1])[0]]
    ahead, spacing = nearest - first[0], float(first[4])
    closes = _closes(problem, contact, first[0], spacing)
    if not 0 < closes < ahead:
        return None
    share = np.sqrt(_SHOWN * closes / ahead) if np.isfinite(ahead) else 0.0
    wanted = max(share, _LEAST) * spacing * problem.spaces.degree
    return Hidden(contact.label, first[1:4], spacing, float(wanted))


def _closes(problem: Problem, contact: ContactSurface, ahead: float, spacing: float) -> float:
    """How far an obstacle is driven beyond its first touch, at the most, about (length)."""
    times = [1.0, *knots(problem.scene)]
    if contact.force is None:
        return max(contact.paths.indentation(time) for time in times) - ahead
    force = max(contact.paths.force(time) or 0.0 for time in times)
    spaces = problem.spaces
    in_plane = spaces.components == 2 and spaces.kinematics != "axisymmetric"
    return force / contact.moduli.plane_strain / (1.0 if in_plane else spacing)
