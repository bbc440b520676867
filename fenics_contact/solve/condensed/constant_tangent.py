"""The part of the condensed tangent that never changes: the bulk and the scalars."""

from __future__ import annotations

import copy
from functools import cached_property

import numpy as np
from scipy.linalg import blas, cho_factor, lapack
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array

# Rows that are made symmetric, or mirrored, at a time.
_ROWS = 512
# A pivot of this share of the largest diagonal entry belongs to a rigid motion. Where it does
# not, the spring that it gets is taken out again just as exactly.
_SINGULAR = 1e-9


class OfSchur:
    """S and what follows from it alone, each found when it is asked for first.

    Attributes:
        matrix: S.

    Args:
        schur: S, up to round-off; it is made symmetric in place.
    """

    def __init__(self, schur: Array) -> None:
        _make_symmetric(schur)
        self.matrix = schur
        self._compliance: tuple[Array, Array] | None = None

    @property
    def knows_compliance(self) -> bool:
        """Whether ``compliance`` has been asked for."""
        return self._compliance is not None

    @property
    def stiffest(self) -> float:
        """Largest diagonal entry; 1 where supports hold all contact dofs."""
        return float(self.matrix.diagonal().max(initial=0.0)) or 1.0

    @property
    def compliance(self) -> tuple[Array, Array]:
        """The inverse of S with springs where it lets the body move, and the springs."""
        if self._compliance is None:
            self._compliance = self._inverted()
        return self._compliance

    def _inverted(self) -> tuple[Array, Array]:
        count, springs = len(self.matrix), np.zeros(len(self.matrix))
        if count == 0:
            return self.matrix, springs
        factor, info = lapack.dpotrf(self.matrix, lower=1)
        least = _SINGULAR * self.stiffest
        if info or factor.diagonal().min() ** 2 <= least:
            _, order, rank, _ = lapack.dpstrf(self.matrix, tol=least, lower=1)
            springs[order[rank:] - 1] = self.stiffest
            factor, _ = cho_factor(self.matrix + np.diag(springs), lower=True)
        inverse, _ = lapack.dpotri(factor, lower=1, overwrite_c=1)
        _mirror(inverse)
        return np.asarray(inverse), springs

    @cached_property
    def column_sums(self) -> Array:
        """Σ |S| over the rows, (displacements,)."""
        found = np.zeros(len(self.matrix))
        for start in range(0, len(self.matrix), _ROWS):
            found += np.abs(self.matrix[start : start + _ROWS]).sum(axis=0)
        return found


class ConstantTangent:
    """A = [[S, C], [0, D]] of displacements and scalars, or its transpose; and z = R y.

    Attributes:
        schur: S, symmetric and positive semi-definite, (displacements, displacements).
        columns: C: what the scalars do to the displacements' rows, (displacements, scalars).
        rows: What the displacements do to the scalars' rows, (scalars, displacements): nothing,
            but in the transpose.
        corner: Diagonal of D.
        derived: R of the jumps that are no unknowns, (jumps, displacements).
        count: Number of displacements.
        size: Of A: that of displacements and scalars.
        width: That of displacements, scalars and derived jumps.

    Args:
        schur: S, up to round-off; it is made symmetric in place.
        columns: C.
        corner: Diagonal of D.
        derived: R.
        of_schur: What was worked out of S before, where that is kept.
    """

    def __init__(
        self,
        schur: Array,
        columns: Array,
        corner: Array,
        derived: Array,
        of_schur: OfSchur | None = None,
    ) -> None:
        self.count, scalars = columns.shape
        self.size = self.count + scalars
        self.width = self.size + len(derived)
        self.of_schur = of_schur or OfSchur(schur)
        self.schur, self.columns, self.corner, self.derived = schur, columns, corner, derived
        self.rows = np.zeros((scalars, self.count))
        self.stiffest = self.of_schur.stiffest

    @cached_property
    def transposed(self) -> ConstantTangent:
        """Aᵀ, with the same Q."""
        found = copy.copy(self)
        found.columns, found.rows = self.rows.T, self.columns.T
        return found

    def bulk_forces(self, displacements: Array) -> Array:
        """S y of the displacements alone."""
        if self.count == 0:
            return np.zeros(0)
        return np.asarray(blas.dsymv(1.0, self.schur.T, displacements))

    def times(self, values: Array) -> Array:
        """A y."""
        displacements, scalars = values[: self.count], values[self.count :]
        forces = self.bulk_forces(displacements) + self.columns @ scalars
        return np.concatenate([forces, self.rows @ displacements + self.corner * scalars])

    def every(self, values: Array) -> Array:
        """Q y: the unknowns, and the derived jumps after them."""
        return np.concatenate([values, self.derived @ values[: self.count]])

    def onto_unknowns(self, forces: Array) -> Array:
        """Qᵀ f of forces on the unknowns and the derived jumps."""
        found = forces[: self.size].copy()
        found[: self.count] += forces[self.size :] @ self.derived
        return found

    def with_contacts(self, added: csr_matrix, values: Array) -> Array:
        """(A + Qᵀ W Q) y, of W between all of Q y."""
        return self.times(values) + self.onto_unknowns(added @ self.every(values))

    def magnitude(self, sizes: Array) -> float:
        """Σ |A| |y| over all rows."""
        displacements, scalars = sizes[: self.count], sizes[self.count :]
        bulk = self.of_schur.column_sums @ displacements
        return float(bulk + (np.abs(self.columns) @ scalars).sum() + np.abs(self.corner) @ scalars)


def _make_symmetric(matrix: Array) -> None:
    """The mean of a matrix and its transpose, in place and without a copy of the whole."""
    for start in range(0, len(matrix), _ROWS):
        rows = slice(start, start + _ROWS)
        mean = 0.5 * (matrix[rows, start:] + matrix[start:, rows].T)
        matrix[rows, start:] = mean
        matrix[start:, rows] = mean.T


def _mirror(lower: Array) -> None:
    """Write the lower triangle of a square matrix into the upper one, without a copy of all."""
    for first in range(0, len(lower), _ROWS):
        last = first + _ROWS
        corner = lower[first:last, first:last]
        corner[:] = np.tril(corner) + np.tril(corner, -1).T
        lower[first:last, last:] = lower[last:, first:last].T
