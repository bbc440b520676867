"""Rows of scalars eliminated from those of the points, W_ss r_s = −q_s − W_sp r_p."""

from __future__ import annotations

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact.natural_map import NaturalMap

# Of the largest entry of the rows of scalars: with less, their own equations are singular.
_SINGULAR = 1e-10
# Likewise: what is added to them then.
_COMPLIANCE = 1e-2


class Scalars:
    """Elimination of the scalars of a problem.

    Where their own equations are singular, they have a small compliance times what they differ by
    from values that are given, such as those of the iteration before.

    Attributes:
        is_exact: Whether no compliance is added.

    Args:
        equations: Of the problem, in scaled units.
    """

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
        self.is_exact = not self._added.any()
        self._factors = lu_factor(own + self._added) if own.size else None

    def without(self) -> tuple[Array, Array]:
        """W and q of the points once the scalars are eliminated."""
        count, equations = self._equations.count, self._equations
        compliance = equations.compliance[:count, :count]
        if self._factors is None:
            return compliance, equations.free[:count]
        compliance = compliance - self._to @ lu_solve(self._factors, self._from)
        free = equations.free[:count] - self._to @ lu_solve(self._factors, self._free)
        return compliance, free

    def carried(self, scalars: Array) -> Array | float:
        """Gaps and slips that scalars of the sweep before add to those without forces."""
        if self._factors is None or self.is_exact:
            return 0.0
        return np.asarray(self._to @ lu_solve(self._factors, self._added @ scalars))

    def at(self, forces: Array, before: Array) -> Array:
        """Scalars at forces of the points."""
        if self._factors is None:
            return before
        right = self._added @ before - self._free - self._from @ forces
        return np.asarray(lu_solve(self._factors, right))
