"""The condensed tangent, solved only where contacts act.

M = A + Qᵀ W Q has a dense part A that never changes, and a sparse one W that has entries only at
points in contact. With A⁻¹ found once, a Newton step costs a dense solve of their number. Q y are
the unknowns y, then the jumps z = R y that follow from them: W is between these, and Qᵀ W Q, which
would be full, is never made.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import cho_factor, lapack
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers

# A pivot of this share of the largest diagonal entry belongs to a rigid motion. Where it does
# not, the spring that it gets is taken out again just as exactly.
_SINGULAR = 1e-9


class ContactTangent:
    """M = A + Qᵀ W Q.

    Args:
        schur: Symmetric and positive semi-definite: S of the displacements, first in A.
        columns: What the scalars do to those rows, (displacements, scalars).
        corner: Diagonal of the scalars, after the displacements.
        derived: R of the jumps that are no unknowns, (jumps, displacements).

    Attributes:
        compliant: Numbers of the displacements, then of the derived jumps, among all of Q y.
    """

    def __init__(self, schur: Array, columns: Array, corner: Array, derived: Array) -> None:
        count, scalars = columns.shape
        self._derived = derived
        self.compliant = np.delete(
            np.arange(count + scalars + len(derived)), range(count, count + scalars)
        )
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
        if len(derived):
            below = derived @ self._inverse[:count]
            beside = self._inverse[:, :count] @ derived.T
            corner = below[:, :count] @ derived.T
            self._inverse = np.block([[self._inverse, beside], [below, corner]])

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
        """Of ``compliant``, S⁻¹ with that of derived jumps; None where S lets a body move."""
        if self._added[: self._count].any():
            return None
        return self._inverse[np.ix_(self.compliant, self.compliant)]

    def set(self, rows: Integers, columns: Integers, values: Array) -> None:
        """Set W by its entries; those at the same place add up."""
        added = np.flatnonzero(self._added)
        self._entries = (rows, columns, values)
        rows, columns = np.concatenate([rows, added]), np.concatenate([columns, added])
        values = np.concatenate([values, -self._added[added]])
        kept = np.flatnonzero(values)
        rows, columns, values = rows[kept], columns[kept], values[kept]
        acts = np.zeros(len(self._inverse), dtype=bool)
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
        size = len(right)
        free = self._inverse[:, :size] @ right
        if self._factor is None:
            return np.asarray(free[:size])
        factor, pivots, singular = self._factor
        if singular:
            return np.full(len(right), np.nan)
        active, _ = lapack.dgetrs(factor, pivots, free[self._active])
        found = free - self._inverse[:, self._active] @ (self._extra @ active)
        found[self._active] = active  # no difference of long numbers under a stiff penalty
        return np.asarray(found[:size])

    def multiply(self, values: Array) -> Array:
        """M y."""
        every = np.concatenate([values, self._derived @ values[: self._count]])
        return np.asarray(self._constant @ values + self.onto_unknowns(self._sparse() @ every))

    def _sparse(self) -> csr_matrix:
        rows, columns, values = self._entries
        return csr_matrix((values, (rows, columns)), shape=self._inverse.shape)

    def onto_unknowns(self, forces: Array) -> Array:
        """Qᵀ f of forces on the unknowns and the derived jumps."""
        size = len(self._constant)
        found = forces[:size].copy()
        found[: self._count] += forces[size:] @ self._derived
        return found

    def constant_part(self, values: Array) -> Array:
        """A y."""
        return np.asarray(self._constant @ values)

    def magnitude(self, values: Array) -> float:
        """Σ |M| |y| over all rows."""
        size, derived = np.abs(values), np.abs(self._derived)
        every = np.concatenate([size, derived @ size[: self._count]])
        count = np.concatenate([np.ones(len(size)), derived.sum(axis=1)])
        return float((np.abs(self._constant) @ size).sum() + count @ (abs(self._sparse()) @ every))
