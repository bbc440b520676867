"""Forces at the contacts brought into balance alone, the rest of the body held.

All that is nonlinear lies at the contacts' nodes. Newton steps there cost a small factorisation
each.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.solve.line_search import search_by_secants

if TYPE_CHECKING:
    from fenics_contact.solve.iterative.iterative_system import IterativeSystem


# Imbalance to which the nodes are settled, over that of the whole; but below what is accepted.
_SHARE = 1e-2
_BELOW_TOLERANCE = 0.5
_MOST_STEPS = 15
# Of the whole imbalance, beyond which a settled state is not taken: what is held has got more than
# the nodes have lost. On tetrahedra it may grow a little, and the step that follows is the better.
_GROWTH = 2.0
# Imbalance over the forces, below which round-off is looked at.
_NEAR_ROUND_OFF = 1e-6


class ZoneSettling:
    """Settles the contacts' nodes of a system.

    Args:
        system: The system.
        snes: Newton's method on it, which has its residual and tolerance.
        searched: Whether steps are searched along for the least energy.
    """

    def __init__(self, system: IterativeSystem, snes: PETSc.SNES, searched: bool) -> None:
        self._system, self._snes, self._searched = system, snes, searched
        self._residual = snes.getFunction()[0]
        self._tolerance = snes.getTolerances()[0]

    def settle(self, state: PETSc.Vec) -> None:
        """Balance the forces at the nodes, displacements outside held; collective.

        Needs the residual of the state, and leaves that of the new one.
        """
        system = self._system
        inside = _Inside(system, state, self._residual)
        before = system.imbalance()
        if not inside.imbalance > self._enough(before):
            return
        for _ in range(_MOST_STEPS):
            system.linearise_contacts()
            left, forces = inside.imbalance, system.forces
            if left <= _NEAR_ROUND_OFF * forces and left <= system.contact_round_off():
                break
            if not system.surface.factorise():
                break
            inside.take_step(self._searched)
            if not inside.imbalance > self._enough(before):
                break
        inside.keep_best()
        self._snes.computeFunction(state, self._residual)
        if not system.imbalance() < _GROWTH * before:
            inside.go_back()
            self._snes.computeFunction(state, self._residual)

    def _enough(self, before: float) -> float:
        forces = self._system.forces
        accepted = _BELOW_TOLERANCE * self._tolerance * forces
        return float(max(_SHARE * min(before, forces), accepted))


class _Inside:
    """Forces at the nodes as their displacements change, those outside held.

    Attributes:
        imbalance: 1-norm of these forces (force).
    """

    def __init__(self, system: IterativeSystem, state: PETSc.Vec, residual: PETSc.Vec) -> None:
        self._system, self._zone, self._state = system, system.surface, state
        self._start = state.array_r[self._zone.places].copy()
        self._left = residual.array_r[self._zone.places].copy()
        self._fixed = self._left - system.contact_residual(state)[self._zone.places]
        self._moved = np.zeros_like(self._left)
        self.imbalance = self._norm()
        self._best = (self.imbalance, self._moved)

    def _norm(self) -> float:
        norm = float(total(self._system.comm, np.abs(self._left).sum()))
        return norm if np.isfinite(norm) else np.inf

    def take_step(self, searched: bool) -> None:
        """A Newton step, or the share of it that makes the energy flat; collective."""
        step = -self._zone.solve(self._left)
        before = self._moved

        def slope_at(share: float) -> float:
            self._move(before + share * step)
            return float(total(self._system.comm, step @ self._left))

        if searched:
            search_by_secants(slope_at, float(total(self._system.comm, step @ self._left)))
        else:
            self._move(before + step)
        self.imbalance = self._norm()
        if self.imbalance < self._best[0]:
            self._best = (self.imbalance, self._moved)

    def _move(self, moved: Array) -> None:
        self._go(moved)
        contacts = self._system.contact_residual(self._state)[self._zone.places]
        self._left = self._fixed + self._zone.forces_inside(moved) + contacts

    def keep_best(self) -> None:
        """Go to the least imbalance found."""
        if self._best[1] is not self._moved:
            self._go(self._best[1])

    def go_back(self) -> None:
        """Go to where this began."""
        self._go(np.zeros_like(self._moved))

    def _go(self, moved: Array) -> None:
        self._moved = moved
        with self._state as array:
            array[self._zone.places] = self._start + moved
        self._system.take(self._state)
