"""K_c as a sparse matrix of all unknowns that is empty away from contacts and scalars."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Integers
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.bordered_tangent import AddedTangents, add_entries
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix

Pairs = tuple[Integers, Integers]


class ContactMatrix(AddedTangents):
    """What K lacks to be the tangent, so that no copy of K is made.

    Attributes:
        matrix: The entries, in the layout of all unknowns.

    Args:
        problem: The problem.
        displacement: K of the displacements, before supports.
        diagonal: That of the constrained rows in K once these are cleared (force/length).
    """

    def __init__(self, problem: Problem, displacement: PETSc.Mat, diagonal: float) -> None:
        super().__init__(problem, displacement)
        self._diagonal = diagonal
        own = self._owned + (self.scalars if problem.comm.rank == 0 else 0)
        sizes = (own, PETSc.DETERMINE)
        self.matrix: PETSc.Mat = PETSc.Mat().createAIJ((sizes, sizes), comm=problem.comm)
        if self.scalars:
            self._place(displacement, self.matrix)
        constrained = problem.constrained[problem.constrained < self._owned]
        self._constrained = self._rows(self.matrix, constrained)
        parts = [self._between_nodes(surface) for surface in self.surfaces if surface.contact.terms]
        parts += [self._with_scalar(number) for number in range(self.scalars)]
        rows, columns = (
            np.concatenate([np.zeros(0, dtype=np.int64), *part])
            for part in (zip(*parts, strict=True) if parts else ((), ()))
        )
        self.matrix.setUp()
        add_entries(self.matrix, rows, columns, np.zeros(len(rows)))
        self._reserve_pairs(self.matrix)
        self.matrix.assemble()
        keep = PETSc.Mat.Option.KEEP_NONZERO_PATTERN
        self.matrix.setOption(keep, True)

    def _between_nodes(self, surface: SurfaceMatrix) -> Pairs:
        """Pairs of dofs of the same facet."""
        rows, columns = surface.pattern()
        return self._matrix_rows(rows), self._matrix_rows(columns)

    def _with_scalar(self, number: int) -> Pairs:
        """Pairs of a scalar with what it may be coupled with."""
        coupled = self._rows(self.matrix, self._border_dofs(number)).astype(np.int64)
        scalar = np.full(len(coupled), self._scalar_row(self.matrix, number))
        corner = np.zeros(0, dtype=np.int64)
        if self._problem.comm.rank == 0:
            corner = np.array([self._scalar_row(self.matrix, k) for k in range(self.scalars)])
        own = np.full(len(corner), self._scalar_row(self.matrix, number))
        return np.concatenate([coupled, scalar, own]), np.concatenate([scalar, coupled, corner])

    def linearise(self) -> None:
        """Take the tangents that the contacts' terms have at present; collective."""
        self.matrix.zeroEntries()
        self.add_contacts(self.matrix)
        self.add_far_field(self.matrix)
        self.matrix.assemble()
        self.matrix.zeroRowsColumns(self._constrained, diag=0.0)
        if self._problem.far_field is not None:
            self.tie_far_field(self.matrix)
            self._scale_ties()

    def _scale_ties(self) -> None:
        """The rows u − U R = 0 stand in K with its own diagonal."""
        scale = self.matrix.createVecLeft()
        scale.set(1.0)
        with scale as array:
            array[self._constrained - self.matrix.getOwnershipRange()[0]] = self._diagonal
        self.matrix.diagonalScale(scale, None)
        scale.destroy()

    def magnitude(self, lengths: PETSc.Vec, result: PETSc.Vec) -> None:
        """|K_c| times a vector; collective."""
        first, columns, values = self.matrix.getValuesCSR()
        absolute = PETSc.Mat().createAIJ(
            self.matrix.getSizes(), csr=(first, columns, np.abs(values)), comm=self.matrix.comm
        )
        absolute.mult(lengths, result)
        absolute.destroy()

    def destroy(self) -> None:
        """Free the matrix."""
        self.matrix.destroy()
