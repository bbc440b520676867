"""The condensed tangent solved on the dofs at which contacts act, by the compliance S⁻¹.

Found once, which takes n³ operations of n contact dofs; a Newton step then costs a dense solve of
the dofs that touch. That is the shortest way where few of them do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent
from fenics_contact.solve.systems.contact_stiffness import Entries

# As LAPACK gives it: LU, pivots, and whether it is singular.
_Factor = tuple[Array, Integers, int]


class ComplianceSolver:
    """M = A + Qᵀ W Q by A⁻¹, which with what Q adds is found once.

    Args:
        constant: A and Q.

    Attributes:
        compliant: Numbers of the displacements, then of the derived jumps, among all of Q y.
    """

    def __init__(self, constant: ConstantTangent) -> None:
        self._constant = constant
        count, size = constant.count, constant.size
        self.compliant = np.delete(np.arange(constant.width), range(count, size))
        corner, columns = constant.corner, constant.columns
        # A resultant's own entry is 1; a driven obstacle, which has none, gets a spring.
        self._added = np.zeros(size)
        self._added[count:] = np.where(corner > 0, 0.0, constant.stiffest)
        self._inverse, self._added[:count] = constant.of_schur.compliance
        if size > count:
            own = np.diag(1 / (corner + self._added[count:]))
            whole = np.zeros((size, size))
            whole[:count, :count] = self._inverse
            whole[:count, count:] = -(self._inverse @ columns) @ own
            whole[count:, count:] = own
            self._inverse = whole
        if len(constant.derived):
            self._extend(constant.derived)
        self._springs: Integers = np.flatnonzero(self._added)
        self._block: tuple[Integers, Array] | None = None  # what acted last, and A⁻ᵀ between it

    def _extend(self, derived: Array) -> None:
        """Rows and columns for the derived jumps."""
        count = self._constant.count
        below = derived @ self._inverse[:count]
        beside = self._inverse[:, :count] @ derived.T
        corner = below[:, :count] @ derived.T
        self._inverse = np.block([[self._inverse, beside], [below, corner]])

    @property
    def compliance(self) -> Array | None:
        """S⁻¹ with that of derived jumps, of ``compliant``; None where S lets a body move."""
        if self._added[: self._constant.count].any():
            return None
        return self._inverse[np.ix_(self.compliant, self.compliant)]

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
            values = np.concatenate([values, -self._added[self._springs]])
        acts = np.zeros(len(self._inverse), dtype=bool)
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
            inverse = self._inverse.T[np.ix_(self._active, self._active)]
            self._block = self._active, inverse
        return np.asarray(transposed @ self._block[1]).T

    def solve(self, right: Array) -> Array:
        """M⁻¹ r; not a number where M is singular."""
        size = len(right)
        free = self._inverse[:, :size] @ right
        if self._factor is None:
            return np.asarray(free[:size])
        *pivoted, singular = self._factor
        if singular:
            return np.full(size, np.nan)
        active, _ = lapack.dgetrs(*pivoted, free[self._active])
        rows, columns, values = self._extra
        pushed = np.zeros(len(free))  # all of it: to take columns out of a matrix copies them
        pushed[self._active] = np.bincount(rows, values * active[columns], len(active))
        found = free - self._inverse @ pushed
        found[self._active] = active  # no difference of long numbers under a stiff penalty
        return np.asarray(found[:size])

    def solve_transposed(self, right: Array) -> Array:
        """M⁻ᵀ r; not a number where M is singular."""
        size, active = len(right), self._active
        free = right @ self._inverse[:size]
        if self._factor is None:
            return np.asarray(free[:size])
        rows, columns, values = self._extra
        stiffness = csr_matrix((values, (rows, columns)), shape=(len(active),) * 2)
        if self._transposed is None:
            moved = stiffness @ self._inverse[np.ix_(active, active)]
            self._transposed = lapack.dgetrf(np.eye(len(active)) + moved.T)
        *pivoted, singular = self._transposed
        if singular:
            return np.full(size, np.nan)
        forces, _ = lapack.dgetrs(*pivoted, free[active])
        found = free - (stiffness.T @ forces) @ self._inverse[active]
        found[active] = forces
        return np.asarray(found[:size])
