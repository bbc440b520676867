"""Numbers of the body that are linear in its displacement, without the displacement.

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
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.solve.condensed.bulk.rank_stiffness import LocalStiffness
from fenics_contact.solve.condensed.bulk.schur import CondensedBulk
from fenics_contact.solve.condensed.contact_dofs import ContactDofs

_T = TypeVar("_T")

# Round-off of a combination of what is given, of its size.
_SAME = 1e-13
_MOST_GIVEN = 24


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


class BodyRows:
    """Makes rows of a condensed body; collective.

    Attributes:
        stiffness: That of each rank's cells.
        held: Which of this rank's unknowns supports hold.
        count: Number of free contact dofs.
        given: Rows of what scenes give.

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
        self._groups: dict[str, RowGroup] = {}
        self._found: dict[str, Any] = {}
        self.given = GivenRows(self)

    def group(self, name: str) -> RowGroup:
        """The rows of a name, kept."""
        return self._groups.setdefault(name, RowGroup(self))

    def once(self, name: str, make: Callable[[], _T]) -> _T:
        """What is worked out for rows of this body, once.

        Args:
            name: Of it.
            make: Works it out.
        """
        if name not in self._found:
            self._found[name] = make()
        kept: _T = self._found[name]
        return kept

    @property
    def groups(self) -> Mapping[str, RowGroup]:
        """All rows that are kept, by name, but those of what is given."""
        return self._groups

    def make(self, of: Functional) -> Row:
        """The row of a functional; collective.

        Args:
            of: The functional.
        """
        matrix = self.stiffness.matrix
        load = np.zeros(len(self.held))
        forces = np.zeros_like(load) if of.forces is None else of.forces
        if of.held is not None:
            load -= matrix @ np.where(self.held, of.held, 0.0)
        load -= forces
        load[self.held] = 0.0 if of.held is None else of.held[self.held]
        found = self._bulk.expand(load, np.zeros(self.count))
        share = matrix @ found + forces
        at_contacts = np.zeros(self.count)
        at_contacts[self._places] = share[self._at_contacts]
        return Row(total(self.stiffness.comm, at_contacts), share[self.held], found)


class RowGroup:
    """Rows that are asked for together.

    Attributes:
        made: The rows by what they are of.

    Args:
        rows: Makes them.
    """

    def __init__(self, rows: BodyRows) -> None:
        self._rows = rows
        self.made: dict[Key, Row] = {}
        self._stack: RowStack | None = None

    def values(self, wanted: Wanted, state: GivenState) -> dict[Key, float]:
        """Of each row that is wanted, its number; others are forgotten; collective.

        Args:
            wanted: What of → gives the functional, collective.
            state: Of the answer.
        """
        if self.made.keys() != wanted.keys() or self._stack is None:
            self.made = {
                key: self.made.get(key) or self._rows.make(functional())
                for key, functional in wanted.items()
            }
            self._stack = RowStack(self._rows, list(self.made.values()))
        return dict(zip(self.made, self._stack.values(state).tolist(), strict=True))


class RowStack:
    """Rows below each other.

    Attributes:
        of_contacts: Their parts of the free contact dofs, (rows, dofs).

    Args:
        rows: Of the body.
        stacked: The rows.
    """

    def __init__(self, rows: BodyRows, stacked: Sequence[Row]) -> None:
        self._comm = rows.stiffness.comm
        count = len(stacked)
        self.of_contacts = np.reshape([row.of_contacts for row in stacked], (count, rows.count))
        self._of_held = np.reshape([r.of_held for r in stacked], (count, rows.held.sum()))
        self._of_forces = np.reshape([r.of_forces for r in stacked], (count, len(rows.held)))

    def values(self, state: GivenState) -> Array:
        """Of each row; collective."""
        if not len(self._of_forces):
            return np.zeros(0)
        acting = np.flatnonzero(state.forces)  # mostly few: those of surfaces
        own = self._of_held @ state.held
        own -= self._of_forces[:, acting] @ state.forces[acting]
        return np.asarray(total(self._comm, own) + self.of_contacts @ state.contacts)


