"""Pressures and tractions at contact points that an exact solver found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from fenics_contact.common.arrays import Array, Flags

_PREFIX = "found_"


@dataclass(frozen=True, eq=False)
class FoundTractions:
    """Pressures and tractions at the points of a contact, (points,) each.

    Attributes:
        pressure: On the body, > 0 in compression (stress).
        traction: On the body along the surface, (points, components) (stress).
        closed: Which points touch.
        sticks: Which of these stick.
        penalty_parameter: ε₁ that they were found with (length/stress).
        regularisation_parameter: ε likewise (length).
    """

    pressure: Array
    traction: Array
    closed: Flags
    sticks: Flags
    penalty_parameter: float = 0.0
    regularisation_parameter: float = 0.0

    @classmethod
    def none(
        cls, normals: Array, penalty_parameter: float = 0.0, regularisation_parameter: float = 0.0
    ) -> FoundTractions:
        """State in which no point touches.

        Args:
            normals: Of the points, (points, components).
            penalty_parameter: See the attributes.
            regularisation_parameter: Likewise.
        """
        everywhere = np.zeros(len(normals), dtype=bool)
        parameters = penalty_parameter, regularisation_parameter
        return cls(
            np.zeros(len(normals)), np.zeros_like(normals), everywhere, everywhere, *parameters
        )

    def kept(self) -> dict[str, Array]:
        """All of it as numbers, by names that ``recalled`` knows."""
        return {
            f"{_PREFIX}pressure": self.pressure,
            f"{_PREFIX}traction": self.traction,
            f"{_PREFIX}status": self.closed.astype(np.float64) + self.sticks,
        }

    def recalled(self, at_points: Mapping[str, Array]) -> FoundTractions | None:
        """Tractions from arrays that ``kept`` gave; None where they are not among these."""
        if f"{_PREFIX}status" not in at_points:
            return None
        status = at_points[f"{_PREFIX}status"]
        return replace(
            self,
            pressure=at_points[f"{_PREFIX}pressure"],
            traction=at_points[f"{_PREFIX}traction"],
            closed=status > 0.5,
            sticks=status > 1.5,
        )
