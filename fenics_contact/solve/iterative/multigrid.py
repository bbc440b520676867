"""Multigrid for the bulk: PETSc's smoothed aggregation (GAMG), set up once."""

from __future__ import annotations

from petsc4py import PETSc

from fenics_contact.common.arrays import Array
from fenics_contact.common.petsc.options import BULK_PREFIX

_OPTIONS = {
    "pc_type": "gamg",
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_pc_type": "jacobi",
}


class Multigrid:
    """V-cycles for a symmetric positive definite stiffness of displacements.

    Attributes:
        setups: How often the hierarchy was built.
        cycles: V-cycles so far.

    Args:
        matrix: K with rows and columns of supports cleared.
        rigid: Rigid motions at this rank's rows, (rows, modes): what coarse levels must keep.
    """

    def __init__(self, matrix: PETSc.Mat, rigid: Array) -> None:
        self.setups = 0
        self.cycles = 0
        matrix.setOption(PETSc.Mat.Option.SPD, True)
        self._vectors = [matrix.createVecRight() for _ in range(rigid.shape[1])]
        for vector, mode in zip(self._vectors, rigid.T, strict=True):
            with vector as array:
                array[:] = mode
        _orthonormalise(self._vectors)
        nearly_null = PETSc.NullSpace().create(vectors=self._vectors, comm=matrix.comm)
        matrix.setNearNullSpace(nearly_null)
        nearly_null.destroy()
        self._set_up(matrix)

    def _set_up(self, matrix: PETSc.Mat) -> None:
        self._preconditioner = PETSc.PC().create(matrix.comm)
        self._preconditioner.setOptionsPrefix(BULK_PREFIX)
        self._preconditioner.setOperators(matrix)
        options = PETSc.Options()
        own = [n for n in _OPTIONS if not options.hasName(BULK_PREFIX + n)]
        try:
            for name in own:
                options.setValue(BULK_PREFIX + name, _OPTIONS[name])
            self._preconditioner.setFromOptions()
            self._preconditioner.setUp()
        finally:
            for name in own:  # the database is global
                options.delValue(BULK_PREFIX + name)
        self.setups += 1

    def apply(self, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Apply one V-cycle; collective."""
        self._preconditioner.apply(right, solution)
        self.cycles += 1

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (self._preconditioner, *self._vectors):
            thing.destroy()


def _orthonormalise(vectors: list[PETSc.Vec]) -> None:
    """Orthonormalise by Gram and Schmidt, twice against round-off; vectors are independent."""
    for number, vector in enumerate(vectors):
        for before in vectors[:number] * 2:
            vector.axpy(-vector.dot(before), before)
        vector.normalize()
