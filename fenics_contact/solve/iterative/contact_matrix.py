"""K_c as a sparse matrix of all unknowns that is empty away from contacts and scalars."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Integers
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.bordered_tangent import AddedTangents
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
        self._direct = [s for s in self.surfaces if s.contact.kinematics.pairing is None]
        parts = [self._at_places(surface) for surface in self._direct]
        filled = sum(len(part[0]) for part in parts)
        parts += [self._of_pair(s) for s in self.surfaces if s not in self._direct]
        parts += [self._with_scalar(number) for number in range(self.scalars)]
        rows, columns = (
            np.concatenate([np.zeros(0, dtype=np.int64), *part]).astype(PETSc.IntType)
            for part in (zip(*parts, strict=True) if parts else ((), ()))
        )
        self._room = np.zeros(len(rows) - filled)
        self.matrix.setPreallocationCOO(rows, columns)
        self.matrix.assemble()
        keep = PETSc.Mat.Option.KEEP_NONZERO_PATTERN
        self.matrix.setOption(keep, True)

    def _at_places(self, surface: SurfaceMatrix) -> Pairs:
        """Pairs of dofs, one for each entry of a contact with an obstacle."""
        assembled = surface.assembled
        if assembled is None:
            none = np.zeros(0, dtype=np.int64)
            return none, none
        rows, columns = surface.dofs[assembled.rows], surface.dofs[assembled.columns]
        return self._matrix_rows(rows), self._matrix_rows(columns)

    def _of_pair(self, surface: SurfaceMatrix) -> Pairs:
        """Pairs of dofs of two surfaces that touch each other; one rank gives all."""
        rows, columns = surface.pattern()
        if self._problem.comm.rank > 0 or surface.assembled is None:
            rows = columns = rows[:0]
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
        entries = [surface.entries() for surface in self.surfaces]
        direct = [
            values
            for surface, (_, _, values) in zip(self.surfaces, entries, strict=True)
            if surface in self._direct
        ]
        self.matrix.setValuesCOO(np.concatenate([*direct, self._room]))
        for surface, motions, found in zip(self.surfaces, self._motions, entries, strict=True):
            if surface not in self._direct:
                self._add_on_body(self.matrix, surface, found)
            self._add_borders(self.matrix, surface, motions, found)
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
