"""Newton's method with the contact zone eliminated.

How exactly the linear system of each Newton step is solved. Few digits are asked for far from the
answer, and more as the imbalance falls (S. C. Eisenstat and H. F. Walker, SIAM J. Sci. Comput. 17
(1996) 16-32).

Forces at the contacts brought into balance alone, the rest of the body held. All that is nonlinear
lies at the contacts' nodes. Newton steps there cost a small factorisation each.

All that is nonlinear lies at the contacts: before each step their nodes are settled alone. The
step for the whole body then changes contact and slip only by what is smooth, so few digits of it
are asked for. See X.-C. Cai and X. Li, SIAM J. Sci. Comput. 33 (2011) 746-762.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.solve.globalisation import search_by_secants
from fenics_contact.solve.iterative.zoned_system import ZonedSystem

# Share of the forces that the first linear solve leaves; later ones leave this times the last
# reduction to this power.
_FIRST = 0.03
# Between bodies nothing is settled before a step. What the imbalance does says little as long as it
# is more than a share of the forces: the solve leaves as much. Later ones start with fewer.
_FAR, _FAR_BETWEEN_BODIES = 0.01, 0.1
_FIRST_BETWEEN_BODIES = 0.01
_FACTOR, _POWER = 0.9, 1.5
# What is left after a step that has come to little: it is not to be for want of digits.
_AFTER_STAGNATION = 1e-3
# An imbalance that is not reduced to this share stagnates.
_GAIN = 0.5
# The last solve is to end the Newton steps.
_BELOW_TOLERANCE = 0.5


class ForcingTerms:
    """Shares of the forces that linear solves may leave, one after the other.

    Attributes:
        stagnates: Whether the imbalance has hardly fallen with the last step.

    Args:
        is_nonlinear: Whether anything is; else the first solve is the last.
        between_bodies: Whether there is contact between bodies.
    """

    def __init__(self, is_nonlinear: bool, between_bodies: bool) -> None:
        self._between_bodies = between_bodies
        self._first = _FIRST_BETWEEN_BODIES if between_bodies else _FIRST
        self._is_nonlinear = is_nonlinear
        self._before = 0.0
        self.stagnates = False

    def next(self, imbalance: float, enough: float, forces: float) -> float:
        """Forcing term of the next linear solve.

        Args:
            imbalance: At present (force).
            enough: At which Newton's method ends (force).
            forces: What the imbalance is small against (force).
        """
        before, self._before = self._before, imbalance
        self.stagnates = imbalance > _GAIN * before > 0
        last = _BELOW_TOLERANCE * enough / imbalance
        if not self._is_nonlinear:
            return last
        share = self._first
        if self._between_bodies and imbalance > _FAR * forces:
            share = _FAR_BETWEEN_BODIES
        elif self.stagnates:
            share = _AFTER_STAGNATION
        elif before > 0:
            share = min(_FACTOR * (imbalance / before) ** _POWER, self._first)
        return max(share, last)


# Imbalance to which the nodes are settled, over that of the whole; but below what is accepted.
_SHARE = 1e-2
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

    def __init__(self, system: ZonedSystem, snes: PETSc.SNES, searched: bool) -> None:
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

    def __init__(self, system: ZonedSystem, state: PETSc.Vec, residual: PETSc.Vec) -> None:
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


# Krylov vectors are restarted; a solve that needs more than this is given up.
_MOST_ITERATIONS = 300
# Steps whose linear solves ran out of iterations, one after the other, that come to nothing: each
# costs as much as many that do not.
_MOST_VAIN = 4


class EliminatingNewton:
    """A nonlinear solver of PETSc's type ``python``."""

    def __init__(self, system: ZonedSystem) -> None:
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
