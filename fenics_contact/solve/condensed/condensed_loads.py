"""Loads and prescribed displacements, condensed onto the contacts and remembered.

Loads and prescribed displacements of a moment, condensed and remembered.

Most answers of a study, and most load steps of the next one, have loads that were there before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import largest, total
from fenics_contact.solve.condensed.scalar_border import CondensedScalars
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness

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


# Every so many rows of arrays are compared first.
_FEW = 100


@dataclass(frozen=True, eq=False)
class PresentLoads:
    """Loads and supports of a moment, condensed.

    Attributes:
        nodal: The loads that they are of, at this rank's nodes (force).
        prescribed: The displacements likewise, of what is constrained (length).
        load: Both on this rank's unknowns (force).
        held: Prescribed displacements at all contact dofs (length).
        condensed: The load condensed onto the free ones, on rank 0 (force).
        on_scalars: The forces that they make on the body's scalars, (scalars,) (force).
    """

    nodal: Array
    prescribed: Array
    load: Array
    held: Array
    condensed: Array
    on_scalars: Array

    def is_of(self, nodal: Array, prescribed: Array) -> bool:
        """Whether loads and displacements are the same, on this rank."""
        pairs = (self.prescribed, prescribed), (self.nodal, nodal)
        return all(one is other or _are_equal(one, other) for one, other in pairs)


def _are_equal(one: Array, other: Array) -> bool:
    """Whether large arrays are equal; most that are not differ in any few of their rows."""
    return np.array_equal(one[::_FEW], other[::_FEW]) and np.array_equal(one, other)


class LoadsOfBody:
    """Condenses loads and prescribed displacements, unless they are remembered; collective.

    Args:
        stiffness: That of each rank's cells.
        held: Which of this rank's unknowns of the stiffness supports hold.
        dofs: The contact dofs.
        condense: Condenses a load; of motions, whose loads of inertia are others in each step, the
            bulk itself.
        scalars: What the body's scalars do.
        constrained: Dofs that supports hold (local indices, owned and ghost).
        is_kept: Whether it is, at present, for many answers.
    """

    def __init__(
        self,
        stiffness: LocalStiffness,
        held: Flags,
        dofs: ContactDofs,
        condense: Callable[[Array], Array],
        scalars: CondensedScalars,
        constrained: Integers,
        is_kept: Callable[[], bool],
    ) -> None:
        self._stiffness, self._held, self._dofs = stiffness, held, dofs
        self._condense, self._scalars, self._constrained = condense, scalars, constrained
        self._is_kept = is_kept
        self._known: list[PresentLoads] = []

    def supported(self, prescribed: Array, components: int) -> Array:
        """Displacements (nodes, components) of what is constrained, 0 elsewhere (length)."""
        found = np.zeros(self._dofs.constrained.shape)
        found[self._constrained] = prescribed
        return found.reshape(-1, components)

    def at(self, nodal: Array, prescribed: Array) -> PresentLoads:
        """Condensed loads of a moment: the same object where these were there before; collective.

        Args:
            nodal: Loads at this rank's nodes, (nodes, components) (force).
            prescribed: Displacements of what is constrained (length).
        """
        same = np.array([known.is_of(nodal, prescribed) for known in self._known], dtype=bool)
        self._stiffness.comm.Allreduce(MPI.IN_PLACE, same, op=MPI.LAND)
        for number in np.flatnonzero(same)[:1]:
            self._known.append(self._known.pop(number))
            return self._known[-1]
        supported = self.supported(prescribed, nodal.shape[1])
        load = self._stiffness.load(nodal, supported, self._held)
        found = PresentLoads(
            nodal=nodal,
            prescribed=prescribed,
            load=load,
            held=self._dofs.followed(self._dofs.gathered(supported.reshape(-1))),
            condensed=self._condense(load),
            on_scalars=self._scalars.from_loads(load, self._stiffness.at_unknowns(supported)),
        )
        self._known = [*self._known[1 - _MOST :], found] if self._is_kept() else [found]
        return found
