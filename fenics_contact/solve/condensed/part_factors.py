"""The factors of a rank's cells, one for each connected part, with their Schur complements.

MUMPS' factor of one connected part of the cells of a rank, and its Schur complement.

PETSc's Python does not wrap the four calls that ask MUMPS for it, so they go through its C library.

The factors of a rank's cells, a connected part at a time.

What no cell joins has no common stiffness: so each part has its own factor. Parts that are the
same but for where they stand have one together, and one of a body before serves again where a
change has left its part as it was.
"""

from __future__ import annotations

import ctypes

import numpy as np
from petsc4py import PETSc
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import FenicsContactError
from fenics_contact.common.petsc_options import PREFIX
from fenics_contact.solve.systems.bulk_matrix import call
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness

_WITHOUT_SCHUR_DOFS = 0  # MUMPS' ICNTL(26): solve with K_II alone
# Of the root of both diagonal entries: how far the stiffness of an equal part that stands elsewhere
# may be off. Gmsh places nodes to 1e-12.
_SAME = 2e-11


class LocalFactor:
    """The factor of the inside of a connected part.

    Args:
        matrix: Sparse and symmetric, with identity rows where unknowns do not follow forces.
        kept: Unknowns to condense onto.
        chosen: How to factorise.

    Attributes:
        matrix: As given.
        schur: The Schur complement, dense (kept, kept) (force/length).
        error: What went wrong on this rank, or None.
    """

    def __init__(self, matrix: csr_matrix, kept: Integers, chosen: mumps.Factorisation) -> None:
        self.matrix, self._kept = matrix, kept
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

    def forget_schur(self) -> None:
        """Keep the Schur complement no longer, which is large."""
        self.schur = np.zeros((0, 0))

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
        if not len(right):
            return np.zeros_like(right)
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


# Nodes of equal parts are at the same places but for this share of a part's size.
_SAME_PLACE = 1e-7


class KnownFactors:
    """The factors of this rank's parts, kept from one body to the next.

    Attributes:
        made: How many were made so far.
    """

    def __init__(self) -> None:
        self.made = 0
        self._all: list[LocalFactor] = []

    def of(self, wanted: list[tuple[csr_matrix, Integers]], is_plane: bool) -> list[LocalFactor]:
        """The factors of some parts; those that are of none of them are freed first.

        Args:
            wanted: Of each part its stiffness, with identity rows for what is held, and the
                unknowns to condense onto.
            is_plane: Whether the body has two dimensions.
        """
        found = [self._known(*one) for one in wanted]
        self._keep([one for one in found if one is not None])
        for number, (matrix, kept) in enumerate(wanted):
            if found[number] is None:
                found[number] = self._known(matrix, kept) or self._make(matrix, kept, is_plane)
        return [one for one in found if one is not None]

    def _known(self, matrix: csr_matrix, kept: Integers) -> LocalFactor | None:
        return next((one for one in self._all if one.serves(matrix, kept)), None)

    def _make(self, matrix: csr_matrix, kept: Integers, is_plane: bool) -> LocalFactor:
        found = LocalFactor(matrix, kept, mumps.fastest(is_plane, matrix.shape[0]))
        self.made += 1
        if found.error is None:
            self._all.append(found)
        return found

    def _keep(self, used: list[LocalFactor]) -> None:
        """Free the others."""
        for one in self._all:
            if not any(one is other for other in used):
                one.destroy()
        self._all = [one for one in self._all if any(one is other for other in used)]

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._keep([])


class RankFactor:
    """The inside of this rank's cells, and what is left of it at the unknowns that are kept.

    Args:
        stiffness: K by ranks.
        held: Unknowns that do not follow forces: identity rows take their place.
        kept: Unknowns to condense onto, sorted.
        known: Factors of a body before; what is kept there outlives this one.

    Attributes:
        error: What went wrong on this rank, or None.
        is_new: Whether any part was factorised.
    """

    def __init__(
        self, stiffness: LocalStiffness, held: Flags, kept: Integers, known: KnownFactors | None
    ) -> None:
        self._is_own = known is None  # then its factors end with it
        self._known = KnownFactors() if known is None else known
        before = self._known.made
        matrix = _without(stiffness.matrix, held)
        self._parts = _unknowns_of_parts(stiffness)
        at = np.zeros(len(held), dtype=bool)
        at[kept] = True
        pieces = [matrix] if len(self._parts) == 1 else [_piece(matrix, p) for p in self._parts]
        wanted = [(m, np.flatnonzero(at[p])) for m, p in zip(pieces, self._parts, strict=True)]
        self._matrices = pieces
        self._factors = self._known.of(wanted, stiffness.is_plane)
        self._kept = [np.searchsorted(kept, p[at[p]]) for p in self._parts]
        self._count = len(kept)
        errors = [one.error for one in self._factors if one.error is not None]
        self.error: FenicsContactError | None = errors[0] if errors else None
        self.is_new = self._known.made > before

    def schur(self) -> Array:
        """The Schur complement, dense (kept, kept), which is large."""
        if len(self._parts) == 1:
            return self._factors[0].schur
        found = np.zeros((self._count, self._count))
        for places, factor in zip(self._kept, self._factors, strict=True):
            found[np.ix_(places, places)] = factor.schur
        return found

    def forget_schur(self) -> None:
        """Keep it no longer, unless the factors are for other bodies, too."""
        if self._is_own:
            for factor in self._factors:
                factor.forget_schur()

    def times(self, values: Array) -> Array:
        """K x, without what is held, of one x or several, (…, unknowns)."""
        found = np.zeros_like(values)
        for part, matrix in zip(self._parts, self._matrices, strict=True):
            found[..., part] = (matrix @ values[..., part].T).T
        return found

    def solve(self, right: Array) -> Array:
        """K_II⁻¹ f_I at all unknowns, 0 at those that are kept; of several f, (…, unknowns)."""
        found = np.zeros_like(right)
        for part, factor in zip(self._parts, self._factors, strict=True):
            found[..., part] = factor.solve(right[..., part])
        return found

    def destroy(self) -> None:
        """Free PETSc's objects, but those of factors that others may use."""
        if self._is_own:
            self._known.destroy()


def _unknowns_of_parts(stiffness: LocalStiffness) -> list[Integers]:
    """The unknowns of each connected part of this rank's cells.

    Of several parts in an order that does not depend on where a part stands, so that equal ones
    have equal matrices.
    """
    count, part = connected_components(stiffness.matrix, directed=False)
    if count <= 1:
        return [np.arange(len(part))]
    places, kinds = stiffness.places()
    found = []
    for number in range(count):
        unknowns = np.flatnonzero(part == number)
        own = places[unknowns] - places[unknowns].min(axis=0)
        size = max(float(own.max()), np.finfo(float).tiny)
        rounded = np.round(own / (_SAME_PLACE * size) + 0.377)  # no edge falls on a half
        found.append(unknowns[np.lexsort((kinds[unknowns], *rounded.T))])
    return found


def _piece(matrix: csr_matrix, unknowns: Integers) -> csr_matrix:
    found = csr_matrix(matrix[unknowns][:, unknowns])
    found.sort_indices()
    return found


def _without(matrix: csr_matrix, held: Flags) -> csr_matrix:
    """A sparse matrix with identity rows and columns where displacements are held."""
    found = csr_matrix((matrix.data.copy(), matrix.indices, matrix.indptr), shape=matrix.shape)
    found.data[held[found.indices]] = 0.0
    for row in np.flatnonzero(held):
        entries = slice(found.indptr[row], found.indptr[row + 1])
        found.data[entries] = found.indices[entries] == row
    return found
