"""The condensed tangent solved where most of a large contact touches: stiff and soft apart.

Across a contact, and along it where it sticks, W is as stiff as 1/ε₁ and 1/ε: far stiffer than
the body, so that what S adds there hardly counts. What is left is soft: where points slip or are
open. So a sparse factor of the stiff part and a dense one of the soft part, taken one after the
other, are nearly an inverse of M, and GMRES needs few steps with it. The dense factor has the size
of what is soft, in single precision where that is enough, and S⁻¹ is never needed.
"""

from __future__ import annotations

import copy
from typing import Protocol

import numpy as np
from petsc4py import PETSc
from scipy.linalg import lapack
from scipy.sparse import block_diag, csc_matrix, csr_matrix, diags, identity
from scipy.sparse.linalg import splu

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent

# Stiffness that contacts give a node in a direction, over the body's there, from which it is
# stiff: the inverse is about how much a step of GMRES leaves.
_STIFF = 8.0
# The same, below which a coupling of stiff and soft is left to GMRES.
_LOOSE = 1e-2
# Forces that GMRES leaves, over those it starts with, where what follows is to be exact, and at the
# most; and its steps at the most.
LEFT, LEFT_AT_MOST = 1e-8, 1e-4
_MOST_STEPS = 60
# Directions whose stiffness is worked out together.
_ROWS = 64
# Solves, each of what the ones before have left, that end in round-off.
_REFINED = 3


class Bordered(Protocol):
    """A matrix with rows and columns around it."""

    def with_inner(self, values: Array, inner: Array) -> Array:
        """Product with the whole, where that with the matrix is known."""

    def nearly_solved(self, given: Array) -> Array:
        """Nearly its inverse times a vector."""


