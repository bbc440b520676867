"""Solves by Newton's method that fail: budgets of steps, statuses that keep changing, reasons."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import FenicsContactError, NotConvergedError
from fenics_contact.common.parallel import gather_rows, largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import all_round_off
from fenics_contact.problem.existence.undetermined import untouched_parts
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.systems.system import System


class BudgetExceededError(FenicsContactError):
    """More Newton steps would be needed than are allowed; other ways would need some, too."""

    exit_code = NotConvergedError.exit_code


class StepBudget:
    """Newton steps that solves may take together.

    Steps are counted, and not seconds: so the same is found on any number of ranks and by any
    machine.
    """

    def __init__(self) -> None:
        self._left: int | None = None
        self._words = ""

    @contextmanager
    def of(self, steps: int, words: str) -> Iterator[None]:
        """Allow so many steps inside, and any number afterwards.

        Args:
            steps: How many.
            words: What happened once they are used up.
        """
        self._left, self._words = steps, words
        try:
            yield
        finally:
            self._left = None

    def count(self, iteration: int) -> None:
        """Note that a solve tests its convergence.

        Args:
            iteration: Newton steps of this solve; none is taken before the first test.
        """
        if self._left is not None and iteration > 0:
            self._left -= 1

    @property
    def is_used_up(self) -> bool:
        """Whether no step is left."""
        return self._left is not None and self._left <= 0

    def require_left(self) -> None:
        """Refuse to go on without a step left.

        Raises:
            BudgetExceededError: On every rank.
        """
        if self.is_used_up:
            raise BudgetExceededError(self._words)


class FactorisationLog:
    """Seconds that PETSc spends on factorisations from now on."""

    _EVENTS = ("MatLUFactorSym", "MatLUFactorNum")

    def __init__(self) -> None:
        PETSc.Log.begin()
        self._before = self._read()

    def _read(self) -> float:
        return float(sum(PETSc.Log.Event(name).getPerfInfo()["time"] for name in self._EVENTS))

    def seconds(self) -> float:
        """Seconds that factorisations have taken since the start."""
        return self._read() - self._before


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


# PETSc's reasons, whose names differ between versions.
NO_SOLVE = -3
NOT_A_NUMBER = -4
NO_STEP_FOUND = -6
GROWS = -9
GIVEN_UP = -10
_REASONS = {
    NO_SOLVE: "the linear system could not be solved (a singular matrix: is the body held?)",
    NOT_A_NUMBER: "the forces became infinite or not a number",
    -5: "the Newton steps allowed were used up",
    NO_STEP_FOUND: "the line search found no step",
    GROWS: "the force imbalance grows",
    GIVEN_UP: "pressures are far from those that the regularisation was chosen for",
}
# Newton steps by which an imbalance is judged to fall or not.
_LATEST = 20
# Of the forces: an imbalance that may be round-off.
_SMALL_REST = 1e-3
# Of the forces: an imbalance that is round-off, and yet makes an answer worthless.
_OUT_OF_BALANCE = 2e-3
_RUNAWAY = 1e3  # of the body's size


def not_converged(
    problem: Problem, imbalances: Sequence[float], forces: float, reason: int, chatter: Chatter
) -> str:
    """A solve that ended without an answer; collective.

    Args:
        problem: The model.
        imbalances: Force imbalance before every Newton step of the solve, and at its end (force).
        forces: What these are small against (force).
        reason: PETSc's.
        chatter: What contact points did in the last steps.
    """
    words = _REASONS.get(reason, f"PETSc's reason {reason}")
    left = f"{imbalances[-1]:.2e}" if imbalances else "unknown"
    advice = "Try a larger solver.max_iterations, or a finer mesh at the contact"
    if problem.frictional:
        advice = "Try a larger solver.max_iterations, or a larger regularisation_parameter"
    if RigidMotions(problem).slides_on_coulomb:
        advice = (
            "Only friction holds a body back here: the loads may be more than it can hold, "
            "and then there is no answer"
        )
    if floating := untouched_parts(problem):
        who = " and ".join(f"'{name}'" for name in floating)
        advice = (
            f"Nothing touches {who} here, and no support holds it: it may float in its clearance, "
            "until a support holds it, or a load presses it on"
        )
    if _is_falling(imbalances):
        advice = "It was still falling: try a larger solver.max_iterations"
    elif imbalances and imbalances[-1] <= _SMALL_REST * forces:
        advice = (
            "So small a rest may be round-off: is a penalty_parameter too small, or the "
            "contrast of stiffnesses extreme?"
        )
    return (
        f"not converged after {max(len(imbalances) - 1, 0)} Newton steps: {words}; the force "
        f"imbalance is {left} of {forces:.3g}{chatter.words('Newton steps')}. {advice}"
    )


def _is_falling(imbalances: Sequence[float]) -> bool:
    """Whether the last steps have brought the imbalance down."""
    recent = imbalances[-_LATEST:]
    return len(recent) == _LATEST and recent[-1] < 0.8 * min(recent[: _LATEST // 2])


def runaway(problem: Problem, system: System) -> str | None:
    """No answer of linear elasticity is a thousand times the body away from its start; collective.

    Returns:
        What to say of one that is; None where none is.
    """
    if system.moved() <= _RUNAWAY * problem.spaces.size:
        return None
    if problem.coulomb and RigidMotions(problem).count:
        return (
            "the body runs away: displacements are more than a thousand times its size; friction "
            "is to hold what supports leave free, and the loads may be more than it can hold"
        )
    return (
        "the body runs away: displacements are more than a thousand times its size; is it "
        "held, and are loads and stiffness in the same units?"
    )


def lost_in_roundoff(problem: Problem, left: float, forces: float) -> str | None:
    """No answer is one of which round-off in the stiff springs leaves a part open; collective.

    Round-off is accepted as such by the size of the springs, not of the forces.

    Args:
        problem: The model; its contacts are in the state to judge.
        left: Force imbalance (force).
        forces: What it is small against (force).

    Returns:
        What to say of such an answer; None of others.
    """
    pushing = [contact for contact in problem.contacts if contact.is_one_sided]
    touches = any([largest(problem.comm, contact.pressure()) > 0 for contact in pushing])
    if not touches or left <= _OUT_OF_BALANCE * forces or forces <= 0:
        return None
    if all_round_off(problem.contacts, forces):  # moved along: there is nothing to drown
        return None
    return (
        f"round-off drowns the contact: {left:.2e} of forces of {forces:.3g} are out of "
        "balance for good; a larger penalty_parameter, or less contrast of stiffnesses, "
        "would leave less"
    )
