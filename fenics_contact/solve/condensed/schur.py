"""The bulk condensed onto the contact dofs: one factorisation, then dense matrices only.

Each rank condenses its own cells onto what it shares with others and with the contacts, by MUMPS'
Schur complement; rank 0 adds these up and condenses what ranks share (substructuring). PETSc's
Python does not wrap the four calls that ask MUMPS for it, so they go through its C library.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import partial

import numpy as np
from petsc4py import PETSc
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import FenicsContactError
from fenics_contact.common.parallel import (
    from_root,
    gathered_on_root,
    of_every_rank,
    raise_together,
)
from fenics_contact.common.petsc_options import PREFIX
from fenics_contact.solve.condensed.rank_stiffness import LocalStiffness
from fenics_contact.solve.systems import mumps
from fenics_contact.solve.systems.petsc_library import call

_WITHOUT_SCHUR_DOFS = 0  # MUMPS' ICNTL(26): solve with K_II alone
_SPARE_WORKSPACE = 50  # ICNTL(14), in per cent: a mean stress may need other pivots than foreseen


class CondensedBulk:
    """S = K_CC − K_CI K_II⁻¹ K_IC of K, and the way back.

    Args:
        stiffness: K by ranks.
        held: Which of this rank's unknowns supports hold.
        contact: Numbers of the contact dofs over all ranks, sorted, none held.

    Attributes:
        comm: Communicator.
        count: Number of contact dofs.
        schur: S, (contact, contact) (force/length); on rank 0, else None.
        factorisations: How often K was factorised.

    Raises:
        MachineError: MUMPS had not the memory on a rank; on every rank.
        NotConvergedError: Supports and contacts do not hold the body; likewise.
    """

    factorisations = 1

    def __init__(self, stiffness: LocalStiffness, held: Flags, contact: Integers) -> None:
        self.comm = stiffness.comm
        at_contact = np.isin(stiffness.numbers, contact) & ~held
        self._kept = np.flatnonzero((stiffness.shared & ~held) | at_contact)
        chosen = mumps.fastest(stiffness.is_plane, len(held))
        self._inside = LocalFactor(stiffness.matrix, held, self._kept, chosen)
        raise_together(self.comm, self._inside.error)
        self._numbers = stiffness.numbers[self._kept]
        every = of_every_rank(self.comm, self._numbers)
        union = np.unique(np.concatenate(every))
        between = np.setdiff1d(union, contact)
        # Contact dofs first, then those between ranks.
        order = np.argsort(np.concatenate([contact, between]), kind="stable")
        self._places = [order[np.searchsorted(union, numbers)] for numbers in every]
        self.count = len(contact)
        self._size = len(union)
        self.schur = self._sum_and_condense(self._inside.take_schur())

    def _sum_and_condense(self, local: Array) -> Array | None:
        """S of all ranks together, on rank 0."""
        # Gathering makes copies.
        parts = gathered_on_root(self.comm, local) if self.comm.size > 1 else [local]
        if parts is None:
            return None
        if len(parts) == 1:
            whole, order = parts[0], self._places[0].argsort()
            if (np.diff(order) < 0).any():
                whole = whole[np.ix_(order, order)]
        else:
            whole = np.zeros((self._size, self._size))
            for places, part in zip(self._places, parts, strict=True):
                whole[np.ix_(places, places)] += part
        contact, between = slice(0, self.count), slice(self.count, None)
        self._between = lu_factor(whole[between, between]) if self._size > self.count else None
        self._carried = np.zeros((0, self.count))
        if self._between is None:
            return np.asarray(whole)
        self._carried = lu_solve(self._between, whole[between, contact])
        return np.asarray(whole[contact, contact] - whole[contact, between] @ self._carried)

    def condense(self, load: Array) -> Array:
        """f_C − K_CI K_II⁻¹ f_I, on rank 0; collective.

        Args:
            load: This rank's share of the forces on its unknowns; values where held.
        """
        solved = self._inside.solve(load)
        left = (load - self._inside.matrix @ solved)[self._kept]
        parts = gathered_on_root(self.comm, left)
        self._load = np.zeros(self._size)
        for places, part in zip(self._places, parts or (), strict=False):
            self._load[places] += part
        contact, between = self._load[: self.count], self._load[self.count :]
        if parts is None:
            return np.zeros(self.count)
        return np.asarray(contact - self._carried.T @ between)

    def expand(self, load: Array, x: Array) -> Array:
        """This rank's unknowns where the contact dofs are x (on rank 0); collective.

        Args:
            load: As given to ``condense`` (length where held).
            x: Displacements of the contact dofs; used on rank 0.
        """
        if self._size > self.count:
            self.condense(load)
        values = np.zeros(self._size)
        if self.comm.rank == 0:
            values[: self.count] = x
            if self._between is not None:
                loads = self._load[self.count :]
                values[self.count :] = lu_solve(self._between, loads) - self._carried @ x
        values = from_root(self.comm, values)
        kept = np.zeros(len(load))
        kept[self._kept] = values[self._places[self.comm.rank]]
        found = self._inside.solve(load - self._inside.matrix @ kept)
        found[self._kept] = kept[self._kept]
        return found

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._inside.destroy()


class BulkWithoutFactor(CondensedBulk):
    """The same of an S that is known: K is factorised when something else is asked for.

    Args:
        stiffness: K by ranks.
        held: Which of this rank's unknowns supports hold.
        contact: Numbers of the contact dofs over all ranks, sorted, none held.
        schur: S on rank 0, else None.
    """

    def __init__(
        self, stiffness: LocalStiffness, held: Flags, contact: Integers, schur: Array | None
    ) -> None:
        self.comm, self.count, self.schur = stiffness.comm, len(contact), schur
        self.factorisations = 0
        self._make: Callable[[], CondensedBulk] = partial(CondensedBulk, stiffness, held, contact)
        self._made: CondensedBulk | None = None

    @property
    def _whole(self) -> CondensedBulk:
        if self._made is None:
            self._made = self._make()
            self._made.schur = None  # it is known
            self.factorisations = 1
        return self._made

    def condense(self, load: Array) -> Array:
        """As of any bulk; collective."""
        return self._whole.condense(load)

    def expand(self, load: Array, x: Array) -> Array:
        """As of any bulk; collective."""
        return self._whole.expand(load, x)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        if self._made is not None:
            self._made.destroy()


class LocalFactor:
    """MUMPS' factor of the inside of this rank's cells, and their Schur complement.

    Args:
        matrix: Sparse and symmetric.
        held: Unknowns that do not follow forces: identity rows take their place.
        kept: Unknowns to condense onto.
        chosen: How to factorise.

    Attributes:
        matrix: PETSc's, without what is held, as a sparse one.
        error: What went wrong on this rank, or None.
    """

    def __init__(
        self, matrix: csr_matrix, held: Flags, kept: Integers, chosen: mumps.Factorisation
    ) -> None:
        self.matrix = _without(matrix, held)
        self._kept = kept
        self._preconditioner: PETSc.PC = None
        self._right: PETSc.Vec = None
        self._solved: PETSc.Vec = None
        self.error: FenicsContactError | None = None
        self._schur = np.zeros((len(kept), len(kept)))
        count = self.matrix.shape[0]
        if count == len(kept):
            self._schur = self.matrix[kept][:, kept].toarray()
            return
        index = PETSc.IntType
        csr = (self.matrix.indptr.astype(index), self.matrix.indices.astype(index))
        operator = PETSc.Mat().createAIJ(
            (count, count), csr=(*csr, self.matrix.data), comm=PETSc.COMM_SELF
        )
        self._right, self._solved = operator.createVecRight(), operator.createVecLeft()
        self._kind = chosen.kind
        self._preconditioner = _factorised_by_mumps(operator, chosen.kind)
        factor = self._preconditioner.getFactorMatrix()
        factor.setOptionsPrefix(PREFIX)
        factor.setMumpsIcntl(7, chosen.ordering)
        factor.setMumpsIcntl(14, _SPARE_WORKSPACE)
        operator.destroy()  # the preconditioner keeps it
        rows = self._ask_for_schur() if len(kept) else None
        self._preconditioner.setUp()
        self.error = mumps.failure(factor)
        if rows is not None:
            if self.error is None:
                self._schur = self._read_schur()
            rows.destroy()

    def take_schur(self) -> Array:
        """The Schur complement, dense (kept, kept), which is large: it is not kept here."""
        found, self._schur = self._schur, np.zeros((0, 0))
        return found

    def solve(self, right: Array) -> Array:
        """K_II⁻¹ f_I at all unknowns, 0 at those that are kept."""
        if self._preconditioner is None:
            return np.zeros(len(right))
        with self._right as array:
            array[:] = right
        self._preconditioner.apply(self._right, self._solved)
        found = np.array(self._solved.array_r)
        found[self._kept] = 0.0
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


def _without(matrix: csr_matrix, held: Flags) -> csr_matrix:
    """A sparse matrix with identity rows and columns where displacements are held."""
    found = csr_matrix((matrix.data.copy(), matrix.indices, matrix.indptr), shape=matrix.shape)
    found.data[held[found.indices]] = 0.0
    for row in np.flatnonzero(held):
        entries = slice(found.indptr[row], found.indptr[row + 1])
        found.data[entries] = found.indices[entries] == row
    return found


def _factorised_by_mumps(operator: PETSc.Mat, kind: str) -> PETSc.PC:
    preconditioner = PETSc.PC().create(PETSc.COMM_SELF)
    preconditioner.setOperators(operator)
    preconditioner.setType(kind)
    preconditioner.setFactorSolverType("mumps")
    preconditioner.setFactorSetUpSolverType()
    return preconditioner