class SplitSolver:
    """M = A + Qᵀ W Q by GMRES, preconditioned with the stiff and the soft part of it.

    The derived jumps z = R y are unknowns beside y here, held to R y by forces λ.

    Args:
        constant: A and Q.
        nodes: Number of the node that each displacement belongs to.
    """

    def __init__(self, constant: ConstantTangent, nodes: Integers) -> None:
        self._constant = constant
        self._nodes = _Nodes(nodes, constant.schur.diagonal())
        # Derived jumps may be stiff, and are among what is soft.
        self._is_single = not len(constant.derived)
        self._transposed: SplitSolver | None = None

    def split(self, added: csr_matrix) -> None:
        """Find out what is stiff under W, (all of Q y, all of Q y)."""
        constant, count = self._constant, self._constant.count
        basis, stiff = self._nodes.split(added[:count, :count])
        others = identity(constant.width - count, format="csr")
        self._added, self._acting, self._transposed = added, added, None
        self._of_displacements = csr_matrix(added[:, :count])
        self._stiff_basis = csr_matrix(basis[:, stiff])
        self._soft_basis = csr_matrix(basis[:, ~stiff])
        self._soft_directions = csr_matrix(block_diag([self._soft_basis, others]))
        self._springs = self._nodes.scale[stiff]

    def acting_as(self, constant: ConstantTangent, added: csr_matrix) -> SplitSolver | None:
        """The solver under another W, near to that of its factors: it needs no others.

        Args:
            constant: A and Q.
            added: W.

        Returns:
            None where its own A and Q were others.
        """
        if constant is not self._constant:
            return None
        found = copy.copy(self)
        found._acting, found._transposed = added, None
        return found

    @property
    def memory(self) -> float:
        """Memory of the dense factor over that of the condensed stiffness S."""
        taken = 0 if self._soft_factor is None else self._soft_factor[0].nbytes
        return float(taken) / max(self._constant.schur.nbytes, 1)

    @property
    def soft(self) -> int:
        """Size of what is factorised as a dense matrix."""
        constant = self._constant
        directions = self._soft_basis.shape[1]
        return int(directions + constant.width - constant.count + self._forces)

    @property
    def _forces(self) -> int:
        """Number of forces λ, one for each derived jump."""
        return len(self._constant.derived)

    def factorise(self) -> bool:
        """Make both factors; False where one is singular, or nothing is stiff."""
        count = self._constant.count
        with_stiff = csr_matrix(self._of_displacements @ self._stiff_basis)
        from_soft = csr_matrix(self._added @ self._soft_directions)
        stiff = csc_matrix(self._stiff_basis.T @ with_stiff[:count]) + diags(self._springs)
        if stiff.shape[0] == 0:
            return False
        try:
            self._stiff_factor = splu(csc_matrix(stiff))
        except RuntimeError:  # SuperLU's word for a singular matrix
            return False
        self._onto_stiff = csr_matrix(self._stiff_basis.T @ from_soft[:count])
        matrix = self._soft_matrix(from_soft)
        self._subtract_stiff(matrix, csr_matrix(self._soft_directions.T @ with_stiff))
        self._soft_factor = None
        if len(matrix) == 0:
            return True
        factorise = lapack.sgetrf if self._is_single else lapack.dgetrf
        *self._soft_factor, singular = factorise(matrix, overwrite_a=1)
        return not singular

    def _soft_matrix(self, from_soft: csr_matrix) -> Array:
        """M between soft directions, scalars, derived jumps and forces on these."""
        constant, basis = self._constant, self._soft_basis
        soft, scalars = basis.shape[1], constant.size - constant.count
        precision = np.float32 if self._is_single else np.float64
        found = np.zeros((self.soft, self.soft), dtype=precision, order="F")
        rows = csr_matrix(basis.T)
        onto = rows.astype(precision)
        for first in range(0, soft, _ROWS):  # so few at a time that they stay near the processor
            part = slice(first, min(first + _ROWS, soft))
            half = (rows[part] @ constant.schur).T.astype(precision, order="C")
            found[:soft, part] = onto @ half
        found[:soft, soft : soft + scalars] = basis.T @ constant.columns
        found[soft : soft + scalars, :soft] = constant.rows @ basis
        places = range(soft, soft + scalars)
        found[places, places] = constant.corner
        entries = (self._soft_directions.T @ from_soft).tocoo()
        np.add.at(found, (entries.row, entries.col), entries.data)
        jumps, forces = (np.arange(self._forces) + start for start in self._starts)
        found[jumps, forces] = found[forces, jumps] = -1.0
        moved = (basis.T @ constant.derived.T).T
        found[forces[:, None], np.arange(soft)] = moved
        found[np.arange(soft)[:, None], forces] = moved.T
        return found

    @property
    def _starts(self) -> tuple[int, int]:
        """Where derived jumps, and forces on them, begin among what is soft."""
        first = self.soft - 2 * self._forces
        return first, first + self._forces

    def _subtract_stiff(self, matrix: Array, onto_soft: csr_matrix) -> None:
        """Subtract what stiff directions take from the soft ones' stiffness through W; in place."""
        entries = self._onto_stiff.tocoo()
        coupled = np.abs(entries.data) > _LOOSE * self._constant.stiffest
        columns = np.unique(entries.col[coupled])
        if len(columns):
            moved = self._stiff_factor.solve(self._onto_stiff[:, columns].toarray())
            matrix[: onto_soft.shape[0], columns] -= onto_soft @ moved

    def solve(self, right: Array, left: float = LEFT) -> Array | None:
        """M⁻¹ r; None where GMRES did not find it, with a factor in double precision either.

        Args:
            right: The right-hand side.
            left: Share of it that the solve may leave.
        """
        found = gmres(self, right, left)
        if found is None and self._is_single:  # so from now on: a slender body, say
            self._is_single = False
            found = gmres(self, right, left) if self.factorise() else None
        return found

    def solve_around(self, whole: Bordered, right: Array, left: float) -> Array | None:
        """Solve with M and the rows and columns around it; None where GMRES does not end.

        Args:
            whole: Both.
            right: The right-hand side.
            left: Share of it that the solve may leave.
        """
        return gmres(whole, right, left)

    def solve_transposed(self, right: Array) -> Array | None:
        """M⁻ᵀ r, to what numbers can tell; None where GMRES did not find it."""
        if self._transposed is None:
            self._transposed = copy.copy(self)
            self._transposed._constant = self._constant.transposed
            self._transposed.split(csr_matrix(self._acting.T))
            if not self._transposed.factorise():
                return None
        other, found = self._transposed, np.zeros(len(right))
        for _ in range(_REFINED):
            left = right - other.times(found)
            more = other.solve(left)
            if more is None:
                return None
            found = found + more
        return found

    def mult(self, matrix: PETSc.Mat, values: PETSc.Vec, result: PETSc.Vec) -> None:
        """M y, as PETSc asks for it."""
        with result as array:
            array[:] = self.times(np.array(values.array_r))

    def times(self, values: Array) -> Array:
        """Product M y."""
        return self._constant.with_contacts(self._acting, values)

    def apply(self, preconditioner: PETSc.PC, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Nearly M⁻¹ r, as PETSc asks for it."""
        with solution as array:
            array[:] = self.nearly_solved(np.array(right.array_r))

    def nearly_solved(self, given: Array) -> Array:
        """Nearly M⁻¹ r: stiff first, then soft with what that leaves."""
        constant, count = self._constant, self._constant.count
        stiff = self._stiff_factor.solve(self._stiff_basis.T @ given[:count])
        moved = self._stiff_basis @ stiff
        left = np.zeros(constant.width)
        left[: constant.size] = given
        left[count : constant.size] -= constant.rows @ moved
        left -= self._of_displacements @ moved
        soft = self._solve_soft(
            np.concatenate([self._soft_directions.T @ left, -constant.derived @ moved])
        )
        stiff -= self._stiff_factor.solve(self._onto_stiff @ soft)
        found = (self._soft_directions @ soft)[: constant.size]
        found[:count] += self._stiff_basis @ stiff
        return np.asarray(found)

    def nearly_solved_each(self, columns: Array) -> Array:
        """Nearly M⁻¹ times each of some columns."""
        return np.column_stack([self.nearly_solved(column) for column in columns.T])

    def _solve_soft(self, left: Array) -> Array:
        """Soft directions, scalars and derived jumps, of all that is soft."""
        if self._soft_factor is None:
            return left
        solve = lapack.sgetrs if self._is_single else lapack.dgetrs
        soft, _ = solve(*self._soft_factor, left)
        return np.asarray(soft[: self._soft_directions.shape[1]])


def gmres(context: object, right: Array, left: float) -> Array | None:
    """Solve by GMRES; None where it does not end.

    Args:
        context: Multiplies, as PETSc's matrices in Python do, and is its own preconditioner.
        right: The right-hand side.
        left: Share of it that may be left.
    """
    size = (len(right), len(right))
    operator = PETSc.Mat().createPython(size, context, comm=PETSc.COMM_SELF)
    operator.setUp()
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setOperators(operator)
    solver.setType("gmres")
    solver.setGMRESRestart(_MOST_STEPS)
    solver.setPCSide(PETSc.PC.Side.RIGHT)
    solver.setTolerances(rtol=left, atol=0.0, max_it=_MOST_STEPS)
    solver.getPC().setType("python")
    solver.getPC().setPythonContext(context)
    given = PETSc.Vec().createWithArray(right, comm=PETSc.COMM_SELF)
    found = given.duplicate()
    solver.solve(given, found)
    result = np.array(found.array_r) if solver.getConvergedReason() > 0 else None
    for thing in (solver, operator, given, found):
        thing.destroy()
    return result


class _Nodes:
    """Directions at each node in which W is stiff, and those in which it is not.

    Attributes:
        scale: Stiffness of the body at each displacement's node: its largest there.

    Args:
        nodes: Number of the node that each displacement belongs to.
        stiffness: Of the body at each displacement.
    """

    def __init__(self, nodes: Integers, stiffness: Array) -> None:
        _, self._node, sizes = np.unique(nodes, return_inverse=True, return_counts=True)
        order = np.argsort(self._node, kind="stable")
        first = np.cumsum(sizes) - sizes
        self._slot = np.empty(len(nodes), dtype=np.int64)
        self._slot[order] = np.arange(len(nodes)) - np.repeat(first, sizes)
        self._alike = [
            (chosen, order[first[chosen][:, None] + np.arange(size)], size)
            for size in np.unique(sizes)
            for chosen in [np.flatnonzero(sizes == size)]
        ]
        largest = np.zeros(len(sizes))
        np.maximum.at(largest, self._node, stiffness)
        self.scale = largest[self._node]
        self._most = int(sizes.max(initial=0))

    def split(self, added: csr_matrix) -> tuple[csr_matrix, Flags]:
        """Orthonormal directions at the nodes as columns, and which of them are stiff.

        By the singular values of W at each node alone: it does not act on soft directions, though
        stiff ones may load them, as pressure loads a point that slips.
        """
        entries, count = added.tocoo(), len(self._node)
        own = self._node[entries.row] == self._node[entries.col]
        rows, columns = entries.row[own], entries.col[own]
        blocks = np.zeros((int(self._node.max(initial=-1)) + 1, self._most, self._most))
        blocks[self._node[rows], self._slot[rows], self._slot[columns]] = entries.data[own]
        stiff = np.zeros(count, dtype=bool)
        found: list[tuple[Integers, Integers, Array]] = []
        for chosen, dofs, size in self._alike:
            _, values, directions = np.linalg.svd(blocks[chosen, :size, :size])
            stiff[dofs] = values > _STIFF * self.scale[dofs]
            where = np.broadcast_to(dofs[:, None, :], directions.shape)
            which = np.broadcast_to(dofs[:, :, None], directions.shape)
            found.append((where.ravel(), which.ravel(), directions.ravel()))
        rows, columns, values = (np.concatenate(part) for part in zip(*found, strict=True))
        kept = values != 0
        basis = csr_matrix((values[kept], (rows[kept], columns[kept])), shape=(count, count))
        return basis, stiff
