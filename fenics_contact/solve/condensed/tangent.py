"""The condensed tangent M = A + Qᵀ W Q, which way it is solved, and the body's scalars around it.

A has a dense part that never changes, and W is sparse: it has entries only at points in contact.
Q y are the unknowns y, then the jumps z = R y that follow from them: W is between these, and
Qᵀ W Q, which would be full, is never made.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import inf

import numpy as np
from petsc4py import PETSc
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.solve.condensed.constant_tangent import ComplianceSolver, ConstantTangent
from fenics_contact.solve.condensed.scalar_border import ScalarBorder
from fenics_contact.solve.condensed.split_solver import LEFT, SplitSolver
from fenics_contact.solve.systems.contact_stiffness import Entries

# Contact dofs up to which a dense inverse costs next to nothing.
_FEW = 400
# Operations of a dense LU of n unknowns over n³, and of an inverse by Cholesky.
_LU, _INVERSE = 2 / 3, 1.0
# Steps of GMRES, each of which multiplies by S twice.
_GMRES = 8
# Tangents for which a look at what is soft counts, where it was in vain.
_IN_VAIN = 10


class UnknownsTangent:
    """The tangent M = A + Qᵀ W Q of all unknowns but the body's scalars.

    Args:
        constant: A and Q.
        nodes: Number of the node that each displacement belongs to.

    Attributes:
        constant: See the arguments.
        size: Number of unknowns.
    """

    def __init__(self, constant: ConstantTangent, nodes: Integers) -> None:
        self.constant, self.size = constant, constant.size
        none = np.zeros(0, dtype=np.int64)
        self._entries: Entries = none, none, np.zeros(0)
        self._written: csr_matrix | None = None
        self._split = SplitSolver(constant, nodes) if constant.count > _FEW else None
        self._by_compliance: ComplianceSolver | None = None
        self._is_split = False
        self._lost = 0.0
        self._passed_by = 0

    @property
    def compliance(self) -> ComplianceSolver:
        """S⁻¹, found when it is asked for first."""
        if self._by_compliance is None:
            self._by_compliance = ComplianceSolver(self.constant)
        return self._by_compliance

    def set(self, entries: Entries, near: SplitSolver | None = None) -> None:
        """Set W by its entries; those at the same place add up.

        Args:
            entries: Of W.
            near: Solver of a tangent near this one, whose factors serve; None for others.
        """
        rows, columns, values = entries
        kept = np.flatnonzero(values)
        self._entries, self._written = (rows[kept], columns[kept], values[kept]), None
        found = None if near is None else near.acting_as(self.constant, self._added)
        if found is not None:
            self._split, self._is_split = found, True
            return
        self._is_split = self._can_split()
        if not self._is_split:
            self.compliance.factorise(self._entries)

    @property
    def _added(self) -> csr_matrix:
        """W written out, when it is asked for."""
        if self._written is None:
            rows, columns, values = self._entries
            shape = (self.constant.width, self.constant.width)
            self._written = csr_matrix((values, (rows, columns)), shape=shape)
        return self._written

    def _can_split(self) -> bool:
        """Factorise stiff and soft parts, if that is the shorter way and there is one."""
        if self._split is None or self._is_short:
            return False
        if self._passed_by:
            self._passed_by -= 1
            return False
        self._split.split(self._added)
        if self._is_shorter(self._split.soft):
            return self._split.factorise()
        # Where S⁻¹ is known a look costs a part of what it may spare.
        self._passed_by = _IN_VAIN if self.constant.of_schur.knows_compliance else 0
        return False

    @property
    def _is_short(self) -> bool:
        """Whether all that touches is solved sooner than GMRES is done, whatever is soft."""
        known = self.constant.of_schur.knows_compliance
        return known and self._directly(self._touched) < self._by_steps

    @property
    def _touched(self) -> int:
        """How many of all of Q y W has entries of."""
        acts = np.zeros(self.constant.width, dtype=bool)
        acts[self._entries[0]] = acts[self._entries[1]] = True
        return int(acts.sum())

    @staticmethod
    def _directly(touched: int) -> float:
        """Operations of a dense LU of all that touches."""
        return _LU * float(touched) ** 3

    @property
    def _by_steps(self) -> float:
        """Operations of GMRES."""
        return 4.0 * _GMRES * float(self.constant.count) ** 2

    def _is_shorter(self, soft: int) -> bool:
        """Whether to solve the soft part directly rather than all that touches.

        S⁻¹ is made once what it would have spared is what it costs.
        """
        directly = self._directly(self._touched)
        gain: float = _LU * float(soft) ** 3 + self._by_steps - directly
        if self.constant.of_schur.knows_compliance:  # also by an answer before this one
            return gain < 0
        self._lost += max(gain, 0.0)
        return self._lost < _INVERSE * float(self.constant.count) ** 3

    def solve(self, right: Array, left: float = LEFT) -> Array:
        """M⁻¹ r, but for a share that may be left; not a number where M is singular."""
        if self._is_split and self._split is not None:
            found = self._split.solve(right, left)
            if found is not None:
                return found
            self._is_split = False
            self.compliance.factorise(self._entries)
        return self.compliance.solve(right)

    @property
    def split(self) -> SplitSolver | None:
        """The solver in stiff and soft parts, where that is the way of this tangent."""
        return self._split if self._is_split else None

    def solve_transposed(self, right: Array) -> Array:
        """M⁻ᵀ r; not a number where M is singular."""
        if self._is_split and self._split is not None:
            found = self._split.solve_transposed(right)
            if found is not None:
                return found
            self._is_split = False
            self.compliance.factorise(self._added)
        return self.compliance.solve_transposed(right)

    def multiply(self, values: Array) -> Array:
        """The tangent times all unknowns."""
        return self.constant.with_contacts(self._added, values)

    def of_contacts(self, values: Array) -> Array:
        """Qᵀ W Q times all unknowns."""
        constant = self.constant
        return constant.onto_unknowns(self._added @ constant.every(values))

    def times(self, values: Array) -> Array:
        """The tangent without contacts times all unknowns."""
        return self.constant.times(values)

    def times_transposed(self, values: Array) -> Array:
        """The transpose, without contacts, times all unknowns."""
        return self.constant.transposed.times(values)

    def magnitude(self, sizes: Array) -> float:
        """Σ |M| |y| over all rows, of sizes |y|."""
        return self.constant.magnitude(sizes) + self.magnitude_of_contacts(sizes)

    def magnitude_of_contacts(self, sizes: Array) -> float:
        """Σ |Qᵀ W Q| |y| over all rows, of sizes |y|."""
        if not len(self._entries[0]):
            return 0.0
        derived = np.abs(self.constant.derived)
        every = np.concatenate([sizes, derived @ sizes[: self.constant.count]])
        count = np.concatenate([np.ones(len(sizes)), derived.sum(axis=1)])
        return float(count @ (abs(self._added) @ every))

    def onto_unknowns(self, forces: Array) -> Array:
        """Qᵀ f of forces on the unknowns and the derived jumps."""
        return self.constant.onto_unknowns(forces)

    def compliances(
        self,
        relative_to: Callable[[Integers], csr_matrix],
        across: csr_matrix,
        ways: Sequence[csr_matrix],
    ) -> tuple[Array, list[Array]] | None:
        """How far forces along rows move the first rows, as ``CondensedSystem.compliances``."""
        return self.compliance.between(relative_to, across, ways)


class ContactTangent:
    """M with the rows and columns of the body's scalars around it.

    Args:
        inner: M.
        border: Rows and columns of the body's scalars; by default there are none.

    Attributes:
        inner: See the arguments.
        border: Likewise.
        newton_left: Share of the forces that a step of Newton's method may leave.
    """

    def __init__(self, inner: UnknownsTangent, border: ScalarBorder | None = None) -> None:
        self.inner, self.border = inner, border or ScalarBorder.empty(inner.size)
        self.newton_left, self._left = LEFT, inf

    def set(self, entries: Entries, near: SplitSolver | None = None) -> None:
        """Set W by its entries, as ``UnknownsTangent.set``."""
        self._forget_border(inf)
        self.inner.set(entries, near)

    def _forget_border(self, left: float) -> None:
        self.border.forget()
        self._left = left

    def solve(self, right: Array, left: float = LEFT) -> Array:
        """Solve for all unknowns; not a number where the tangent is singular.

        Args:
            right: Of all unknowns.
            left: Share of it that the solve may leave, where that spares work.
        """
        split = self.inner.split
        if split is not None and self.border.count:
            found = split.solve_around(self.border.around(split), right, left)
            if found is not None:
                return found
        if left < self._left:
            self._forget_border(left)
        return self.border.solve(right, partial(self.inner.solve, left=left))

    def solve_transposed(self, right: Array) -> Array:
        """With the transpose, of all unknowns; not a number where it is singular."""
        return self.border.solve_transposed(right, self.inner.solve_transposed)

    def multiply(self, values: Array) -> Array:
        """The tangent times all unknowns."""
        found = self._with_border(values, self.inner.multiply)
        found[self.inner.size :] += self.border.times_added(values[self.inner.size :])
        return found

    def times(self, values: Array) -> Array:
        """The tangent without contacts times all unknowns."""
        return self._with_border(values, self.inner.times)

    def times_transposed(self, values: Array) -> Array:
        """The transpose, without contacts, times all unknowns."""
        return self._with_border(values, self.inner.times_transposed)

    def _with_border(self, values: Array, times: Callable[[Array], Array]) -> Array:
        inner, scalars = values[: self.inner.size], values[self.inner.size :]
        forces, own = self.border.times(inner, scalars)
        return np.concatenate([times(inner) + forces, own])

    def magnitude(self, values: Array) -> float:
        """Σ |M| |y| over all rows, of all unknowns."""
        inner, scalars = np.abs(values[: self.inner.size]), np.abs(values[self.inner.size :])
        return self.inner.magnitude(inner) + self.border.magnitude(inner, scalars)


class TangentOperator:
    """The dense tangent as a matrix and as a preconditioner; only rank 0 has one, and all rows."""

    def __init__(self, dense: ContactTangent | None) -> None:
        self._dense = dense

    def mult(self, matrix: PETSc.Mat, values: PETSc.Vec, result: PETSc.Vec) -> None:
        """Product M y."""
        if self._dense is not None:
            with result as array:
                array[:] = self._dense.multiply(np.array(values.array_r))

    def apply(self, preconditioner: PETSc.PC, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Solution M⁻¹ r."""
        if self._dense is not None:
            with solution as array:
                array[:] = self._dense.solve(np.array(right.array_r), self._dense.newton_left)
