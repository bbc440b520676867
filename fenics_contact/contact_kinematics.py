"""Contact kinematics: the jump against an obstacle, its gap and slip.

The only module that knows what the body touches.
"""

from __future__ import annotations

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.errors import FenicsContactError, InputError
from fenics_contact.obstacle import RigidObstacle
from fenics_contact.parallel import gather_rows, raise_together, smallest, total
from fenics_contact.scene_contact import Obstacle
from fenics_contact.trace import Trace

Array = NDArray[np.float64]


class ContactKinematics:
    """The jump w = u − d m of a surface against a rigid obstacle, or w = u against nothing.

    Attributes:
        trace: The contact points.
        jump: Displacement relative to the obstacle, a dolfinx function that energies see.
        direction: Unit vector m along which the obstacle is driven, (components,); 0 without.
        gap: Undeformed gap to the obstacle before it is driven, at the points; infinite where
            none stands (length).
        indentation: How far d the obstacle is driven at present, from where it has been
            brought up to (length).
        brought_up: How far it was brought up to the surface beforehand, under a force: so
            that depths are no differences of long distances (length).
        displacement: How far it has moved besides, (components,) (length).

    Args:
        trace: The contact points.
        obstacle: The scene's obstacle; None where there is none.
        key: Where the scene describes it, for messages.

    Raises:
        InputError: The obstacle does not fit the model, or misses the surface.
    """

    def __init__(self, trace: Trace, obstacle: Obstacle | None, key: str) -> None:
        self.trace = trace
        self._spaces = trace.spaces
        self.jump = fem.Function(trace.surface.space)
        self.indentation = 0.0
        self.brought_up = 0.0
        self.displacement = np.zeros(self._spaces.components)
        self.direction = np.zeros(self._spaces.components)
        self.gap = np.zeros(len(trace.weights))
        self._left_out = np.zeros(len(trace.weights), dtype=bool)
        if obstacle is not None:
            self._place(obstacle, key)

    def _place(self, obstacle: Obstacle, key: str) -> None:
        trace, comm = self.trace, self._spaces.comm
        normals = gather_rows(comm, trace.normals[trace.owned])
        self._obstacle = RigidObstacle(obstacle, self._spaces.kinematics, normals, key)
        self.direction = self._obstacle.direction
        error: FenicsContactError | None = None
        try:
            self.gap = self._gap(trace.coordinates, trace.normals)
        except InputError as caught:
            error = caught
        raise_together(comm, error)
        self._require_reached(self.reached, key)

    def _require_reached(self, points: NDArray[np.bool_], key: str) -> None:
        if total(self._spaces.comm, points.sum()) == 0:
            raise InputError(
                f"{key}: no point of the surface lies in its way; see its position, normal and "
                "direction"
            )

    def require_one_sided(self, key: str) -> None:
        """Refuse an obstacle that is driven away from the surface, and a sharp edge in that.

        Raises:
            InputError: On every rank.
        """
        if self.direction.any():
            self._require_reached(self.reached & (self.facing > 0), f"{key}.obstacle")
        corner = self.trace.sharp_corner()
        if corner is not None:
            where = ", ".join(f"{x:.4g}" for x in corner[: self._spaces.components])
            raise InputError(
                f"{key}.on: the surface has a sharp edge, at ({where}), where no normal is its "
                "own; give each side a contact of its own"
            )

    def leave_out(self, points: NDArray[np.bool_]) -> None:
        """Take points out of the obstacle's reach."""
        self._left_out = points
        self.gap = np.where(points, np.inf, self.gap)

    def _gap(self, points: Array, normals: Array) -> Array:
        aside = self.displacement - (normals @ self.displacement)[:, None] * normals
        moved = points.copy()
        moved[:, : normals.shape[1]] -= aside
        return self._obstacle.gap(moved, normals, self._spaces.position)

    def displace(self, displacement: Array) -> None:
        """Move the obstacle, and its gap with it.

        The part along a normal closes the gap through the jump; the gap itself is that of
        the obstacle moved by the part along the surface.

        Args:
            displacement: From where it stood at first, (components,) (length).
        """
        self.displacement = displacement
        gap = self._gap(self.trace.coordinates, self.trace.normals)
        self.gap = np.where(self._left_out, np.inf, gap - self.brought_up * self.facing)

    def bring_up(self) -> None:
        """Take the obstacle to where it first touches the undeformed surface; collective."""
        ahead = self.reached & (self.facing > 0)
        distance = self.gap[ahead] / self.facing[ahead]
        self.brought_up = smallest(self._spaces.comm, distance)
        self.gap = self.gap - self.brought_up * self.facing

    @property
    def reached(self) -> NDArray[np.bool_]:
        """Which of the points have the obstacle before them."""
        return np.isfinite(self.gap)

    @property
    def facing(self) -> Array:
        """How squarely the obstacle is driven onto each point, −m·n."""
        return np.asarray(-self.trace.normals @ self.direction)

    def move(self, displacement: Array, indentation: float | None = None) -> None:
        """Set the jump.

        Args:
            displacement: At all nodes of the surface, shape (nodes, components) (length).
            indentation: How far the obstacle is driven; by default as before (length).
        """
        if indentation is not None:
            self.indentation = indentation
        jump = displacement - self.indentation * self.direction - self.displacement
        self.jump.x.array[:] = jump.reshape(-1)

    def touch(self) -> None:
        """Drive the obstacle until it just touches the body; collective."""
        ahead = self.reached & (self.facing > 0)
        normal = self.normal(self.jump_at_points())
        distance = (self.gap - normal)[ahead] / self.facing[ahead]
        nearest = smallest(self._spaces.comm, distance)
        jump = self.jump.x.array.reshape(-1, self._spaces.components)
        motion = self.indentation * self.direction + self.displacement
        self.move(jump + motion, self.indentation + nearest)

    def jump_at_points(self) -> Array:
        """The present jump, shape (points, components) (length)."""
        return self.trace.at_points(self.jump.x.array.reshape(-1, self._spaces.components))

    def normal(self, vectors: Array) -> Array:
        """Normal part of vectors given at the contact points, or at their nodes."""
        return np.einsum("ij,ij->i", vectors, self.trace.normals[: len(vectors)])

    def tangential(self, vectors: Array) -> Array:
        """Tangential part of vectors given at the contact points, or at their nodes."""
        normals = self.trace.normals[: len(vectors)]
        return vectors - self.normal(vectors)[:, None] * normals

    def end_of_obstacle(self, reached: NDArray[np.int64], beyond: Array) -> Array:
        """How far the obstacle goes, from points that it reaches to others beyond it (0 … 1).

        Args:
            reached: Numbers of the points.
            beyond: Coordinates of the others, (points, 3) (length).
        """
        starts, normals = self.trace.coordinates[reached], self.trace.normals[reached]
        low, high = np.zeros(len(starts)), np.ones(len(starts))
        for _ in range(40):
            middle = 0.5 * (low + high)
            points = starts + middle[:, None] * (beyond - starts)
            inside = np.isfinite(self._gap(points, normals))
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        return low
