"""Numbers of the body that are linear in its displacement, without the displacement.

Numbers of the body that are linear in its displacement, without the displacement.

Such a number is L = t · u + a · r: t forces on the displacements, a displacements of what is held,
r the reactions there. Its *row* is the adjoint state v, with v = a at what is held, nothing at the
contact dofs, and K v = −t inside. As K is symmetric,

    L = (K v + t) · u − v · f,

of which K v + t vanishes inside: so displacements of contact dofs and of what is held say all, with
the forces f that act on the body, of loads, contacts and shortened parts. A row takes one solve
with the factorised bulk, and is kept.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.solve.condensed.bulk.rank_stiffness import LocalStiffness
from fenics_contact.solve.condensed.bulk.schur import CondensedBulk
from fenics_contact.solve.systems.contact_dofs import ContactDofs


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
    """What a functional is of the data.

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
    """What an answer is known by.

    Attributes:
        contacts: Displacements of the free contact dofs, on every rank (length).
        held: Those of this rank's held unknowns (length).
        forces: This rank's share, at its unknowns, of all forces on the body, of shortened parts,
            too (force).
    """

    contacts: Array
    held: Array
    forces: Array


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
        """The rows of functionals, with one solve for all of them; collective.

        Args:
            wanted: The functionals.
        """
        if not wanted:
            return []
        loads = np.array([self._load(of) for of in wanted])
        every = self._bulk.expand(loads, np.zeros((len(wanted), self.count)))
        return [self._row(of, found) for of, found in zip(wanted, every, strict=True)]

    def _load(self, of: Functional) -> Array:
        """What the adjoint state is under, and its displacements of what is held."""
        load = np.zeros(len(self.held))
        if of.held is not None:
            load -= self.stiffness.matrix @ np.where(self.held, of.held, 0.0)
        if of.forces is not None:
            load -= of.forces
        load[self.held] = 0.0 if of.held is None else of.held[self.held]
        return load

    def _row(self, of: Functional, found: Array) -> Row:
        """That of an adjoint state; collective."""
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
        """Of each row; collective."""
        if not len(self._of_forces):
            return np.zeros(0)
        acting = np.flatnonzero(state.forces)  # mostly few: those of surfaces
        own = self._of_held @ state.held
        own -= self._of_forces[:, acting] @ state.forces[acting]
        return np.asarray(total(self._comm, own) + self.of_contacts @ state.contacts)
