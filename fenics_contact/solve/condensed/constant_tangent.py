"""The part of the condensed tangent that never changes, and how the tangent is solved by it.

The tangent is solved on the dofs at which contacts act, by the compliance S⁻¹. That is found once,
which takes n³ operations of n contact dofs; a Newton step then costs a dense solve of the dofs
that touch. That is the shortest way where few of them do.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from scipy.linalg import blas, cho_factor, lapack
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.solve.systems.contact_stiffness import Entries

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

    @classmethod
    def of_lower(cls, lower: Array) -> OfSchur:
        """The one whose lower triangle is given; it is written into the upper one."""
        _mirror(lower)
        found = cls.__new__(cls)
        found.matrix, found._compliance = np.ascontiguousarray(lower.T), None
        return found

    def written(self) -> Array:
        """S, which its caller may overwrite when this one is needed no longer."""
        return self.matrix

    def times(self, values: Array) -> Array:
        """Product S y."""
        if len(values) == 0:
            return np.zeros(0)
        return np.asarray(blas.dsymv(1.0, self.matrix.T, values))

    @property
    def diagonal(self) -> Array:
        """Diagonal of S, (displacements,)."""
        return self.matrix.diagonal()

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
        of_schur: S, symmetric and positive semi-definite.
        columns: C: what the scalars do to the displacements' rows, (displacements, scalars).
        rows: What the displacements do to the scalars' rows, (scalars, displacements): nothing,
            but in the transpose.
        corner: Diagonal of D.
        derived: R of the jumps that are no unknowns, (jumps, displacements).
        count: Number of displacements.
        size: Of A: that of displacements and scalars.
        width: That of displacements, scalars and derived jumps.

    Args:
        columns: C.
        corner: Diagonal of D.
        derived: R.
        of_schur: S, and what was worked out of it before.
    """

    def __init__(self, columns: Array, corner: Array, derived: Array, of_schur: OfSchur) -> None:
        self.count, scalars = columns.shape
        self.size = self.count + scalars
        self.width = self.size + len(derived)
        self.of_schur = of_schur
        self.columns, self.corner, self.derived = columns, corner, derived
        self.rows = np.zeros((scalars, self.count))
        self.stiffest = self.of_schur.stiffest

    @property
    def schur(self) -> Array:
        """S written out, (displacements, displacements)."""
        return self.of_schur.matrix

    @cached_property
    def transposed(self) -> ConstantTangent:
        """Aᵀ, with the same Q."""
        found = copy.copy(self)
        found.columns, found.rows = self.rows.T, self.columns.T
        return found

    def bulk_forces(self, displacements: Array) -> Array:
        """S y of the displacements alone."""
        return self.of_schur.times(displacements)

    def times(self, values: Array) -> Array:
        """Product A y."""
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


# As LAPACK gives it: LU, pivots, and whether it is singular.
_Factor = tuple[Array, Integers, int]


