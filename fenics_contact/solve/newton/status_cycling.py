"""Contact points whose status keeps changing from one iterate to the next, and what they carry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.contact.contact_surface import ContactSurface

# Iterates looked back on, and changes among them from which a point is said to chatter: a
# solve that settles passes each point from open to slip to stick at the most.
_REMEMBERED = 12
_CHANGES = 3
_LONGEST_CYCLE = 6


@dataclass(frozen=True, eq=False)
class _Iterate:
    """State of a contact at its points: 0 open, 1 stick, 2 slip; unit slips, and pressures."""

    status: NDArray[np.int8]
    direction: Array
    pressure: Array

    def differs(self, other: _Iterate) -> Flags:
        """Points of another status, or slipping the other way."""
        turned = np.einsum("ij,ij->i", self.direction, other.direction) < 0
        return np.asarray((self.status != other.status) | turned)


class Chatter:
    """The last iterates of a solve at the contacts; all calls are collective.

    Args:
        contacts: Of the problem; those that push are looked at.
        comm: Communicator.
    """

    def __init__(self, contacts: list[ContactSurface], comm: MPI.Comm) -> None:
        self._contacts = [contact for contact in contacts if contact.is_one_sided]
        self._comm = comm
        self._iterates: list[list[_Iterate]] = []

    def clear(self) -> None:
        """Forget all iterates: another solve begins."""
        self._iterates.clear()

    def note(self) -> None:
        """Remember the present iterate."""
        self._iterates.append([_present(contact) for contact in self._contacts])
        del self._iterates[:-_REMEMBERED]

    def period(self) -> int | None:
        """Iterates after which the same status comes again, 2 … 6; None if it does not."""
        for period in range(2, min(_LONGEST_CYCLE, len(self._iterates) // 2) + 1):
            last, before = self._iterates[-period:], self._iterates[-2 * period : -period]
            if not self._differ(last, before):
                return period if self._differ(last[1:], last[:-1]) else None
        return None

    def _differ(self, some: list[list[_Iterate]], others: list[list[_Iterate]]) -> bool:
        """Whether one of some iterates differs from its counterpart."""
        pairs = [
            pair for both in zip(some, others, strict=True) for pair in zip(*both, strict=True)
        ]
        changed = sum(int(new.differs(old).sum()) for new, old in pairs)
        return int(self._comm.allreduce(changed)) > 0

    def words(self, iterates: str) -> str:
        """Sentence on the points that chatter, their number, place and share of force; or empty.

        Args:
            iterates: What an iterate is called, in the plural.
        """
        found = [
            words
            for number in range(len(self._contacts))
            if (words := self._words(number, iterates)) is not None
        ]
        return ("; " + "; ".join(found)) if found else ""

    def _words(self, number: int, iterates: str) -> str | None:
        contact, owned = self._contacts[number], self._contacts[number].trace.owned
        every = [iterate[number] for iterate in self._iterates]
        pairs = zip(every[1:], every[:-1], strict=True)
        changes = np.sum([new.differs(old) for new, old in pairs], axis=0, dtype=np.int64)
        restless = owned & (np.broadcast_to(changes, owned.shape) >= _CHANGES)
        count = int(total(self._comm, int(restless.sum())))
        if count == 0:
            return None
        points = int(total(self._comm, int(owned.sum())))
        period = self.period()
        rhythm = f", again and again after {period} {iterates}" if period else ""
        return (
            f"{count} of {points} points of '{contact.label}' keep changing between "
            f"{self._between(every, restless)}{rhythm}, the most restless at "
            f"{self._place(contact, changes, restless)}; they carry "
            f"{100 * self._share(contact, every, restless):.0f} % of its pressure"
        )

    def _between(self, every: list[_Iterate], restless: Flags) -> str:
        here = np.zeros(3)
        for iterate in every:
            here += np.bincount(iterate.status[restless], minlength=3)
        seen = np.flatnonzero(total(self._comm, here))
        names = [("open", "stick", "slip")[status] for status in seen]
        return " and ".join(names) if len(names) > 1 else "slip to and fro"

    def _share(self, contact: ContactSurface, every: list[_Iterate], restless: Flags) -> float:
        """The most that they carry in one of the iterates."""
        shares = []
        for iterate in every:
            both = np.stack([iterate.pressure * restless, iterate.pressure], axis=1)
            mine, whole = contact.trace.integral(both)
            shares.append(mine / whole if whole > 0 else 0.0)
        return float(max(shares))

    def _place(self, contact: ContactSurface, changes: Integers, restless: Flags) -> str:
        places = contact.trace.coordinates[restless]
        rows = gather_rows(self._comm, np.column_stack([-changes[restless], places]))
        first = rows[np.lexsort(np.round(rows.T[::-1], 9))][0]
        size = contact.spaces.components
        return "(" + ", ".join(f"{x:.4g}" for x in first[1 : 1 + size] + 0.0) + ")"


def _present(contact: ContactSurface) -> _Iterate:
    """Present status, unit slips and pressures at the points of a contact."""
    pressure, kinematics = contact.pressure(), contact.kinematics
    slip = contact.friction.scaled_slip(kinematics.tangential(kinematics.jump_at_points()))
    epsilon = contact.regularisation_parameter
    size = np.linalg.norm(slip, axis=1)
    closed, slips = pressure > 0, size > epsilon
    moving = (closed & slips & contact.friction.has_friction)[:, None]
    direction = np.where(moving, slip / np.where(size > 0, size, 1.0)[:, None], 0.0)
    status = np.where(closed, np.where(slips, 2, 1), 0).astype(np.int8)
    return _Iterate(status, direction, pressure)
