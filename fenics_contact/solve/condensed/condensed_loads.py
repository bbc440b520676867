"""Condensed loads, remembered: those of a load path are combinations of a few."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.solve.condensed.bulk.schur import CondensedBulk

# Round-off of a combination of loads, of its size.
_SAME = 1e-13
_MOST = 8


class CondensedLoads:
    """Condenses loads by ``CondensedBulk.condense``; solves only for those that are new."""

    def __init__(self, bulk: CondensedBulk) -> None:
        self._bulk = bulk
        self._comm = bulk.comm
        self._known: list[tuple[Array, Array]] = []

    @property
    def known(self) -> list[tuple[Array, Array]]:
        """Loads, and on rank 0 what they are condensed."""
        return self._known

    def know(self, load: Array, condensed: Array) -> None:
        """Take over one that was condensed before, of size 1; collective.

        Squares of forces may be too small for a number where the forces themselves are not. A load
        that is zero is a combination of any others, and of none of them a part: it is not kept.

        Args:
            load: This rank's share of the forces on its unknowns.
            condensed: On the contact dofs, on rank 0.
        """
        size = largest(self._comm, np.abs(load))
        if size > 0:
            pair = load / size, condensed / size
            self._known = [*self._known[-_MOST + 1 :], pair]

    def condense(self, load: Array) -> Array:
        """The condensed load, on rank 0; collective.

        Of one that is new only what the known ones leave of it is condensed, and known from then
        on: so these are orthogonal to each other, and tell a combination to round-off even where
        loads are nearly the same, as a large static load with what vibrates about it.
        """
        shares = self._shares(load)
        left = load - self._combined(shares, 0)
        condensed = np.zeros(self._bulk.count) + self._combined(shares, 1)
        if self._is_new(left, load):
            of_left = self._bulk.condense(left)
            self.know(left, of_left)
            condensed = condensed + of_left
        return condensed

    def precompute(self, loads: Array) -> None:
        """Condense loads that are going to be asked for, with one solve; collective.

        Args:
            loads: As of ``condense``, (loads, unknowns).
        """
        for load, condensed in zip(loads, self._bulk.condense(loads), strict=True):
            shares = self._shares(load)
            left = load - self._combined(shares, 0)
            if self._is_new(left, load):
                self.know(left, condensed - self._combined(shares, 1))

    def _is_new(self, left: Array, load: Array) -> bool:
        """Whether what known loads leave of one is more than round-off; collective."""
        sums = total(self._comm, np.array([np.abs(left).sum(), np.abs(load).sum()]))
        return bool(sums[0] > _SAME * sums[1])

    def _combined(self, shares: Array, part: int) -> Array | float:
        """Combination of the known loads, or of these condensed."""
        pairs = zip(shares, self._known, strict=True)
        return sum((share * known[part] for share, known in pairs), 0.0)

    def _shares(self, load: Array) -> Array:
        """Shares of the known loads in a load, by least squares; collective."""
        columns = np.array([known for known, _ in self._known]).reshape(len(self._known), len(load))
        sums = total(self._comm, np.vstack([columns @ columns.T, columns @ load]))
        gram, right = sums[:-1], sums[-1]
        if not right.any():
            return np.zeros(len(right))
        size = np.sqrt(gram.diagonal())  # > 0, as each has an entry of 1
        scaled = np.linalg.lstsq(gram / np.outer(size, size), right / size, rcond=1e-14)[0]
        return np.asarray(scaled / size)
