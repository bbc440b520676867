"""Gauss-Seidel over the points: slow, but hardly anything keeps it from coming near an answer.

M. Jean, The non-smooth contact dynamics method, Computer Methods in Applied Mechanics and
Engineering 177 (1999) 235-257. Scalars are eliminated where their own equations are regular. Else
they have a small compliance, and each sweep begins from the scalars of the sweep before.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.one_point import OnePoint
from fenics_contact.solve.exact.scalars import Scalars


class Sweeps:
    """Gauss-Seidel on the equations of a problem.

    Args:
        equations: Of the problem.
    """

    def __init__(self, equations: NaturalMap) -> None:
        self._equations, count = equations, equations.count
        self._scalars = Scalars(equations)
        self._compliance, self._free = self._scalars.without()
        blocks = self._compliance.reshape(
            equations.points, equations.dimension, equations.points, equations.dimension
        )
        self._points = [
            OnePoint(
                tuple(map(tuple, blocks[number, :, number].tolist())),
                bool(equations.unilateral[number]),
                float(equations.given_force[number]) if equations.given[number] else None,
                bool(equations.rubs[number]),
                bool(equations.bonded[number]),
                float(equations.elastic[number]),
            )
            for number in range(equations.points)
        ]
        self._rows = [
            np.arange(first, first + equations.dimension)
            for first in range(0, count, equations.dimension)
        ]

    def run(self, start: Array, most: int) -> Array:
        """Sweep over all points.

        Args:
            start: Forces to begin with, (rows,), in scaled units.
            most: Number of sweeps.

        Returns:
            Forces, (rows,).
        """
        equations = self._equations
        count, size = equations.count, equations.dimension
        forces = start[:count].copy()
        scalars = start[count:]
        for _ in range(most):
            free = self._free + self._scalars.carried(scalars)
            ratios, fixed = self._bounds(forces)
            for number, point in enumerate(self._points):
                first = number * size
                rows = slice(first, first + size)
                block = self._compliance[rows]
                own = block[:, rows]
                left = block @ forces + free[rows] - own @ forces[rows]
                forces[rows] = point.solve(left.tolist(), ratios[number], fixed[number])
            scalars = self._scalars.at(forces, scalars)
        return np.concatenate([forces, scalars])

    def _bounds(self, forces: Array) -> tuple[list[float], list[float | None]]:
        """Bounds as shares of the force at each point, and those that do not depend on it."""
        equations, size = self._equations, self._equations.dimension
        across = np.maximum(forces[::size] + equations.given_force, 0.0)
        bound, slope = equations.bounds(across)
        ratio = np.where(across > 0, bound / np.where(across > 0, across, 1.0), slope)
        fixed = (slope == 0) & (bound > 0)
        return ratio.tolist(), [
            b if f else None for b, f in zip(bound.tolist(), fixed, strict=True)
        ]
