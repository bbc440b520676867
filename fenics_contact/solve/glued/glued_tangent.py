"""The condensed tangent where S' is applied, solved by steps of back-substitutions.

The cells at the slaves are the preconditioner.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent
from fenics_contact.solve.condensed.split_solver import LEFT, Bordered, SplitSolver
from fenics_contact.solve.condensed.tangent import UnknownsTangent
from fenics_contact.solve.glued import recycled
from fenics_contact.solve.glued.glued_bulk import JumpStiffness
from fenics_contact.solve.systems.contact_stiffness import Entries


class GluedSolver(SplitSolver):
    """M = S' + W by generalised conjugate residuals.

    Args:
        constant: S'.
        stiffness: S' with its zone.
        added: W.
    """

    def __init__(
        self, constant: ConstantTangent, stiffness: JumpStiffness, added: csr_matrix
    ) -> None:
        self._constant, self._stiffness = constant, stiffness
        self._acting = self._factorised = added
        self._factor = stiffness.zone.factorised(added)
        self._transposed: GluedSolver | None = None

    @property
    def memory(self) -> float:
        """Memory of the factor over that of S, which is not written."""
        return 0.0

    def acting_as(self, constant: ConstantTangent, added: csr_matrix) -> GluedSolver | None:
        """The solver under another W, near to that of its factor; None where S' was another."""
        if constant is not self._constant:
            return None
        found = copy.copy(self)
        found._acting, found._transposed = added, None
        return found

    def times(self, values: Array) -> Array:
        """Product M w."""
        return np.asarray(self._stiffness.own.product(values) + self._acting @ values)

    def nearly_solved(self, given: Array) -> Array:
        """Nearly M⁻¹ r, of one vector, by the cells at slaves and those at masters.

        A is the stiffness of the cells at slaves on masters that are held, B that of the cells at
        masters. Jumps are x = (A + W)⁻¹ r if masters do not move. Under the forces A x = r − W x
        these give way by y = P B⁻¹ Pᵀ A x, and the answer is x + y − (A + W)⁻¹ W y: exactly
        (A⁻¹ + P B⁻¹ Pᵀ) r where W is 0, and x where W is stiff.
        """
        return np.asarray(self._nearly_solved(given[None])[0])

    def nearly_solved_each(self, columns: Array) -> Array:
        """Nearly M⁻¹ times each of some columns, together, which takes hardly longer than one."""
        return np.asarray(self._nearly_solved(np.ascontiguousarray(columns.T)).T)

    def _nearly_solved(self, rows: Array) -> Array:
        """Nearly M⁻¹ times vectors that are rows, (vectors, jumps)."""
        jumps = self._factor.solve(rows)
        moved = self._stiffness.given_way(rows - (self._factorised @ jumps.T).T)
        return np.asarray(jumps + moved - self._factor.solve((self._factorised @ moved.T).T))

    def solve(self, right: Array, left: float = LEFT) -> Array | None:
        """M⁻¹ r; None where it was not found."""

        def product(values: Array, bulk: Array) -> Array:
            return np.asarray(bulk + self._acting @ values)

        return self._solve(right, left, product, self.nearly_solved)

    def solve_around(self, whole: Bordered, right: Array, left: float) -> Array | None:
        """Solve with M and the rows and columns around it; None where it was not found.

        Args:
            whole: Both.
            right: The right-hand side.
            left: Share of it that the solve may leave.
        """
        count = self._constant.count

        def product(values: Array, bulk: Array) -> Array:
            return whole.with_inner(values, bulk + self._acting @ values[:count])

        return self._solve(right, left, product, whole.nearly_solved)

    def _solve(
        self,
        right: Array,
        left: float,
        product: Callable[[Array, Array], Array],
        nearly_solved: Callable[[Array], Array],
    ) -> Array | None:
        if self._factor.is_singular:
            return None
        directions = self._stiffness.directions
        return recycled.solve(right, left, directions, product, nearly_solved)

    def solve_transposed(self, right: Array) -> Array | None:
        """M⁻ᵀ r; None where it was not found. Only W is transposed, as S' is symmetric."""
        if self._transposed is None:
            added = csr_matrix(self._acting.T)
            self._transposed = GluedSolver(self._constant, self._stiffness, added)
        return self._transposed.solve(right)


class GluedTangent(UnknownsTangent):
    """The tangent of all unknowns but the body's scalars.

    Args:
        constant: S'.
        nodes: Number of the node that each jump belongs to.
        stiffness: S' with its zone.
    """

    def __init__(
        self, constant: ConstantTangent, nodes: Integers, stiffness: JumpStiffness
    ) -> None:
        self.constant, self.size, self._stiffness = constant, constant.size, stiffness
        self._solver: SplitSolver | None = None

    def set(self, entries: Entries, near: SplitSolver | None = None) -> None:
        """Set W by its entries; those at the same place add up.

        Args:
            entries: Of W.
            near: Solver of a tangent near this one, whose factor serves; None for others.
        """
        self._entries, self._written = entries, None
        found = None if near is None else near.acting_as(self.constant, self._added)
        self._solver = None  # its factor is given back before another one is made
        self._solver = found or GluedSolver(self.constant, self._stiffness, self._added)

    @property
    def split(self) -> SplitSolver | None:
        """Solver of the tangent that was set last; None before one was."""
        return self._solver

    def solve(self, right: Array, left: float = LEFT) -> Array:
        """M⁻¹ r, but for a share that may be left; not a number where it was not found."""
        found = None if self._solver is None else self._solver.solve(right, left)
        return np.full(len(right), np.nan) if found is None else found

    def solve_transposed(self, right: Array) -> Array:
        """M⁻ᵀ r; not a number where it was not found."""
        found = None if self._solver is None else self._solver.solve_transposed(right)
        return np.full(len(right), np.nan) if found is None else found

    def compliances(
        self,
        relative_to: Callable[[Integers], csr_matrix],
        across: csr_matrix,
        ways: Sequence[csr_matrix],
    ) -> tuple[Array, list[Array]] | None:
        """None: so many back-substitutions are not made."""
        return None