class GivenRows:
    """Rows of what a scene gives, loads and displacements of supports; collective.

    Those of a path, or of a value that is changed, are combinations of a few.

    Args:
        rows: Makes them.
    """

    def __init__(self, rows: BodyRows) -> None:
        self._rows = rows
        self._known: list[tuple[Functional, Row]] = []
        self._stack: RowStack | None = None
        self._last: list[tuple[Functional, Array]] = []

    @property
    def made(self) -> list[tuple[Functional, Row]]:
        """Functionals and rows that are kept."""
        return self._known

    def know(self, of: Functional, row: Row) -> None:
        """Take over a row that was made before."""
        self._known = [*self._known, (of, row)]
        self._stack = None

    def shares(self, wanted: Sequence[Functional]) -> Array:
        """What parts the kept rows have in those of functionals, (functionals, rows); collective.

        Args:
            wanted: With forces alone, or held displacements alone.
        """
        if len(self._known) + len(wanted) > _MOST_GIVEN:
            self._known, self._stack, self._last = [], None, []
        found = []
        for number, of in enumerate(wanted):
            shares = self._last_shares(number, of)
            if shares is None:
                shares = self._combination(of)
            if shares is None:
                self.know(of, self._rows.make(of))
                shares = np.zeros(len(self._known))
                shares[-1] = 1.0
            found.append(shares)
        self._last = list(zip(wanted, found, strict=True))
        whole = np.zeros((len(wanted), len(self._known)))
        for number, shares in enumerate(found):
            whole[number, : len(shares)] = shares
        return whole

    def values(self, shares: Array, state: GivenState) -> Array:
        """Of functionals in a state, (functionals,); collective.

        Args:
            shares: As ``shares`` gave them, no other asked for since.
            state: Of an answer.
        """
        return np.asarray(shares @ self._stacked.values(state))

    @property
    def _stacked(self) -> RowStack:
        if self._stack is None:
            self._stack = RowStack(self._rows, [row for _, row in self._known])
        return self._stack

    def of_contacts(self, shares: Array) -> Array:
        """K v + t of functionals at the free contact dofs, (functionals, dofs).

        Of forces alone it is what they do to these dofs, of held displacements the opposite.

        Args:
            shares: As of ``values``.
        """
        return np.asarray(shares @ self._stacked.of_contacts)

    def _last_shares(self, number: int, of: Functional) -> Array | None:
        """Of a functional that was asked for last in the same place; collective."""
        same, shares = False, None
        if number < len(self._last):
            last, shares = self._last[number]
            same = all(
                one is other or (one is not None and other is not None and (one == other).all())
                for one, other in ((of.forces, last.forces), (of.held, last.held))
            )
        is_same = bool(self._rows.stiffness.comm.allreduce(same, op=MPI.LAND))
        return shares if is_same else None

    def _combination(self, of: Functional) -> Array | None:
        """Shares of the known rows in a functional's, None if it is another one; collective."""
        comm, shares = self._rows.stiffness.comm, np.zeros(len(self._known))
        kind = "forces" if of.held is None else "held"
        wanted = getattr(of, kind)
        alike = [i for i, (known, _) in enumerate(self._known) if getattr(known, kind) is not None]
        acting = np.flatnonzero(wanted)
        columns = np.array([getattr(self._known[i][0], kind)[acting] for i in alike])
        columns = columns.reshape(len(alike), len(acting))
        outside = [np.abs(getattr(self._known[i][0], kind)).sum() for i in alike]
        sums = np.vstack([columns @ columns.T, columns @ wanted[acting]]).ravel()
        inside = np.abs(columns).sum(axis=1)
        size = float(np.abs(wanted[acting]).sum())
        sums = total(comm, np.concatenate([sums, outside, inside, [size]]))
        if sums[-1] == 0:
            return shares
        count = len(alike)
        outside, inside = sums[-1 - 2 * count : -1 - count], sums[-1 - count : -1]
        usable = inside >= outside * (1 - _SAME)  # none that acts elsewhere, too
        gram, right = np.split(sums[: count * (count + 1)].reshape(count + 1, count), [count])
        lengths = np.where(usable, np.sqrt(gram.diagonal()), np.inf)
        scaled = np.linalg.lstsq(
            gram / np.outer(lengths, lengths), right[0] / lengths, rcond=1e-14
        )[0]
        parts = scaled / lengths
        left = float(total(comm, np.abs(wanted[acting] - parts @ columns).sum()))
        if left > _SAME * sums[-1]:
            return None
        shares[alike] = parts
        return shares
