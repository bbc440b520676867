"""Newton's method with the contact zone eliminated.

All that is nonlinear lies at the contacts: before each step their nodes are settled alone. The
step for the whole body then changes contact and slip only by what is smooth, so few digits of it
are asked for. See X.-C. Cai and X. Li, SIAM J. Sci. Comput. 33 (2011) 746-762.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from fenics_contact.solve.iterative.forcing_terms import ForcingTerms
from fenics_contact.solve.iterative.zone_settling import ZoneSettling
from fenics_contact.solve.line_search import search_by_secants

if TYPE_CHECKING:
    from fenics_contact.solve.iterative.iterative_system import IterativeSystem


# Krylov vectors are restarted; a solve that needs more than this is given up.
_MOST_ITERATIONS = 300
# Steps whose linear solves ran out of iterations, one after the other, that come to nothing: each
# costs as much as many that do not.
_MOST_VAIN = 4


class EliminatingNewton:
    """A nonlinear solver of PETSc's type ``python``."""

    def __init__(self, system: IterativeSystem) -> None:
        self._system = system
        self._tolerance = 0.0
        self._ran_out = False  # the last linear solve, of its iterations
        self._between_bodies = system.problem.between_bodies
        self._is_nonlinear = any(
            contact.is_one_sided or contact.friction.has_friction
            for contact in system.problem.contacts
        )

    def solve(self, snes: PETSc.SNES, right: PETSc.Vec, state: PETSc.Vec) -> None:
        """Solve from a state; PETSc calls this."""
        searched = _is_searched(snes)
        self._tolerance = snes.getTolerances()[0]
        self._ran_out = False
        residual = snes.getFunction()[0]
        step, left = state.duplicate(), state.duplicate()
        snes.computeFunction(state, residual)
        forcing = ForcingTerms(self._is_nonlinear, self._between_bodies)
        settling = ZoneSettling(self._system, snes, searched)
        reason, number, vain = 0, 0, 0
        while True:
            self._system.follow_contacts()
            # Full steps and settling may go round in a circle; what follows the energy does not.
            # Between bodies slip goes round with masters held.
            if not self._between_bodies and (searched or not forcing.stagnates):
                settling.settle(state)
            reason = self._judge(snes, number, residual)
            if reason or number == snes.getTolerances()[3]:
                break
            imbalance = self._system.imbalance()
            forces = self._system.forces
            rest = forcing.next(imbalance, self._tolerance * forces, forces)
            vain = vain + 1 if self._ran_out and forcing.stagnates else 0
            if vain == _MOST_VAIN:
                reason = -3
                break
            snes.computeJacobian(state, self._system.tangent)
            self._system.follow_contacts()
            if not self._find_step(snes.getKSP(), residual, rest, step, left):
                reason = -3  # the linear solve failed
                break
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
        inside = self._system.solve_zone(-residual.array_r[zone.places])
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


def _is_searched(snes: PETSc.SNES) -> bool:
    """Whether the line search asked for is one along the energy."""
    name = (snes.getOptionsPrefix() or "") + "snes_linesearch_type"
    return bool(PETSc.Options().getString(name, "basic") == "cp")
