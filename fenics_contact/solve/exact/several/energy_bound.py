"""Bounds that all answers of a problem keep: an ellipsoid of forces, and linear inequalities.

Let s be forces with s_t = 0 and s_n ≥ 0, such as those of the problem without friction, and w
the gaps that they leave. Forces and gaps of an answer satisfy r_n v_n = 0, s_n v_n ≥ 0 and
r_t · v_t ≤ 0, so that (r − s) · v ≤ 0, which is (r − s)ᵀ W (r − s) + (r − s) · w ≤ 0. Without
friction s_n w_n = 0, and r_n w_n ≥ 0 may be left out. For a positive definite W this is an
ellipsoid: the smaller, the less the points slip without friction. Statuses of points add linear
equations. Where these miss the ellipsoid, or an inequality holds nowhere in what is left of it, no
answer has these statuses.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from fenics_contact.common.arrays import Array, Flags

# Of the radius, and of values in it: what is nearer to 0 may be of rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Rest:
    """The part of the ellipsoid in which some linear equations hold, |y − middle| ≤ radius.

    Coordinates y are those in which the ellipsoid is a ball around 0 with the radius 1.

    Attributes:
        middle: Its middle, (rows,).
        left: Inequalities within it: their rows without the directions that equations fix,
            (inequalities, rows).
        basis: Orthonormal directions that equations fix, (rows, fixed).
    """

    middle: Array
    left: Array
    basis: Array

    @property
    def radius(self) -> float:
        """Radius of the ellipsoid; 0 also where rounding makes it imaginary."""
        return float(np.sqrt(max(1.0 - float(self.middle @ self.middle), 0.0)))


class EnergyBound:
    """The ellipsoid of a problem, and inequalities that all of its answers satisfy.

    Args:
        compliance: W, (rows, rows).
        smooth: Forces s without friction, (rows,).
        left: Gaps w that they leave, with 0 where w_n may be left out, (rows,).
        rows: Of inequalities a · r + c ≥ 0, (inequalities, rows).
        constants: c, (inequalities,).

    Raises:
        LinAlgError: W is not positive definite.
    """

    def __init__(
        self, compliance: Array, smooth: Array, left: Array, rows: Array, constants: Array
    ) -> None:
        symmetric = (compliance + compliance.T) / 2
        root = cholesky(symmetric, lower=True)
        half = solve_triangular(root, left, lower=True) / 2
        self._size = float(np.linalg.norm(half))
        self._centre = smooth - solve_triangular(root, half, lower=True, trans=1)
        self._root = root
        self.constants = rows @ self._centre + constants
        self.rows = self._turned(rows)
        length = np.linalg.norm(self.rows, axis=1)
        self._near = _ROUNDING * (np.abs(self.constants) + length)

    def whole(self) -> Rest:
        """The whole ellipsoid."""
        size = len(self._centre)
        return Rest(np.zeros(size), self.rows, np.zeros((size, 0)))

    def forces(self, rest: Rest) -> Array:
        """Forces in the middle of a part, (rows,)."""
        step = solve_triangular(self._root, self._size * rest.middle, lower=True, trans=1)
        return np.asarray(self._centre + step)

    def cut(self, rest: Rest, rows: Array, values: Array, inequalities: Flags) -> Rest | None:
        """The part in which equations hold as well; None where no answer can be in it.

        Args:
            rest: Before.
            rows: Of the equations a · r = b, (equations, rows).
            values: b, (equations,).
            inequalities: Which of the inequalities hold there, (inequalities,).
        """
        middle, left, basis = rest.middle, rest.left, rest.basis
        for row, value in zip(self._turned(rows), values - rows @ self._centre, strict=True):
            size = np.linalg.norm(row)
            free = row - basis @ (basis.T @ row)
            free -= basis @ (basis.T @ free)
            missing, length = value - row @ middle, np.linalg.norm(free)
            if length <= _ROUNDING * size:
                if abs(missing) > _ROUNDING * size:
                    return None
                continue
            direction = free / length
            middle = middle + (missing / length) * direction
            if middle @ middle > 1 + _ROUNDING:
                return None
            left = left - np.outer(left @ direction, direction)
            basis = np.column_stack([basis, direction])
        found = Rest(middle, left, basis)
        return found if self._has_any(found, inequalities) else None

    def _has_any(self, rest: Rest, inequalities: Flags) -> bool:
        """Whether each inequality can hold somewhere in a part."""
        reach = rest.radius * np.sqrt(np.einsum("ij,ij->i", rest.left, rest.left))
        most = self.constants + self.rows @ rest.middle + reach
        return bool((most >= -self._near)[inequalities].all())

    def _turned(self, rows: Array) -> Array:
        """Rows in the coordinates of the ball."""
        return np.asarray(self._size * solve_triangular(self._root, rows.T, lower=True).T)
