"""MUMPS' factor of a symmetric matrix of one rank, and its Schur complement.

PETSc's Python does not wrap the four calls that ask MUMPS for it, so they go through its C library.
"""

from __future__ import annotations

import ctypes

import numpy as np
from petsc4py import PETSc
from scipy.sparse import csr_matrix

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import FenicsContactError
from fenics_contact.common.factors.petsc_calls import call
from fenics_contact.common.petsc_options import PREFIX

_NEGATIVE_PIVOTS = 12  # MUMPS' INFOG(12)
_WITHOUT_SCHUR_DOFS = 0  # MUMPS' ICNTL(26): solve with K_II alone
# Of the root of both diagonal entries: how far the stiffness of an equal part that stands elsewhere
# may be off. Gmsh places nodes to 1e-12.
_SAME = 2e-11


class LocalFactor:
    """The factor of what is inside, and the Schur complement at the unknowns that are kept.

    Args:
        matrix: Sparse and symmetric, with identity rows where unknowns do not follow forces.
        kept: Unknowns to condense onto.
        chosen: How to factorise.

    Attributes:
        matrix: As given.
        size: Number of its rows.
        schur: The Schur complement, dense (kept, kept) (force/length).
        error: What went wrong on this rank, or None.
    """

    def __init__(self, matrix: csr_matrix, kept: Integers, chosen: mumps.Factorisation) -> None:
        self.matrix, self._kept, self.size = matrix, kept, matrix.shape[0]
        self._preconditioner: PETSc.PC = None
        self._right: PETSc.Vec = None
        self._solved: PETSc.Vec = None
        self.error: FenicsContactError | None = None
        self.schur = np.zeros((len(kept), len(kept)))
        count = self.matrix.shape[0]
        if count == len(kept):
            self.schur = self.matrix[kept][:, kept].toarray()
            return
        index = PETSc.IntType
        csr = (self.matrix.indptr.astype(index), self.matrix.indices.astype(index))
        operator = PETSc.Mat().createAIJ(
            (count, count), csr=(*csr, self.matrix.data), comm=PETSc.COMM_SELF
        )
        self._right, self._solved = operator.createVecRight(), operator.createVecLeft()
        self._kind = chosen.kind
        self._factorise(operator, chosen)
        operator.destroy()  # the preconditioner keeps it

    def _factorise(self, operator: PETSc.Mat, chosen: mumps.Factorisation) -> None:
        asked: list[PETSc.IS] = []

        def create(spare: int) -> PETSc.PC:
            self._preconditioner = _of_mumps(operator, chosen.kind)
            factor = self._preconditioner.getFactorMatrix()
            factor.setOptionsPrefix(PREFIX)
            factor.setMumpsIcntl(7, chosen.ordering)
            factor.setMumpsIcntl(14, spare)
            if len(self._kept):
                asked.append(self._ask_for_schur())
            return self._preconditioner

        self._preconditioner, self.error = mumps.factorised(create)
        if asked and self.error is None:
            self.schur = self._read_schur()
        for rows in asked:
            rows.destroy()

    @property
    def negative_pivots(self) -> int | None:
        """Number of negative eigenvalues of what is inside; None where LU does not tell."""
        if self._preconditioner is None:
            return 0
        if self._kind != "cholesky":
            return None
        return int(self._preconditioner.getFactorMatrix().getMumpsInfog(_NEGATIVE_PIVOTS))

    def forget_schur(self) -> None:
        """Keep the Schur complement no longer, which is large."""
        self.schur = np.zeros((0, 0))

    def forget_matrix(self) -> None:
        """Keep the matrix no longer: the factor serves no other one."""
        self.matrix = csr_matrix((0, 0))

    def serves(self, matrix: csr_matrix, kept: Integers) -> bool:
        """Whether it is the factor of another matrix, too, but for round-off.

        Args:
            matrix: As of a factor.
            kept: Likewise.
        """
        mine = self.matrix
        if not np.array_equal(self._kept, kept) or not _same_pattern(mine, matrix):
            return False
        size = np.sqrt(np.abs(mine.diagonal()))
        rows = np.repeat(size, np.diff(mine.indptr))
        return bool((np.abs(mine.data - matrix.data) <= _SAME * rows * size[mine.indices]).all())

    def solve(self, right: Array) -> Array:
        """K_II⁻¹ f_I at all unknowns, 0 at those that are kept.

        Args:
            right: f, (unknowns,) or several at once, (…, unknowns), which takes hardly longer.
        """
        if self._preconditioner is None:
            return np.zeros_like(right)
        if right.ndim == 1:
            with self._right as array:
                array[:] = right
            self._preconditioner.apply(self._right, self._solved)
            found = np.array(self._solved.array_r)
        else:
            found = self._solve_several(right)
        found[..., self._kept] = 0.0
        return found

    def _solve_several(self, right: Array) -> Array:
        if len(right) < 2:  # PETSc solves for a vector sooner than for a matrix of one column
            return np.array([self.solve(one) for one in right]).reshape(right.shape)
        columns = np.asfortranarray(right.T)  # as PETSc has them
        given = PETSc.Mat().createDense(columns.shape, array=columns, comm=PETSc.COMM_SELF)
        solved = PETSc.Mat().createDense(columns.shape, comm=PETSc.COMM_SELF)
        for matrix in (given, solved):
            matrix.setUp()
            matrix.assemble()
        self._preconditioner.matApply(given, solved)
        found = np.array(solved.getDenseArray().T)
        for matrix in (given, solved):
            matrix.destroy()
        return found

    def destroy(self) -> None:
        """Free PETSc's objects."""
        if self._preconditioner is not None:
            for thing in (self._preconditioner, self._right, self._solved):
                thing.destroy()

    def _ask_for_schur(self) -> PETSc.Mat:
        """Tell MUMPS which unknowns to condense onto; they are to live until it has."""
        rows = PETSc.IS().createGeneral(self._kept.tolist(), comm=PETSc.COMM_SELF)
        call("MatFactorSetSchurIS", self._preconditioner.getFactorMatrix(), rows)
        return rows

    def _read_schur(self) -> Array:
        """S, of a factorisation that has succeeded; from then on MUMPS solves without it."""
        factor, size = self._preconditioner.getFactorMatrix(), len(self._kept)
        pointer = ctypes.c_void_p()
        call("MatFactorGetSchurComplement", factor, ctypes.byref(pointer), None)
        found = np.zeros((size, size), order="F")
        schur = PETSc.Mat().createDense((size, size), array=found, comm=PETSc.COMM_SELF)
        schur.assemble()
        same = 0  # MatStructure's SAME_NONZERO_PATTERN
        call("MatCopy", pointer, schur, ctypes.c_int(same))
        call("MatFactorRestoreSchurComplement", factor, ctypes.byref(pointer), ctypes.c_int(0))
        if self._kind == "cholesky":  # gives the lower triangle only
            found = np.tril(found) + np.tril(found, -1).T
        factor.setMumpsIcntl(26, _WITHOUT_SCHUR_DOFS)
        schur.destroy()
        return np.ascontiguousarray(found.T)  # by rows: PETSc stores by columns


def _same_pattern(one: csr_matrix, other: csr_matrix) -> bool:
    return (
        one.shape == other.shape
        and np.array_equal(one.indptr, other.indptr)
        and np.array_equal(one.indices, other.indices)
    )


def _of_mumps(operator: PETSc.Mat, kind: str) -> PETSc.PC:
    preconditioner = PETSc.PC().create(PETSc.COMM_SELF)
    preconditioner.setOperators(operator)
    preconditioner.setType(kind)
    preconditioner.setFactorSolverType("mumps")
    preconditioner.setFactorSetUpSolverType()
    return preconditioner
