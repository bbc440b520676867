"""Newton's method with the contact zone eliminated.

All that is nonlinear lies in the zone: before each step it is settled alone, the rest of the
body held, by Newton steps that cost a small factorisation each. The step for the whole body
then changes contact and slip only by what is smooth, so few digits of it are asked for, more
as the imbalance falls (S. C. Eisenstat and H. F. Walker, SIAM J. Sci. Comput. 17 (1996) 16-32).
See X.-C. Cai and X. Li, SIAM J. Sci. Comput. 33 (2011) 746-762.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.solve.iterative.forcing_terms import ForcingTerms
from fenics_contact.solve.line_search import search_by_secants

if TYPE_CHECKING:
    from fenics_contact.solve.iterative.iterative_system import IterativeSystem


# The zone is settled below the imbalance that is accepted.
_BELOW_TOLERANCE = 0.5
# The zone is settled to this share of the imbalance outside it.
_ZONE_SHARE = 1e-2
_MOST_ZONE_STEPS = 15
_GROWTH = 1.0
# Krylov vectors are restarted; a solve that needs more than this is given up.
_MOST_ITERATIONS = 300
# Steps whose linear solves ran out of iterations, one after the other, that come to nothing: each
# costs as much as many that do not. Nothing is gained where the imbalance is not halved.
_MOST_VAIN = 4
_GAIN = 0.5
# Imbalance over the forces, below which round-off is looked at.
_NEAR_ROUND_OFF = 1e-6


class EliminatingNewton:
    """A nonlinear solver of PETSc's type ``python``."""

    def __init__(self, system: IterativeSystem) -> None:
        self._system = system
        self._comm = system.comm
        self._tolerance = 0.0
        self._ran_out = False  # the last linear solve, of its iterations
        self._is_nonlinear = any(
            contact.is_one_sided or contact.friction.rubs for contact in system.problem.contacts
        )

    def solve(self, snes: PETSc.SNES, right: PETSc.Vec, state: PETSc.Vec) -> None:
        """Solve from a state; PETSc calls this."""
        searched = _is_searched(snes)
        self._tolerance = snes.getTolerances()[0]
        self._ran_out = False
        residual = snes.getFunction()[0]
        step, left = state.duplicate(), state.duplicate()
        snes.computeFunction(state, residual)
        forcing = ForcingTerms(self._is_nonlinear)
        reason, number, vain = 0, 0, 0
        while True:
            if not forcing.stagnates:
                self._settle(snes, state, residual, searched)
            else:
                self._system.follow_contacts()
            reason = self._judge(snes, number, residual)
            if reason or number == snes.getTolerances()[3]:
                break
            imbalance = self._system.imbalance()
            rest = forcing.next(imbalance, self._tolerance * self._system.forces)
            vain = vain + 1 if self._ran_out and forcing.stagnates else 0
            if vain == _MOST_VAIN:
                reason = -3
                break
            snes.computeJacobian(state, self._system.tangent)
            self._system.follow_contacts()
            import os
            if os.environ.get("DBG"): print("   rest %.1e"%rest, end=" ")
            if not self._find_step(snes.getKSP(), residual, rest, step, left):
                reason = -3  # the linear solve failed
                break
            if os.environ.get("DBG"): print("its", snes.getKSP().getIterationNumber())
            self._advance(snes, state, residual, step, searched)
            number += 1
        snes.setConvergedReason(reason or -5)
        step.destroy()
        left.destroy()

    def _judge(self, snes: PETSc.SNES, number: int, residual: PETSc.Vec) -> int:
        norm = residual.norm()
        snes.setIterationNumber(number)
        snes.setFunctionNorm(norm)
        snes.monitor(number, norm)
        return int(snes.callConvergenceTest(number, 0.0, 0.0, norm) or 0)

    def _find_step(
        self, solver: PETSc.SNES, residual: PETSc.Vec, rest: float, step: PETSc.Vec, left: PETSc.Vec
    ) -> bool:
        """−(K + K_c)⁻¹ r: exactly in the zone first, then everywhere; collective."""
        zone, tangent = self._system.zone, self._system.tangent
        if not zone.factorise():
            return False
        inside = zone.solve(-residual.array_r[zone.places])
        step.set(0.0)
        with step as array:
            array[zone.places] = inside
        self._system.tie(step)
        tangent.mult(step, left)
        left.axpy(1.0, residual)
        left.scale(-1.0)
        solver.setOperators(tangent)
        solver.setTolerances(rtol=rest, atol=0.0, divtol=1e10, max_it=_MOST_ITERATIONS)
        correction = left.duplicate()
        solver.solve(left, correction)
        step.axpy(1.0, correction)
        correction.destroy()
        reason = solver.getConvergedReason()
        self._ran_out = reason == -3
        return bool(np.isfinite(step.norm())) and (reason > 0 or self._ran_out)

    def _advance(
        self,
        snes: PETSc.SNES,
        state: PETSc.Vec,
        residual: PETSc.Vec,
        step: PETSc.Vec,
        searched: bool,
    ) -> None:
        """Go along the step, where searched for to where the energy is flat; collective."""
        slope = step.dot(residual)
        start = state.copy() if searched else None

        def slope_at(share: float) -> float:
            if start is not None:
                start.copy(state)
            state.axpy(share, step)
            snes.computeFunction(state, residual)
            return float(step.dot(residual))

        slope_at(1.0) if start is None else search_by_secants(slope_at, slope)
        if start is not None:
            start.destroy()

    def _settle(
        self, snes: PETSc.SNES, state: PETSc.Vec, residual: PETSc.Vec, searched: bool
    ) -> None:
        """Balance the forces in the zone, displacements outside held; collective.

        Needs the residual of the state, and leaves that of the new one.
        """
        system = self._system
        system.follow_contacts()
        zone = system.surface
        left = residual.array_r[zone.places].copy()
        size = self._norm(left)
        before = system.imbalance(); size0=size
        outside = before - size
        enough = max(_ZONE_SHARE * outside, _BELOW_TOLERANCE * self._tolerance * system.forces)
        if not size > enough:
            return
        inside = _Inside(system, state, left)
        for _ in range(_MOST_ZONE_STEPS):
            system.linearise(state)
            if size <= _NEAR_ROUND_OFF * system.forces and size <= system.contact_round_off():
                break
            if not zone.factorise():
                break
            step = -zone.solve(left)
            left = inside.go_along(step, searched)
            size = self._norm(left)
            if not size > enough:
                break
        inside.keep_best()
        import os
        b0 = inside._best[0]
        nset = inside.n
        system.follow_supports()  # a half-space's outer boundary, as its resultants have changed
        snes.computeFunction(state, residual)
        if os.environ.get("DBG"): print("   settled in %d: zone %.2e -> %.2e, total %.2e -> %.2e"%(nset, self._norm(residual.array_r[zone.places])*0+size0, b0, before, system.imbalance()))
        if not system.imbalance() < _GROWTH * before:  # what was held has got more than the zone has lost
            inside.go_back()
            system.follow_supports()
            snes.computeFunction(state, residual)

    def _norm(self, forces: Array) -> float:
        return float(total(self._comm, np.abs(forces).sum()))


