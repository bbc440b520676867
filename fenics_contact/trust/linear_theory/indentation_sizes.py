"""How far rigid obstacles go into a body, over what that is to be small against."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.trust.linear_theory.displacement_gradient import CellPoints

# Points that slid by less, over the size, are where the gap was measured.
_SLID = 0.01


class IndentationSize:
    """The indentation of one obstacle over size.

    The size is the smaller of the obstacle's radius (half its width if it is a punch) and of
    the extent, along the obstacle's way, of the part of the body that it presses. The indentation
    counts from where the obstacle first touches the undeformed surface, less how far that part
    is displaced as a whole: by its supports, or, where none holds it along an axis, by the mean of
    its displacement; a half-space is not.

    Attributes:
        size: (length).
        label: Of the contact.
        kinematics: Of the contact.

    Args:
        problem: The model; collective.
        contact: One with a rigid obstacle that has a direction.
        points: Those inside the cells.
    """

    def __init__(self, problem: Problem, contact: ContactSurface, points: CellPoints) -> None:
        self._problem = problem
        self.label = contact.label
        spaces, kinematics = problem.spaces, contact.kinematics
        self.kinematics = kinematics
        pressed = np.zeros(spaces.parts.count)
        pressed[spaces.parts.of_node[contact.nodes]] = 1.0
        reached = total(problem.comm, pressed) > 0
        self._nodes = np.flatnonzero(reached[spaces.parts.of_node[: spaces.owned_nodes]])
        first = spaces.displacement_space.dofmap.list[points.cells, 0]
        self._points = np.flatnonzero(reached[spaces.parts.of_node[first]])
        self._volumes = points.volumes[self._points]
        along = spaces.coordinates[self._nodes, : spaces.components] @ kinematics.direction
        extent = largest(problem.comm, along) + largest(problem.comm, -along)
        self.size = min(extent, _width(contact))

    def share(self, displacement: Array, inside: Array) -> float:
        """The indentation over the size, ≥ 0; collective.

        Args:
            displacement: At the nodes of this rank, (nodes, components) (length).
            inside: At the points inside its cells, (points, components) (length).
        """
        kinematics = self.kinematics
        ahead = kinematics.reached & (kinematics.facing > 0)
        gaps = kinematics.gap[ahead] / kinematics.facing[ahead]
        way = self._carried_along(displacement, inside) @ kinematics.direction
        went = kinematics.indentation - smallest(self._problem.comm, gaps) - way
        return max(float(went), 0.0) / self.size

    def overlap(self) -> float:
        """How deep a point that slid is inside the obstacle, over the size; collective.

        The gap is that of linear kinematics elsewhere: measured where the points first were.
        """
        depths = self.kinematics.depths_of_slid(_SLID * self.size)
        return max(largest(self._problem.comm, depths), 0.0) / self.size

    def _carried_along(self, displacement: Array, inside: Array) -> Array:
        """Displacement of the part as a whole, (components,) (length); collective."""
        if self._problem.far_field is not None:
            return np.zeros(inside.shape[1])
        held = ~self._problem.free[self._nodes]
        moved = displacement[self._nodes]
        of_points = self._volumes @ inside[self._points]
        sums = np.stack([(moved * held).sum(axis=0), held.sum(axis=0), of_points])
        of_held, count, of_all = total(self._problem.comm, sums)
        volume = total(self._problem.comm, self._volumes.sum())
        mean = np.where(count > 0, of_held / np.maximum(count, 1.0), of_all / volume)
        return np.asarray(mean)


def _width(contact: ContactSurface) -> float:
    """Return the radius or half width of an obstacle; infinite where it has none (length)."""
    obstacle = contact.contact.obstacle
    if obstacle is None or obstacle.radius is None:
        return np.inf
    if obstacle.inner_radius is not None:
        return 0.5 * (obstacle.radius - obstacle.inner_radius)
    return float(obstacle.radius)
