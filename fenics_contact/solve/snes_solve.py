"""One solve by PETSc's SNES: its functions and options, and when it stops."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

import numpy as np
from petsc4py import PETSc

from fenics_contact.common import mumps
from fenics_contact.common.errors import (
    FenicsContactError,
    MachineError,
    NotConvergedError,
    StoppedError,
)
from fenics_contact.common.failures import original
from fenics_contact.common.petsc_options import PREFIX
from fenics_contact.common.timings import Timings
from fenics_contact.contact.noise import round_off
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.closing import ClosingByTurns
from fenics_contact.solve.globalisation import (
    ENERGY_SEARCH,
    FULL_STEPS,
    QUICK,
    THOROUGH_SEARCH,
    PenaltyPath,
    SpringControl,
    StepDamping,
    comes_no_nearer,
    run_far,
    share_of_step,
)
from fenics_contact.solve.newton_failure import (
    GIVEN_UP,
    NO_SOLVE,
    NO_STEP_FOUND,
    NOT_A_NUMBER,
    Chatter,
    FactorisationLog,
    StepBudget,
    not_converged,
)
from fenics_contact.solve.systems.system import System

logger = logging.getLogger(__name__)

# Share of the applied forces above which a round-off floor is not believed: the
# floor grows with |u|, and a body that runs away must not pass for an answer.
_LARGEST_FLOOR = 1e-6

# Steps without progress in which a search is taken to follow round-off.
_PATIENCE = 3

# Newton steps from which is noted what contact points do, for who reads that it failed.
_LONG = 12

# Steps with friction that are taken in full, whatever the imbalance after them: of a solve from
# afar, and of one that goes on from a load step.
IN_FULL, IN_FULL_AT_LAST_STEP = 8, 0

# Share to which a step is cut, and how many such steps in a row, that lead nowhere: then full steps
# are taken, as many as of a solve from afar.
_TINY, _TINY_STEPS = 0.1, 2


class SnesSolve:
    """SNES on a system, from the system's present state; ``Newton`` says in which way.

    Attributes:
        problem: The problem.
        system: Its unknowns and their balance.
        imbalances: Force imbalance before every Newton step and at the end, of all solves (force).
        steps: Newton steps of all solves.
        limit: Imbalance that the last solve accepted as converged (force).
        budget: How many more steps are allowed, if that is bounded.
        closes_by_turns: Whether, where friction alone holds bodies, points close by turns
            (``closing``), in place of steps that are cut.

    Args:
        problem: The problem.
        system: Its unknowns and their balance.
        timings: Seconds so far.
        stopped: Whether this rank was asked to stop; asked before every Newton step.
    """

    def __init__(
        self,
        problem: Problem,
        system: System,
        timings: Timings,
        stopped: Callable[[], bool] | None = None,
    ) -> None:
        self.problem = problem
        self.system = system
        self.timings = timings
        self.comm = problem.comm
        self.imbalances: list[float] = []
        self.steps = 0
        self.limit = 0.0
        self.budget = StepBudget()
        self._chatter = Chatter(problem.contacts, problem.comm)
        self._one_sided = any(contact.is_one_sided for contact in problem.contacts)
        self.closes_by_turns = False
        # How the next solve goes about it.
        self._tolerance = problem.scene.solver.tolerance
        self._searches = False
        self._search: dict[str, Any] = ENERGY_SEARCH
        self._springs: SpringControl | None = None
        self._cuts_growth = False
        self._in_full = IN_FULL
        self._tiny_steps = 0
        self._hopeless: Callable[[int], int] | None = None
        self._most: int | None = None
        self._fewest = 0
        # What is known of it on its way.
        self._damping = StepDamping()
        self._closing: ClosingByTurns | None = None
        self._stopped = stopped or (lambda: False)
        self._is_stopped = False
        self._tiny = 0.0
        self._largest = 0.0
        self._before = 0
        self._ran_far = False
        self._first_forces = 0.0
        self._own_options: list[str] = []
        self._spare = mumps.SPARE_WORKSPACE[0]

    def _solve(self) -> None:
        """One solve; a factorisation that needs more workspace is tried with more; collective.

        Raises:
            NotConvergedError: In words, with the history of the force imbalance.
        """
        self._before = len(self.imbalances)
        self.limit = 0.0
        self._chatter.clear()
        reason, failure = self._solve_once()
        for spare in mumps.SPARE_WORKSPACE[1:]:
            if not isinstance(failure, mumps.WorkspaceError):
                break
            self._spare = spare
            self.imbalances.pop()  # it goes on from the same state
            reason, failure = self._solve_once()
        if self._is_stopped:
            raise StoppedError("interrupted")
        if isinstance(failure, MachineError):  # no smaller load step would help
            raise failure
        self.steps += self._steps_of_this_run
        accepted = len(self.imbalances) > self._before and self.imbalances[-1] <= self.limit
        if reason < 0 or not accepted:
            self.budget.require_left()
            raise NotConvergedError(self._words(reason), tuple(self.imbalances))

    def _words(self, reason: int) -> str:
        """How the last solve failed; of a few steps on the way, which nobody reads, no more."""
        if self._most is not None:
            return f"on the way after {self._most} Newton steps"
        own, forces = self.imbalances[self._before :], self.system.forces
        return not_converged(self.problem, own, forces, reason, self._chatter)

    def _solve_once(self) -> tuple[int, FenicsContactError | None]:
        """PETSc's reason to stop, and how a factorisation failed, or None; collective."""
        # A body that runs away overflows here and there: the force imbalance tells.
        with self.timings.phase("solve"), np.errstate(over="ignore", invalid="ignore"):
            log = FactorisationLog()
            snes: PETSc.SNES = PETSc.SNES().create(self.comm)
            try:
                self._set_up(snes)
                snes.solve(None, self.system.state)
                reason = snes.getConvergedReason()
                failure = mumps.failure_of(snes.getKSP().getPC()) if reason == NO_SOLVE else None
                self._release()  # no residual comes after the last tangent
                self.system.take(self.system.state)
            except PETSc.Error as error:
                raise original(error) from None
            finally:
                snes.destroy()
                for name in self._own_options:  # the database is global: the next may want others
                    PETSc.Options().delValue(name)
                self._own_options.clear()
            self.timings.move("solve", "factorise", log.seconds())
        return reason, failure

    @property
    def _may_be_moved(self) -> bool:
        """Whether supports may move a body that then has no forces at all."""
        return self._one_sided or not self.problem.contacts

    @property
    def _is_strained_alone(self) -> bool:
        """Whether given strains act on bodies without contacts, which may leave no forces."""
        strained = any(one.is_given for one in self.problem.body_scalars)
        return strained and not self.problem.contacts

    @property
    def _is_nearly_balanced(self) -> bool:
        """Whether no more is left of the forces than what round-off may make."""
        return len(self.imbalances) > self._before and (
            self.imbalances[-1] <= _LARGEST_FLOOR * self.system.forces
        )

    @property
    def _steps_of_this_run(self) -> int:
        return max(len(self.imbalances) - self._before - 1, 0)

    def _ask_to_stop(self) -> bool:
        """Whether any rank was asked to stop; collective."""
        self._is_stopped = bool(self.comm.allreduce(int(self._stopped())))
        return self._is_stopped

    def _set_up(self, snes: PETSc.SNES) -> None:
        """Functions and options; what the user has set wins over our own."""
        system = self.system
        snes.setOptionsPrefix(PREFIX)
        snes.setFunction(self._set_residual, system.residual)
        snes.setJacobian(self._set_tangent, system.tangent)
        options = PETSc.Options()
        search = self._search if self._searches else FULL_STEPS
        workspace = mumps.workspace_option(system.options, self._spare)
        for name, value in (system.options | workspace | search).items():
            if not options.hasName(PREFIX + name):
                options.setValue(PREFIX + name, value)
                self._own_options.append(PREFIX + name)
        most = self.problem.scene.solver.max_iterations
        if self._searches and self._search is ENERGY_SEARCH:
            most = min(most, QUICK)
        if self._most is not None:
            most = min(most, self._most)
        # Only systems with a nonlinear solver of their own look at rtol.
        snes.setTolerances(rtol=self._tolerance, atol=0.0, stol=0.0, max_it=most)
        system.prepare(snes)
        snes.setFromOptions()
        by_turns = self._cuts_growth and self.closes_by_turns and not self._searches
        self._closing = ClosingByTurns(self.problem.contacts) if by_turns else None
        if not self._searches:
            self._damping, self._tiny_steps = StepDamping(), 0
            cuts = self._cuts_growth and not by_turns
            snes.setLineSearchPreCheck(self._damp_or_cut if cuts else self._damp)
        elif self._search is THOROUGH_SEARCH:
            snes.setLineSearchPreCheck(self._cut_to_slope)
        snes.setConvergenceTest(self._converged)

    def _damp(self, state: PETSc.Vec, step: PETSc.Vec) -> bool:
        """Shorten a full step where they go round in circles."""
        share = self._damping.share(self.imbalances[self._before :])
        step.scale(share)
        return share < 1.0

    def _damp_or_cut(self, state: PETSc.Vec, step: PETSc.Vec) -> bool:
        """Cut a full step under which the imbalance would grow; collective.

        The first ones never, of a solve from afar: many points open and close in these, which full
        steps find soonest; later ones can go round in circles. From a load step that was solved,
        its statuses are nearly those of the next one, which full steps leave.

        Contact and friction together have no energy, but what they do along a step tells how far it
        leads as well: friction takes a part of the work that pressures do. Where many points are to
        change one after the other, that is to the next of them only: then full steps follow.
        """
        taken = len(self.imbalances) - self._before
        if taken <= self._in_full or self._imbalance_after(state, step) <= self.imbalances[-1]:
            return self._damp(state, step)
        share = self._cut(state, step)
        self._tiny_steps = self._tiny_steps + 1 if share < _TINY else 0
        if self._tiny_steps == _TINY_STEPS:
            self._tiny_steps, self._in_full = 0, taken + IN_FULL
        return True

    def _imbalance_after(self, state: PETSc.Vec, step: PETSc.Vec) -> float:
        """Force imbalance after a full step (it is taken off the state); collective."""
        tried = state.duplicate()
        tried.waxpy(-1.0, step, state)
        self._set_residual(None, tried, self.system.residual)  # SNES sets it anew after the step
        tried.destroy()
        return self.system.imbalance()

    def _cut_to_slope(self, state: PETSc.Vec, step: PETSc.Vec) -> bool:
        """Cut a Newton step, as PETSc asks for it; collective."""
        self._cut(state, step)
        return True

    def _cut(self, state: PETSc.Vec, step: PETSc.Vec) -> float:
        """Cut a Newton step (it is taken off the state) to where energy falls; collective.

        Returns:
            The share that is left of it.
        """
        tried, residual = state.duplicate(), self.system.residual.duplicate()

        def slope_at(share: float) -> float:
            tried.waxpy(-share, step, state)
            self._set_residual(None, tried, residual)
            return -float(residual.dot(step))

        share = share_of_step(slope_at)
        step.scale(share)
        tried.destroy()
        residual.destroy()
        return share

    def _set_residual(self, snes: PETSc.SNES, state: PETSc.Vec, residual: PETSc.Vec) -> None:
        with self.timings.phase("assemble"):
            self._release()
            self.system.balance(state, residual)

    def _release(self) -> None:
        """Let points that were held open for a step be as they are."""
        if self._closing is not None:
            self._closing.release()

    def _set_tangent(
        self, snes: PETSc.SNES, state: PETSc.Vec, tangent: PETSc.Mat, preconditioner: PETSc.Mat
    ) -> None:
        with self.timings.phase("assemble"):
            own, springs = self.imbalances[self._before :], self._springs
            share = 0.0 if springs is None else springs.share(own, self.system.forces)
            if self._closing is not None and self._closing.hold_open():
                self.system.balance(state, self.system.residual)  # what the step is to balance
            self.system.linearise(state, share)

    def _converged(
        self, snes: PETSc.SNES, iteration: int, norms: tuple[float, float, float]
    ) -> Any:
        """Stop when the force imbalance is small against the forces, or is round-off.

        The 1-norm bounds the error of any resultant. PETSc's relative tolerance is
        not used: its reference, the first residual, is no physical force.
        """
        imbalance = self.system.imbalance()
        self.imbalances.append(imbalance)
        self.budget.count(iteration)
        if iteration >= _LONG:
            self._chatter.note()
        forces = self.system.forces
        if iteration == 0:
            self._first_forces = forces
            self._tiny = _LARGEST_FLOOR * imbalance if self._may_be_moved else 0.0
            if self._is_strained_alone:  # a step finds it, whatever there is to compare with
                self._tiny = np.inf
            self._largest = max(self._largest, self._tiny)
        logger.debug("  Newton step %d: force imbalance %.2e of %.3g", iteration, imbalance, forces)
        if not np.isfinite(imbalance) or self._ask_to_stop():
            return NOT_A_NUMBER
        self.limit = self._tolerance * forces
        # A body that a motion of its supports takes along has no forces to compare with; that
        # it does not run away is then tested at the end.
        cap = np.inf if self._may_be_moved else _LARGEST_FLOOR * forces
        # The floor may cost a matrix copy, so it is asked for only where it may decide.
        wanders = iteration >= _PATIENCE and imbalance >= self.imbalances[-1 - _PATIENCE]
        # A solve that begins at an answer without forces has nothing else to compare with.
        tiny = self._largest if wanders else self._tiny
        if iteration > 0 and self.limit < imbalance <= max(_LARGEST_FLOOR * forces, tiny):
            # Beyond that share of the forces it is told from what one step leaves by a second one.
            is_small = imbalance <= _LARGEST_FLOOR * forces or self._is_strained_alone
            if is_small or iteration > 1:
                self.limit = max(self.limit, min(self._round_off(), cap))
        has_begun = iteration >= self._fewest and not self._mean_stress_is_missing(iteration)
        if imbalance <= self.limit and has_begun:
            return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_ABS
        if self._searches and wanders and self._is_nearly_balanced:
            return NO_STEP_FOUND
        if self.budget.is_used_up:
            return GIVEN_UP
        own = self.imbalances[self._before :]
        if self.system.is_sprung and self._springs is None and run_far(own, self._first_forces):
            self._ran_far = True
            return GIVEN_UP
        is_quick = self._searches and self._search is ENERGY_SEARCH
        if is_quick and comes_no_nearer(own) and PenaltyPath(self.problem).exists:
            return GIVEN_UP
        return 0 if self._hopeless is None else self._hopeless(iteration)

    def _round_off(self) -> float:
        """Residual that round-off leaves (force); collective."""
        of_motions = [round_off(contact) for contact in self.problem.contacts]
        return self.system.round_off() + sum(of_motions)

    def _mean_stress_is_missing(self, iteration: int) -> bool:
        """Whether a mean stress is yet to be found, be there no free displacement at all."""
        return iteration == 0 and self.problem.elastic.mixed is not None
