"""Loads and prescribed displacements of a moment, condensed and remembered.

Most answers of a study, and most load steps of the next one, have loads that were there before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.solve.condensed.bulk.rank_stiffness import LocalStiffness
from fenics_contact.solve.condensed.scalar_border import CondensedScalars
from fenics_contact.solve.systems.contact_dofs import ContactDofs

_MOST = 8
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
            held=self._dofs.gathered(supported.reshape(-1)),
            condensed=self._condense(load),
            on_scalars=self._scalars.from_loads(load, self._stiffness.at_unknowns(supported)),
        )
        self._known = [*self._known[1 - _MOST :], found] if self._is_kept() else [found]
        return found
