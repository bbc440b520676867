"""The bulk condensed onto the contact dofs: one factorisation, then dense matrices only.

On one rank MUMPS makes the Schur complement while it factorises. PETSc's Python does not wrap
the four calls that ask for it, so they go through its C library. On several ranks, where such a
factor cannot solve, K with springs on the contact dofs is factorised, and the complement is the
inverse of its compliance there, less the springs.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from fenics_contact.errors import FenicsContactError

Array = NDArray[np.float64]

_WITHOUT_SCHUR_DOFS = 0  # MUMPS' ICNTL(26): solve with K_II alone


class CondensedBulk:
    """S = K_CC − K_CI K_II⁻¹ K_IC of a matrix K, and the way back.

    Args:
        matrix: K, symmetric or nearly so, with identity rows where displacements are held.
        dofs: Global rows of the contact dofs, sorted, the same on every rank.

    Attributes:
        schur: S, (dofs, dofs), on every rank (force/length).
        factorisations: How often a matrix of the bulk was factorised.
    """

    def __init__(self, matrix: Any, dofs: NDArray[np.int64]) -> None:
        self._matrix = matrix
        self.dofs = dofs
        self._comm = matrix.comm.tompi4py()
        start, end = matrix.getOwnershipRange()
        self._mine = np.flatnonzero((dofs >= start) & (dofs < end))
        self._local = dofs[self._mine] - start
        self._alone = self._comm.size == 1 and len(dofs) > 0
        self._work = [matrix.createVecRight() for _ in range(2)]
        self.factorisations = 1
        if self._alone:
            self._factor, self.schur = _factor_with_schur(matrix, dofs)
        else:
            self._factor_with_springs()

    def condense(self, load: Any) -> Array:
        """f_C − K_CI K_II⁻¹ f_I of a global vector, on every rank; collective."""
        if len(self.dofs) == 0:
            return np.zeros(0)
        solved, image = self._work
        self._factor.solve(load, solved)
        if not self._alone:
            return np.asarray(self._stiff @ self._gather(solved))
        with solved as array:
            array[self._local] = 0.0
        self._matrix.mult(solved, image)
        return self._gather(load) - self._gather(image)

    def expand(self, load: Any, condensed: Array, x: Array, solution: Any) -> None:
        """The solution for a load where the contact dofs are x; collective.

        Args:
            load: Global vector f.
            condensed: What ``condense`` made of it.
            x: Values of the contact dofs.
            solution: Global vector that receives it.
        """
        right, image = self._work
        load.copy(right)
        if self._alone:
            solution.set(0.0)
            self._set(solution, x)
            self._matrix.mult(solution, image)
            right.axpy(-1.0, image)
            self._factor.solve(right, solution)
            self._set(solution, x)
            return
        if len(self.dofs):
            springs = self._stiff @ x - condensed
            with right as array:
                array[self._local] += springs[self._mine]
        self._factor.solve(right, solution)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (self._factor, *self._work):
            thing.destroy()

    def _set(self, vector: Any, x: Array) -> None:
        with vector as array:
            array[self._local] = x[self._mine]

    def _gather(self, vector: Any) -> Array:
        """Values at the contact dofs, on every rank."""
        return np.concatenate(self._comm.allgather(np.array(vector.array_r[self._local])))

    def _factor_with_springs(self) -> None:
        """Compliance of the contact dofs, by solves with sparse right-hand sides."""
        matrix = self._matrix.copy()
        diagonal = self._matrix.getDiagonal()
        size = float(diagonal.max()[1]) if self._matrix.getSize()[0] else 1.0
        springs = diagonal.duplicate()
        springs.set(0.0)
        with springs as array:
            array[self._local] = size
        matrix.setDiagonal(diagonal + springs)
        self._factor = _plain_factor(matrix)
        columns = [self._column(number, diagonal) for number in range(len(self.dofs))]
        compliance = np.array(columns).reshape(len(self.dofs), -1).T
        self._stiff = np.linalg.inv(compliance) if len(columns) else np.zeros((0, 0))
        self.schur = self._stiff - size * np.eye(len(self.dofs))

    def _column(self, number: int, like: Any) -> Array:
        unit, solved = self._work
        unit.set(0.0)
        with unit as array:
            array[self._local[self._mine == number]] = 1.0
        self._factor.solve(unit, solved)
        return self._gather(solved)


def _plain_factor(matrix: Any) -> Any:
    factorisation = PETSc.PC().create(matrix.comm)
    factorisation.setOperators(matrix)
    factorisation.setType("lu")
    factorisation.setFactorSolverType("mumps")
    factorisation.setUp()
    return _Solver(factorisation)


def _factor_with_schur(matrix: Any, dofs: NDArray[np.int64]) -> tuple[Any, Array]:
    """MUMPS' factor of K_II, and S."""
    preconditioner = PETSc.PC().create(matrix.comm)
    preconditioner.setOperators(matrix)
    preconditioner.setType("lu")
    preconditioner.setFactorSolverType("mumps")
    preconditioner.setFactorSetUpSolverType()
    factor = preconditioner.getFactorMatrix()
    rows = PETSc.IS().createGeneral(dofs.astype(PETSc.IntType), comm=matrix.comm)
    library = ctypes.CDLL(PETSc.__file__)
    _call(library.MatFactorSetSchurIS, factor, rows)
    preconditioner.setUp()
    pointer = ctypes.c_void_p()
    _call(library.MatFactorGetSchurComplement, factor, ctypes.byref(pointer), None)
    schur = PETSc.Mat().createDense((len(dofs), len(dofs)), comm=matrix.comm)
    schur.setUp()
    schur.assemble()
    same = 0  # MatStructure's SAME_NONZERO_PATTERN
    _call(library.MatCopy, pointer, schur, ctypes.c_int(same))
    _call(library.MatFactorRestoreSchurComplement, factor, ctypes.byref(pointer), ctypes.c_int(0))
    found = np.array(schur.getDenseArray())
    factor.setMumpsIcntl(26, _WITHOUT_SCHUR_DOFS)
    schur.destroy()
    rows.destroy()
    return _Solver(preconditioner), found


def _call(function: Any, *arguments: Any) -> None:
    passed = [
        ctypes.c_void_p(argument.handle) if hasattr(argument, "handle") else argument
        for argument in arguments
    ]
    code = function(*passed)
    if code:
        raise FenicsContactError(f"PETSc's error {code} in {function.__name__}")


class _Solver:
    """Solves with a factor."""

    def __init__(self, preconditioner: Any) -> None:
        self._preconditioner = preconditioner

    def solve(self, right: Any, solution: Any) -> None:
        self._preconditioner.apply(right, solution)

    def destroy(self) -> None:
        self._preconditioner.destroy()
