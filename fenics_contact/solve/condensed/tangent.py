"""The condensed tangent, solved only where contacts act.

M = A + W has a dense part A that never changes, and a sparse one W that has entries only at
points in contact. With A⁻¹ found once, a Newton step costs a dense solve of their number.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import cho_factor, lapack
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers

# A pivot of this share of the largest diagonal entry belongs to a rigid motion. Where it does
# not, the spring that it gets is taken out again just as exactly.
_SINGULAR = 1e-9


class ContactTangent:
    """M = A + W.

    Args:
        schur: Symmetric and positive semi-definite: S of the displacements, first in A.
        columns: What the scalars do to those rows, (displacements, scalars).
        corner: Diagonal of the scalars, after the displacements.
    """

    def __init__(self, schur: Array, columns: Array, corner: Array) -> None:
        count, scalars = columns.shape
        self._count = count
        self._constant = np.zeros((count + scalars, count + scalars))
        self._constant[:count, :count] = 0.5 * (schur + schur.T)
        self._constant[:count, count:] = columns
        self._constant[range(count, count + scalars), range(count, count + scalars)] = corner
        # 1 where supports hold all contact dofs, and only obstacles move.
        self._stiffest = float(self._constant.diagonal()[:count].max(initial=0.0)) or 1.0
        # A resultant's own entry is 1; a driven obstacle, which has none, gets a spring.
        self._added = np.zeros(count + scalars)
        self._added[count:] = np.where(corner > 0, 0.0, self._stiffest)
        self._inverse = np.zeros_like(self._constant)
        self._inverse[count:, count:] = np.diag(1 / (corner + self._added[count:]))
        compliance = self._compliance()
        self._inverse[:count, :count] = compliance
        self._inverse[:count, count:] = -compliance @ columns @ self._inverse[count:, count:]

    def _compliance(self) -> Array:
        """Inverse of S, with springs where it lets the body move."""
        count = self._count
        schur = self._constant[:count, :count]
        if count == 0:
            return schur
        factor, info = lapack.dpotrf(schur, lower=1)
        least = _SINGULAR * self._stiffest
        if info or factor.diagonal().min() ** 2 <= least:
            _, order, rank, _ = lapack.dpstrf(schur, tol=least, lower=1)
            self._added[order[rank:] - 1] = self._stiffest
            factor, _ = cho_factor(schur + np.diag(self._added[:count]), lower=True)
        inverse, _ = lapack.dpotri(factor, lower=1, overwrite_c=1)
        return np.asarray(np.tril(inverse) + np.tril(inverse, -1).T)

    @property
    def compliance(self) -> Array | None:
        """S⁻¹, None where S lets a body move."""
        if self._added[: self._count].any():
            return None
        return self._inverse[: self._count, : self._count]

    def set(self, rows: Integers, columns: Integers, values: Array) -> None:
        """Set W by its entries; those at the same place add up."""
        added = np.flatnonzero(self._added)
        self._entries = (rows, columns, values)
        rows, columns = np.concatenate([rows, added]), np.concatenate([columns, added])
        values = np.concatenate([values, -self._added[added]])
        kept = np.flatnonzero(values)
        rows, columns, values = rows[kept], columns[kept], values[kept]
        acts = np.zeros(len(self._added), dtype=bool)
        acts[rows] = acts[columns] = True
        self._active = np.flatnonzero(acts)
        place = np.cumsum(acts) - 1
        shape = (len(self._active), len(self._active))
        self._extra = csr_matrix((values, (place[rows], place[columns])), shape=shape)
        inverse = self._inverse[np.ix_(self._active, self._active)]
        matrix = np.eye(len(self._active)) + (self._extra.T @ inverse.T).T
        # By LAPACK itself: a singular tangent shall end the solve in our words.
        self._factor = lapack.dgetrf(matrix) if len(self._active) else None

    def solve(self, right: Array) -> Array:
        """M⁻¹ r."""
        free = self._inverse @ right
        if self._factor is None:
            return np.asarray(free)
        factor, pivots, singular = self._factor
        if singular:
            return np.full(len(right), np.nan)
        active, _ = lapack.dgetrs(factor, pivots, free[self._active])
        found = free - self._inverse[:, self._active] @ (self._extra @ active)
        found[self._active] = active  # no difference of long numbers under a stiff penalty
        return np.asarray(found)

    def multiply(self, values: Array) -> Array:
        """M y."""
        return np.asarray(self._constant @ values + self._sparse() @ values)

    def _sparse(self) -> Any:
        rows, columns, values = self._entries
        return csr_matrix((values, (rows, columns)), shape=self._constant.shape)

    def constant_part(self, values: Array) -> Array:
        """A y."""
        return np.asarray(self._constant @ values)

    def magnitude(self, values: Array) -> float:
        """Σ |M| |y| over all rows."""
        size = np.abs(values)
        return float((np.abs(self._constant) @ size).sum() + (abs(self._sparse()) @ size).sum())
