"""The axis that a rigid obstacle turns about, by small angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array, in_3d
from fenics_contact.common.errors import InputError
from fenics_contact.scene.obstacle import ObstacleRotation
from fenics_contact.scene.values import AXES

# Components of a unit vector that count as 0.
_NONE = 1e-9


@dataclass(frozen=True, eq=False)
class Turning:
    """An axis to turn about: an angle θ moves a point at x by θ a × (x − at).

    Attributes:
        axis: Unit vector a, (3,); 0 of what does not turn.
        at: A point of the axis, (3,) (length).
    """

    axis: Array
    at: Array

    @classmethod
    def of(cls, rotation: ObstacleRotation | None) -> Turning:
        """The axis of a scene; that of nothing without one."""
        if rotation is None:
            return cls(np.zeros(3), np.zeros(3))
        axis = np.array(rotation.axis or (0.0, 0.0, 1.0))
        return cls(axis / np.linalg.norm(axis), in_3d(rotation.at or (0.0,)))

    def field(self, points: Array, components: int) -> Array:
        """How far a unit angle moves points, (points, components) (length).

        Args:
            points: Their places, (points, 3) (length).
            components: Of the model.
        """
        return self.across(points - self.at, components)

    def across(self, vectors: Array, components: int) -> Array:
        """A × vectors, (vectors, components); the vectors have 3 components, or 2 in a plane."""
        return np.asarray(vectors @ self._turning[: vectors.shape[1], :components])

    @cached_property
    def _turning(self) -> Array:
        """The matrix whose rows are a × e of the unit vectors e, (3, 3)."""
        return np.cross(self.axis, np.eye(3))

    def require_symmetric(self, mirrored: Sequence[int], key: str) -> None:
        """Refuse an axis in a plane of symmetry: the other half would turn the other way.

        Args:
            mirrored: Axes across the planes that the surface meets.
            key: Of the rotation in the scene.

        Raises:
            InputError: In one sentence.
        """
        for axis in mirrored:
            if np.abs(np.delete(self.axis, axis)).max() > _NONE:
                raise InputError(
                    f"{key}: the contact surface meets a plane of symmetry across {AXES[axis]}, "
                    f"in which an obstacle turns about {AXES[axis]} alone; model the whole body"
                )
