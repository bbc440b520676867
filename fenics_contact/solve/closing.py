"""Points that close by turns, where friction alone holds bodies and no other way has an answer.

A full step closes every point that it finds behind what stands opposite. On surfaces of degree 2
the centre of a facet follows its nodes with weights of both signs, so that points which close
together open each other again, and clusters of them go round in circles, each time under many
times the pressures beside them. Friction then takes their pressures for bounds. A shorter step of
everything would hold up what goes well elsewhere. So of neighbours that a step has closed only the
one that is pressed the most does close in the next one, in which the others are taken for open. The
more often a point has closed in a solve, the farther away are those that it waits for. What is left
out of a step is in the balance of forces that is judged, so that answers are the same.

One of several exchanges at a time is what pivoting does where the exchange of all goes round in
circles: J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587-596.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gather_rows, of_every_rank
from fenics_contact.contact.contact_surface import ContactSurface

# Distance of neighbours over the side of the square that a point stands for: of a point that closes
# for the first time, and what each further time adds.
_NEAR, _FARTHER = 1.1, 0.5


class ClosingByTurns:
    """Chooses the points that Newton steps of one solve take for open; all calls are collective.

    Args:
        contacts: All of the problem; those that only push are looked at.
    """

    def __init__(self, contacts: Sequence[ContactSurface]) -> None:
        self._turns = [_Turns(contact) for contact in contacts if contact.is_one_sided]

    def hold_open(self) -> bool:
        """Open the points that are to wait in the step from the present state.

        Returns:
            Whether there are any, on any rank: forces are others then.
        """
        return any([turns.hold_open() for turns in self._turns])

    def release(self) -> None:
        """Let all points be as they are."""
        for turns in self._turns:
            turns.release()


class _Turns:
    """Chooses the points of one contact that a Newton step takes for open.

    Args:
        contact: The contact.
    """

    def __init__(self, contact: ContactSurface) -> None:
        self._contact = contact
        self._closed: Flags | None = None  # in the last step
        self._times = np.zeros(len(contact.trace.weights))
        self._gap: Array | None = None  # while some are held open

    def hold_open(self) -> bool:
        contact = self._contact
        pressure = contact.pressure()
        closed = pressure > 0
        closing = np.zeros_like(closed) if self._closed is None else closed & ~self._closed
        self._times += closing
        waits = np.zeros_like(closed)
        reach = (_NEAR + _FARTHER * _NEAR * (self._times - 1)) * np.sqrt(contact.trace.weights)
        waits[closing] = self._wait(closing, reach, pressure)
        self._closed = closed & ~waits
        if not any(of_every_rank(contact.spaces.comm, bool(waits.any()))):
            return False
        self._gap = contact.kinematics.gap
        contact.set_gap(np.where(waits, np.inf, self._gap))
        return True

    def _wait(self, closing: Flags, reach: Array, pressure: Array) -> Flags:
        """Flags of closing points with a neighbour under a higher pressure, (closing points,)."""
        trace, comm = self._contact.trace, self._contact.spaces.comm
        own = np.column_stack([trace.coordinates, reach, pressure])
        every = gather_rows(comm, own[closing & trace.owned])
        mine = own[closing]
        if not len(every) or not len(mine):
            return np.zeros(len(mine), dtype=bool)
        most = max(every[:, 3].max(), mine[:, 3].max())
        pairs = cKDTree(mine[:, :3]).sparse_distance_matrix(
            cKDTree(every[:, :3]), most, output_type="coo_matrix"
        )
        one, other = pairs.row, pairs.col
        near = pairs.data < np.maximum(mine[one, 3], every[other, 3])
        waits = np.zeros(len(mine), dtype=bool)
        waits[one[near & (every[other, 4] > mine[one, 4])]] = True
        return waits

    def release(self) -> None:
        if self._gap is not None:
            self._contact.set_gap(self._gap)
            self._gap = None
