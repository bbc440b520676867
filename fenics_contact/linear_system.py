"""The bulk's matrix in PETSc, of displacements alone or with a mean stress beside them."""

from __future__ import annotations

from typing import Any

import numpy as np
from dolfinx.fem import petsc as fem_petsc
from numpy.typing import NDArray
from petsc4py import PETSc

from fenics_contact.problem import Problem


class LinearSystem:
    """K, assembled once; each rank's rows are its displacements, then its mean stresses.

    Attributes:
        stiffness: K, or [[K, Bᵀ], [B, −C]] with a mean stress.
    """

    def __init__(self, problem: Problem) -> None:
        self._mixed = problem.elastic.mixed
        spaces = problem.spaces
        self._owned = spaces.owned_nodes * spaces.components
        displacement = _assembled(problem.elastic.stiffness)
        if self._mixed is None:
            self.stiffness = displacement
            return
        gradient, divergence = _assembled(self._mixed.gradient), _assembled(self._mixed.divergence)
        compressibility = _assembled(self._mixed.compressibility)
        compressibility.scale(-1.0)
        blocks = [[displacement, gradient], [divergence, compressibility]]
        nested = PETSc.Mat().createNest(blocks, comm=problem.comm)
        self.stiffness = nested.convert("aij", PETSc.Mat())
        self._column_of = self._displacement_columns(displacement)
        for matrix in (nested, displacement, gradient, divergence, compressibility):
            matrix.destroy()

    def destroy(self) -> None:
        """Free the matrix."""
        self.stiffness.destroy()

    def add(self, tangent: Any, form: Any) -> None:
        """Add a bilinear form of displacements to a matrix of the size of K."""
        if self._mixed is None:
            fem_petsc.assemble_matrix(tangent, form)
            return
        matrix = _assembled(form)
        first, columns, values = matrix.getValuesCSR()
        # The rank's rows of mean stresses, below those of displacements, get nothing.
        rows = tangent.getLocalSize()[0]
        first = np.append(first, np.full(rows + 1 - len(first), first[-1]))
        tangent.setValuesCSR(
            first.astype(PETSc.IntType),
            self._column_of(columns).astype(PETSc.IntType),
            values,
            addv=PETSc.InsertMode.ADD_VALUES,
        )
        matrix.destroy()

    def take_mean_stress(self, state: Any) -> None:
        """The mean stress of a state into its function, where there is one."""
        if self._mixed is None:
            return
        function = self._mixed.mean_stress
        found = state.array_r[self._owned :]
        function.x.array[: len(found)] = found
        function.x.scatter_forward()

    def _displacement_columns(self, displacement: Any) -> Any:
        """Map from columns of a matrix of displacements to those of K."""
        starts = displacement.getOwnershipRangesColumn()
        shifts = self.stiffness.getOwnershipRangesColumn()[:-1] - starts[:-1]

        def column_of(columns: NDArray[np.int32]) -> NDArray[np.int64]:
            owners = np.searchsorted(starts, columns, side="right") - 1
            return columns + shifts[owners]

        return column_of


def _assembled(form: Any) -> Any:
    matrix = fem_petsc.assemble_matrix(form)
    matrix.assemble()
    return matrix
