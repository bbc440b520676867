"""The bulk condensed onto the contact dofs, and rows of numbers that are linear in its answer.

One factorisation, then dense matrices only. Each rank
condenses its own cells onto what it shares with others and with the contacts, by MUMPS' Schur
complement; rank 0 adds these up and condenses what ranks share (substructuring).

A number of the body that is linear in its displacement is L = t · u + a · r: t forces on the
displacements, a displacements of what is held, r the reactions there. Its *row* is the adjoint
state v, with v = a at what is held, nothing at the contact dofs, and K v = −t inside. As K is
symmetric,

    L = (K v + t) · u − v · f,

of which K v + t vanishes inside: so displacements of contact dofs and of what is held say all, with
the forces f that act on the body, of loads, contacts and shortened parts. A row takes one solve
with the factorised bulk, and is kept.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import (
    from_root,
    gathered_on_root,
    of_every_rank,
    raise_together,
    total,
)
from fenics_contact.solve.condensed.part_factors import KnownFactors, RankFactor
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness


class CondensedBulk:
    """S = K_CC − K_CI K_II⁻¹ K_IC of K, and the way back.

    Args:
        stiffness: K by ranks.
        held: Which of this rank's unknowns supports hold.
        contact: Numbers of the contact dofs over all ranks, sorted, none held.
        known: Factors of a body before, which serve where a part is the same.

    Attributes:
        comm: Communicator.
        count: Number of contact dofs.
        schur: S, (contact, contact) (force/length); on rank 0, else None.
        factorisations: How often K was factorised: 0 if all of its factors were known.

    Raises:
        MachineError: MUMPS had not the memory on a rank; on every rank.
        NotConvergedError: Supports and contacts do not hold the body; likewise.
    """

    def __init__(
        self,
        stiffness: LocalStiffness,
        held: Flags,
        contact: Integers,
        known: KnownFactors | None = None,
    ) -> None:
        self.comm = stiffness.comm
        at_contact = np.isin(stiffness.numbers, contact) & ~held
        self._kept = np.flatnonzero((stiffness.shared & ~held) | at_contact)
        self._inside = RankFactor(stiffness, held, self._kept, known)
        raise_together(self.comm, self._inside.error)
        self.factorisations = int(any(of_every_rank(self.comm, self._inside.is_new)))
        self._numbers = stiffness.numbers[self._kept]
        every = of_every_rank(self.comm, self._numbers)
        union = np.unique(np.concatenate(every))
        between = np.setdiff1d(union, contact)
        # Contact dofs first, then those between ranks.
        order = np.argsort(np.concatenate([contact, between]), kind="stable")
        self._places = [order[np.searchsorted(union, numbers)] for numbers in every]
        self.count = len(contact)
        self._size = len(union)
        self._between: tuple[Array, Integers] | None = None
        self.schur = self._sum_and_condense(self._inside.schur())
        self._inside.forget_schur()

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

    def negative_eigenvalues(self) -> int | None:
        """How many K_II has, contact dofs being held; None where not known; collective."""
        counts = of_every_rank(self.comm, self._inside.negative_pivots)
        known = [count for count in counts if count is not None]
        between = 0 if self._between is None else _negative(*self._between)
        between = from_root(self.comm, between)
        return sum(known) + between if len(known) == len(counts) else None

    def condense(self, load: Array) -> Array:
        """f_C − K_CI K_II⁻¹ f_I, on rank 0; collective.

        Args:
            load: This rank's share of the forces on its unknowns; values where held. Or several at
                once, (…, unknowns).
        """
        self._load = self._left(load, self._inside.solve(load))
        contact, between = self._load[..., : self.count], self._load[..., self.count :]
        if self.comm.rank > 0:
            return np.zeros_like(contact)
        return np.asarray(contact - between @ self._carried)

    def _left(self, load: Array, found: Array) -> Array:
        """Forces f − K u at what is kept, on rank 0; collective."""
        left = load[..., self._kept] - self._inside.times_at_kept(found)
        parts = gathered_on_root(self.comm, left)
        every = np.zeros((*load.shape[:-1], self._size))
        for places, part in zip(self._places, parts or (), strict=False):
            every[..., places] += part
        return every

    def condense_and_expand(self, load: Array) -> tuple[Array, Array]:
        """Condensed load, and the unknowns under it while contact dofs are held; collective.

        With half the solves of both.

        Args:
            load: As of ``condense``.
        """
        found = self.expand(load, np.zeros((*load.shape[:-1], self.count)))
        return self._left(load, found)[..., : self.count], found

    def expand(self, load: Array, x: Array) -> Array:
        """This rank's unknowns where the contact dofs are x (on rank 0); collective.

        Args:
            load: As given to ``condense`` (length where held); or several at once, (…, unknowns).
            x: Displacements of the contact dofs, likewise; used on rank 0.
        """
        if self._size > self.count:
            self.condense(load)
        values = np.zeros((*load.shape[:-1], self._size))
        if self.comm.rank == 0:
            values[..., : self.count] = x
            if self._between is not None:
                loads = self._load[..., self.count :]
                solved = lu_solve(self._between, loads.T) - self._carried @ x.T
                values[..., self.count :] = solved.T
        values = from_root(self.comm, values)
        own = values[..., self._places[self.comm.rank]]
        kept = np.zeros_like(load)
        kept[..., self._kept] = own
        found = self._inside.solve(load - self._inside.times(kept) if own.any() else load)
        found[..., self._kept] = own
        return found

    def moved(self, load: Array) -> Array | None:
        """How a load moves the free contact dofs while what it is condensed onto is held.

        Collective.

        Args:
            load: As of ``condense``.

        Returns:
            On rank 0 (length), (…, contact dofs); None where it is condensed onto all of them.
        """
        return None

    def forget_schur(self) -> None:
        """Keep the Schur complement no longer, which is large."""
        self.schur = None

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._inside.destroy()


def _negative(factors: Array, pivots: Integers) -> int:
    """Number of negative eigenvalues of a symmetric matrix, by its LU factors."""
    found = (np.tril(factors, -1) + np.eye(len(factors))) @ np.triu(factors)
    for row in reversed(range(len(pivots))):
        found[[row, pivots[row]]] = found[[pivots[row], row]]
    return int((np.linalg.eigvalsh(found) < 0).sum())


class BulkWithoutFactor(CondensedBulk):
    """The condensed bulk of a known S: K is factorised when something else is asked for.

    Args:
        stiffness: K by ranks.
        held: Which of this rank's unknowns supports hold.
        contact: Numbers of the contact dofs over all ranks, sorted, none held.
        schur: S on rank 0, else None.
        known: As of any bulk.
    """

    def __init__(
        self,
        stiffness: LocalStiffness,
        held: Flags,
        contact: Integers,
        schur: Array | None,
        known: KnownFactors | None = None,
    ) -> None:
        self.comm, self.count, self.schur = stiffness.comm, len(contact), schur
        self.factorisations = 0
        self._make: Callable[[], CondensedBulk] = partial(
            CondensedBulk, stiffness, held, contact, known
        )
        self._made: CondensedBulk | None = None

    @property
    def _whole(self) -> CondensedBulk:
        if self._made is None:
            self._made = self._make()
            self._made.forget_schur()  # it is known
            self.factorisations = self._made.factorisations
        return self._made

    def condense(self, load: Array) -> Array:
        """Load condensed onto the contact dofs, as by ``CondensedBulk``; collective."""
        return self._whole.condense(load)

    def expand(self, load: Array, x: Array) -> Array:
        """Solution inside the body, as by ``CondensedBulk``; collective."""
        return self._whole.expand(load, x)

    def condense_and_expand(self, load: Array) -> tuple[Array, Array]:
        """Both, as by ``CondensedBulk``; collective."""
        return self._whole.condense_and_expand(load)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        if self._made is not None:
            self._made.destroy()


@dataclass(frozen=True, eq=False)
class Functional:
    """L = t · u + a · r, at this rank's unknowns.

    Attributes:
        forces: This rank's share of t; None for none.
        held: Values of a, 0 but at what is held; None for none (of the row's unit).
    """

    forces: Array | None = None
    held: Array | None = None


# What a row of a group is of.
Key = tuple[float, ...]
Wanted = Mapping[Key, Callable[[], Functional]]


@dataclass(frozen=True, eq=False)
class Row:
    """Value of a functional by the data.

    Attributes:
        of_contacts: K v + t at the free contact dofs, on every rank.
        of_held: This rank's share of it, at its held unknowns.
        of_forces: v, at this rank's unknowns.
    """

    of_contacts: Array
    of_held: Array
    of_forces: Array


@dataclass(frozen=True, eq=False)
class GivenState:
    """The data by which an answer is known.

    Attributes:
        contacts: Displacements of the free contact dofs, on every rank (length).
        held: Those of this rank's held unknowns (length).
        forces: This rank's share, at its unknowns, of all forces on the body, of shortened parts,
            too (force).
    """

    contacts: Array
    held: Array
    forces: Array

    @cached_property
    def acting(self) -> Integers:
        """This rank's unknowns at which forces act: mostly few, those of surfaces."""
        return np.flatnonzero(self.forces)


class RowMaker:
    """Makes rows of a condensed body; collective.

    Attributes:
        stiffness: That of each rank's cells.
        held: Which of this rank's unknowns supports hold.
        count: Number of free contact dofs.

    Args:
        stiffness: That of each rank's cells.
        held: Which of this rank's unknowns supports hold.
        dofs: The contact dofs.
        bulk: Condensed onto these.
    """

    def __init__(
        self, stiffness: LocalStiffness, held: Flags, dofs: ContactDofs, bulk: CondensedBulk
    ) -> None:
        self.stiffness, self.held, self._bulk = stiffness, held, bulk
        self.count = bulk.count
        self._at_contacts = np.flatnonzero(np.isin(stiffness.numbers, dofs.free) & ~held)
        self._places = np.searchsorted(dofs.free, stiffness.numbers[self._at_contacts])

    def make(self, wanted: Sequence[Functional]) -> list[Row]:
        """The rows of functionals, with one solve for all of them; collective."""
        if not wanted:
            return []
        loads = np.array([self._load(of) for of in wanted])
        every = self._bulk.expand(loads, np.zeros((len(wanted), self.count)))
        return [self._row(of, found) for of, found in zip(wanted, every, strict=True)]

    def _load(self, of: Functional) -> Array:
        """Forces on the adjoint state, and its displacements of what is held."""
        load = np.zeros(len(self.held))
        if of.held is not None:
            load -= self.stiffness.matrix @ np.where(self.held, of.held, 0.0)
        if of.forces is not None:
            load -= of.forces
        load[self.held] = 0.0 if of.held is None else of.held[self.held]
        return load

    def _row(self, of: Functional, found: Array) -> Row:
        """The row of an adjoint state; collective."""
        share = self.stiffness.matrix @ found
        if of.forces is not None:
            share += of.forces
        at_contacts = np.zeros(self.count)
        at_contacts[self._places] = share[self._at_contacts]
        return Row(total(self.stiffness.comm, at_contacts), share[self.held], found)


class RowStack:
    """Rows below each other.

    Attributes:
        of_contacts: Their parts of the free contact dofs, (rows, dofs).

    Args:
        maker: Of the body's rows.
        stacked: The rows.
    """

    def __init__(self, maker: RowMaker, stacked: Sequence[Row]) -> None:
        self._comm = maker.stiffness.comm
        count = len(stacked)
        self.of_contacts = np.reshape([row.of_contacts for row in stacked], (count, maker.count))
        self._of_held = np.reshape([r.of_held for r in stacked], (count, maker.held.sum()))
        self._of_forces = np.reshape([r.of_forces for r in stacked], (count, len(maker.held)))

    def values(self, state: GivenState) -> Array:
        """Value of each row; collective."""
        if not len(self._of_forces):
            return np.zeros(0)
        own = self._of_held @ state.held
        own -= self._of_forces[:, state.acting] @ state.forces[state.acting]
        return np.asarray(total(self._comm, own) + self.of_contacts @ state.contacts)