class ComplianceSolver:
    """M = A + Qᵀ W Q by A⁻¹, which with what Q adds is found once.

    Args:
        constant: A and Q.

    Attributes:
        compliant: Numbers of the displacements, then of the derived jumps, among all of Q y.
        inverse: A⁻¹ with springs, of all of Q y.
        added: Stiffness of the spring of each unknown, mostly 0, (unknowns,).
    """

    def __init__(self, constant: ConstantTangent) -> None:
        self._constant = constant
        count, size = constant.count, constant.size
        self.compliant = np.delete(np.arange(constant.width), range(count, size))
        corner, columns = constant.corner, constant.columns
        # A resultant's own entry is 1; a driven obstacle, which has none, gets a spring.
        self.added = np.zeros(size)
        self.added[count:] = np.where(corner > 0, 0.0, constant.stiffest)
        self.inverse, self.added[:count] = constant.of_schur.compliance
        if size > count:
            own = np.diag(1 / (corner + self.added[count:]))
            whole = np.zeros((size, size))
            whole[:count, :count] = self.inverse
            whole[:count, count:] = -(self.inverse @ columns) @ own
            whole[count:, count:] = own
            self.inverse = whole
        if len(constant.derived):
            self._extend(constant.derived)
        self._springs: Integers = np.flatnonzero(self.added)
        self._block: tuple[Integers, Array] | None = None  # what acted last, and A⁻ᵀ between it

    def _extend(self, derived: Array) -> None:
        """Rows and columns for the derived jumps."""
        count = self._constant.count
        below = derived @ self.inverse[:count]
        beside = self.inverse[:, :count] @ derived.T
        corner = below[:, :count] @ derived.T
        self.inverse = np.block([[self.inverse, beside], [below, corner]])

    @property
    def compliance(self) -> Array | None:
        """S⁻¹ with that of derived jumps, of ``compliant``; None where S lets a body move."""
        if self.added[: self._constant.count].any():
            return None
        return self.inverse[np.ix_(self.compliant, self.compliant)]

    def between(
        self,
        relative_to: Callable[[Integers], Array],
        across: csr_matrix,
        ways: Sequence[csr_matrix],
    ) -> tuple[Array, list[Array]] | None:
        """How far forces along rows move the first rows, as ``CondensedSystem.compliances``.

        Args:
            relative_to: Gives jumps of a contact over ``compliant``.
            across: Takes rows out of these jumps.
            ways: Take others.
        """
        compliance = self.compliance
        if compliance is None:
            return None
        unknowns = relative_to(self.compliant)
        moved = (across @ unknowns) @ compliance
        return moved @ (across @ unknowns).T, [moved @ (way @ unknowns).T for way in ways]

    def factorise(self, added: Entries) -> None:
        """Take the entries of W, between all of Q y; those at the same place add up."""
        rows, columns, values = added
        if self._springs.size:
            rows, columns = (np.concatenate([p, self._springs]) for p in (rows, columns))
            values = np.concatenate([values, -self.added[self._springs]])
        acts = np.zeros(len(self.inverse), dtype=bool)
        acts[rows] = acts[columns] = True
        self._active: Integers = np.flatnonzero(acts)
        place = np.cumsum(acts) - 1
        self._extra = place[rows], place[columns], values
        matrix = self._product()
        matrix[np.diag_indices(len(matrix))] += 1.0
        # By LAPACK itself: a singular tangent shall end the solve in our words.
        self._transposed: _Factor | None = None
        self._factor: _Factor | None = None
        if len(self._active):
            self._factor = lapack.dgetrf(matrix, overwrite_a=1)

    def _product(self) -> Array:
        """A⁻¹ W of what acts, in the order of LAPACK; without what sparse matrices cost to make."""
        rows, columns, values = self._extra
        size = len(self._active)
        order = np.argsort(columns, kind="stable")
        first = np.concatenate([[0], np.cumsum(np.bincount(columns, minlength=size))])
        transposed = csr_matrix((values[order], rows[order], first), shape=(size, size))
        if self._block is None or not np.array_equal(self._block[0], self._active):
            inverse = self.inverse.T[np.ix_(self._active, self._active)]
            self._block = self._active, inverse
        return np.asarray(transposed @ self._block[1]).T

    def solve(self, right: Array) -> Array:
        """M⁻¹ r; not a number where M is singular."""
        size = len(right)
        free = self.inverse[:, :size] @ right
        if self._factor is None:
            return np.asarray(free[:size])
        *pivoted, singular = self._factor
        if singular:
            return np.full(size, np.nan)
        active, _ = lapack.dgetrs(*pivoted, free[self._active])
        rows, columns, values = self._extra
        pushed = np.zeros(len(free))  # all of it: to take columns out of a matrix copies them
        pushed[self._active] = np.bincount(rows, values * active[columns], len(active))
        found = free - self.inverse @ pushed
        found[self._active] = active  # no difference of long numbers under a stiff penalty
        return np.asarray(found[:size])

    def solve_transposed(self, right: Array) -> Array:
        """M⁻ᵀ r; not a number where M is singular."""
        size, active = len(right), self._active
        free = right @ self.inverse[:size]
        if self._factor is None:
            return np.asarray(free[:size])
        rows, columns, values = self._extra
        stiffness = csr_matrix((values, (rows, columns)), shape=(len(active),) * 2)
        if self._transposed is None:
            moved = stiffness @ self.inverse[np.ix_(active, active)]
            self._transposed = lapack.dgetrf(np.eye(len(active)) + moved.T)
        *pivoted, singular = self._transposed
        if singular:
            return np.full(size, np.nan)
        forces, _ = lapack.dgetrs(*pivoted, free[active])
        found = free - (stiffness.T @ forces) @ self.inverse[active]
        found[active] = forces
        return np.asarray(found[:size])
