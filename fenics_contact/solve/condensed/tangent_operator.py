"""The condensed tangent as an operator of PETSc."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from fenics_contact.solve.condensed.tangent import ContactTangent


class TangentOperator:
    """The dense tangent as a matrix and as a preconditioner; only rank 0 has one, and all rows."""

    def __init__(self, dense: ContactTangent | None) -> None:
        self._dense = dense

    def mult(self, matrix: PETSc.Mat, values: PETSc.Vec, result: PETSc.Vec) -> None:
        """M y."""
        if self._dense is not None:
            with result as array:
                array[:] = self._dense.multiply(np.array(values.array_r))

    def apply(self, preconditioner: PETSc.PC, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """M⁻¹ r."""
        if self._dense is not None:
            with solution as array:
                array[:] = self._dense.solve(np.array(right.array_r))