class _Inside:
    """Forces in the zone as its displacements change, those outside held."""

    def __init__(self, system: IterativeSystem, state: PETSc.Vec, left: Array) -> None:
        self._system, self._zone, self._state = system, system.surface, state
        self._start = state.array_r[self._zone.places].copy()
        self._fixed = left - system.contact_residual(state)[self._zone.places]
        self._moved = np.zeros_like(left)
        self._tried, self._left = self._moved, left
        self._best = (self._norm(left), self._moved)

    def _norm(self, left: Array) -> float:
        norm = float(total(self._system.comm, np.abs(left).sum()))
        return norm if np.isfinite(norm) else np.inf

    def go_along(self, step: Array, searched: bool) -> Array:
        """Forces left after a step, or the share of it that makes the energy flat; collective."""

        def slope_at(share: float) -> float:
            return float(total(self._system.comm, step @ self._at(share, step)))

        if searched:
            search_by_secants(slope_at, float(total(self._system.comm, step @ self._left)))
        else:
            self._at(1.0, step)
        return self._accept()

    def _at(self, share: float, step: Array) -> Array:
        self._tried = self._moved + share * step
        self._go(self._tried)
        contacts = self._system.contact_residual(self._state)[self._zone.places]
        self._left = self._fixed + self._zone.forces_inside(self._tried) + contacts
        return self._left

    n = 0
    def _accept(self) -> Array:
        self.n += 1
        self._moved = self._tried
        norm = self._norm(self._left)
        if norm < self._best[0]:
            self._best = (norm, self._moved)
        return self._left

    def keep_best(self) -> None:
        """Go back to the least imbalance found."""
        if self._best[1] is not self._moved:
            self._go(self._best[1])

    def go_back(self) -> None:
        """Go back to where this began."""
        self._go(np.zeros_like(self._moved))

    def _go(self, moved: Array) -> None:
        with self._state as array:
            array[self._zone.places] = self._start + moved
        self._system.take(self._state)


def _is_searched(snes: PETSc.SNES) -> bool:
    """Whether the line search asked for is one along the energy."""
    name = (snes.getOptionsPrefix() or "") + "snes_linesearch_type"
    return bool(PETSc.Options().getString(name, "basic") == "cp")
