"""Gauss-Seidel over the points: slow, but hardly anything keeps it from coming near an answer.

M. Jean, The non-smooth contact dynamics method, Computer Methods in Applied Mechanics and
Engineering 177 (1999) 235-257. Scalars are eliminated where their own equations are regular. Else
they have a small compliance, and each sweep begins from the scalars of the sweep before.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.one_point import OnePoint

# Of the largest entry of the rows of scalars.
_SINGULAR = 1e-10
_COMPLIANCE = 1e-2


class Sweeps:
    """Gauss-Seidel on the equations of a problem.

    Args:
        equations: Of the problem.
    """

    def __init__(self, equations: NaturalMap) -> None:
        self._equations, count = equations, equations.count
        self._scalars = _Scalars(equations)
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


class _Scalars:
    """Elimination of the rows of scalars: W_ss r_s = −q_s − W_sp r_p."""

    def __init__(self, equations: NaturalMap) -> None:
        self._equations, count = equations, equations.count
        whole = equations.compliance
        self._to, self._from = whole[:count, count:], whole[count:, :count]
        self._free = equations.free[count:]
        own = whole[count:, count:]
        self._added = np.zeros_like(own)
        if own.size:
            size = np.abs(whole[count:]).max()
            if np.linalg.svd(own, compute_uv=False).min() < _SINGULAR * size:
                # Of the sign that makes what the scalars leave of W larger.
                sign = -1.0 if np.sum(self._to.T * self._from) > 0 else 1.0
                self._added = sign * _COMPLIANCE * size * np.eye(len(own))
        self._factors = lu_factor(own + self._added) if own.size else None

    def without(self) -> tuple[Array, Array]:
        """W and q of the points once the scalars are eliminated."""
        count, equations = self._equations.count, self._equations
        compliance = equations.compliance[:count, :count]
        if self._factors is None:
            return compliance, equations.free
        compliance = compliance - self._to @ lu_solve(self._factors, self._from)
        free = equations.free[:count] - self._to @ lu_solve(self._factors, self._free)
        return compliance, free

    def carried(self, scalars: Array) -> Array | float:
        """What scalars of the sweep before add to q of the points."""
        if self._factors is None or not self._added.any():
            return 0.0
        return np.asarray(self._to @ lu_solve(self._factors, self._added @ scalars))

    def at(self, forces: Array, before: Array) -> Array:
        """Scalars at forces of the points."""
        if self._factors is None:
            return before
        right = self._added @ before - self._free - self._from @ forces
        return np.asarray(lu_solve(self._factors, right))
