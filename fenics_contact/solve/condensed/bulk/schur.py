"""The bulk condensed onto the contact dofs: one factorisation, then dense matrices only.

Each rank condenses its own cells onto what it shares with others and with the contacts, by MUMPS'
Schur complement; rank 0 adds these up and condenses what ranks share (substructuring).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import (
    from_root,
    gathered_on_root,
    of_every_rank,
    raise_together,
)
from fenics_contact.solve.condensed.bulk.part_factors import KnownFactors, RankFactor
from fenics_contact.solve.condensed.bulk.rank_stiffness import LocalStiffness


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

    def condense(self, load: Array) -> Array:
        """f_C − K_CI K_II⁻¹ f_I, on rank 0; collective.

        Args:
            load: This rank's share of the forces on its unknowns; values where held. Or several at
                once, (…, unknowns).
        """
        solved = self._inside.solve(load)
        left = (load - self._inside.times(solved))[..., self._kept]
        parts = gathered_on_root(self.comm, left)
        self._load = np.zeros((*load.shape[:-1], self._size))
        for places, part in zip(self._places, parts or (), strict=False):
            self._load[..., places] += part
        contact, between = self._load[..., : self.count], self._load[..., self.count :]
        if parts is None:
            return np.zeros_like(contact)
        return np.asarray(contact - between @ self._carried)

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
        kept = np.zeros_like(load)
        kept[..., self._kept] = values[..., self._places[self.comm.rank]]
        found = self._inside.solve(load - self._inside.times(kept))
        found[..., self._kept] = kept[..., self._kept]
        return found

    def forget_schur(self) -> None:
        """Keep the Schur complement no longer, which is large."""
        self.schur = None

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
        """As of any bulk; collective."""
        return self._whole.condense(load)

    def expand(self, load: Array, x: Array) -> Array:
        """As of any bulk; collective."""
        return self._whole.expand(load, x)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        if self._made is not None:
            self._made.destroy()
