"""Contact and friction solved exactly at the contact points: without penalty and smoothing."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from mpi4py import MPI
from scipy.linalg import LinAlgError

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import from_root
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, STICK
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.at_points.contact_points import ContactPoints
from fenics_contact.solve.at_points.point_adjoint import PointAdjoint
from fenics_contact.solve.at_points.point_laws import laws_of
from fenics_contact.solve.at_points.point_operator import PointOperator
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.exact.derivatives import points_at_edges
from fenics_contact.solve.exact.local_problem import LocalProblem, PointLaws
from fenics_contact.solve.exact.solver import solve

logger = logging.getLogger(__name__)

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class ExactForces:
    """Forces at the points of all contacts, the same on every rank.

    Attributes:
        rows: Of each point, across and along, then the feet of springs (force; length).
        closed: Points that touch, (points,).
        sticks: Those of these that stick.
        steps: Newton steps that it took, those of failed tries and sweeps included.
        converged: Whether it satisfies the laws at the points.
        residual: What is left of the laws, over the forces.
        way: How it was found, in words.
        at_edges: Number of points just between two statuses.
        imbalance: Of the forces on the body, with it (force).
        limit: Up to which that counts as none (force).
    """

    rows: Array
    closed: Flags
    sticks: Flags
    steps: int
    converged: bool
    residual: float
    way: str
    at_edges: int = 0
    imbalance: float = np.inf
    limit: float = 0.0

    @property
    def is_found(self) -> bool:
        """Whether it is an answer: laws hold, and the body is in balance."""
        return self.converged and self.imbalance <= self.limit


@dataclass(frozen=True, eq=False)
class FoundAnswers:
    """Forces at the points of several answers, the same on every rank.

    Attributes:
        forces: Of each answer, with feet, (rows + feet,) (force; length).
        complete: Whether there are surely no others.
        way: How they were looked for, in words.
    """

    forces: list[Array]
    complete: bool
    way: str


_BROKEN_DOWN = FoundAnswers([], False, "as the search broke down; there may be others")


class ExactSolver:
    """Solves the laws of all contacts of a condensed problem at their points.

    Attributes:
        at_edges: Number of points just between two statuses in the last answer.

    Args:
        problem: Whose laws are covered (``point_laws.why_not``).
        system: The problem, condensed.
    """

    def __init__(self, problem: Problem, system: CondensedSystem) -> None:
        self._problem, self._system = problem, system
        self._of: tuple[object, ...] = ()
        self._operator: PointOperator | None = None
        self._local: LocalProblem | None = None
        self._last: Array | None = None
        self.at_edges = 0

    @property
    def rows(self) -> int:
        """Number of rows of all points, known before their operator is made; collective."""
        return sum(one.count * one.size for one in self._points())

    @property
    def last_forces(self) -> Array | None:
        """Forces of the last answer, with feet, (rows + feet,); None before there is one."""
        return self._last

    def begin_again(self) -> None:
        """Forget the last answer; how forces move the points is kept."""
        self._last, self.at_edges = None, 0

    def solve(
        self,
        start: Array | None = None,
        parameters: Mapping[ContactSurface, tuple[float, float]] | None = None,
    ) -> ExactForces:
        """Take the system and its contacts to the exact answer at the present loads; collective.

        It begins from the last answer, if there is one, else from points that stick wherever the
        surfaces overlap. Where round-off of soft bodies leaves forces out of balance, what is left
        is solved for once more.

        Args:
            start: Forces of another answer to begin with, as of ``last_forces``; of other points
                they are left out.
            parameters: ε₁ (length/stress) and ε (length) of each contact; by default those that
                scenes give which ask for exact contacts, else none.
        """
        operator = self._present()
        size = from_root(self._system.comm, operator.size)
        if start is not None and len(start) == size:
            self._last = start
        for one in operator.points:
            given = None if parameters is None else parameters[one.contact]
            one.contact.find_forces(*(given or self._parameters(one.contact)))
        found = self._solve(operator, None)
        if found.converged and not found.is_found:
            again = self._solve(operator, found.rows)
            found = replace(again, steps=found.steps + again.steps)
        self.at_edges = found.at_edges
        return found

    def adjoint(self) -> PointAdjoint:
        """The laws linearised at the forces that act, which are an answer; collective.

        Raises:
            NotConvergedError: The answer ends there.
        """
        operator = self._present()
        openings, laws = operator.openings(), laws_of(operator.points)
        acting = [_acting(one) for one in operator.points]
        forces, answer = np.concatenate(acting), None
        if operator.compliance is not None:
            base = np.append(forces, np.zeros(len(openings) - operator.rows))
            free = openings - operator.compliance @ base
            problem = self._local_problem(operator, free, laws)
            answer = _tried(lambda: solve(problem, base))
        return PointAdjoint(operator, answer, forces, self._system.comm)

    def all_answers(self) -> FoundAnswers:
        """Find forces of all answers at the present loads, to ``solve`` from; collective."""
        # It needs scipy.optimize, which few runs have to load.
        from fenics_contact.solve.exact.several import all_answers

        operator = self._present()
        for one in operator.points:
            one.contact.find_forces(*self._parameters(one.contact))
        openings, laws = operator.openings(), laws_of(operator.points)
        found = None
        if operator.compliance is not None:
            problem = self._local_problem(operator, openings, laws)
            every = _tried(lambda: all_answers(problem))
            found = _BROKEN_DOWN
            if every is not None:
                forces = [one.forces for one in every.answers]
                found = FoundAnswers(forces, every.complete, every.way)
        answers = from_root(self._system.comm, found)
        assert answers is not None
        return answers

    def _solve(self, operator: PointOperator, acting: Array | None) -> ExactForces:
        """One solve; collective.

        Args:
            operator: How forces move points.
            acting: Forces at the points that act already, (rows,); None where none do.
        """
        openings, laws = operator.openings(), laws_of(operator.points)
        found = None
        if operator.compliance is not None:
            base = np.zeros(len(openings))
            if acting is not None:
                base[: operator.rows] = acting[: operator.rows]
            free = openings - operator.compliance @ base
            found = _solved(self._local_problem(operator, free, laws), self._last)
            changed = found.rows - base
        else:
            changed = np.zeros(0)
        answer = from_root(self._system.comm, found)
        assert answer is not None
        self._act(operator, answer)
        operator.move(changed)
        if answer.converged:
            self._last = answer.rows.copy()
            self._last[operator.rows :] = 0.0  # feet are told from where the state is now
        return self._judged(answer)

    def _local_problem(self, operator: PointOperator, free: Array, laws: PointLaws) -> LocalProblem:
        """The problem at the points, on rank 0; what follows from W alone is kept."""
        if self._local is None:
            assert operator.compliance is not None
            feet = len(free) - operator.rows
            self._local = LocalProblem(operator.compliance, free, laws, self._weights, scalars=feet)
        self._local = self._local.with_laws(laws, free)
        return self._local

    def _judged(self, answer: ExactForces) -> ExactForces:
        """With the balance of the body under these forces; collective."""
        system = self._system
        system.balance(system.state, system.residual)
        limit = max(self._problem.scene.solver.tolerance * system.forces, system.round_off())
        return replace(answer, imbalance=system.imbalance(), limit=limit)

    def _parameters(self, contact: ContactSurface) -> tuple[float, float]:
        """ε₁ and ε: of scenes that ask for exact contacts as they are given, else none."""
        return contact.contact.exact_parameters if self._problem.scene.is_exact else (0.0, 0.0)

    def _present(self) -> PointOperator:
        """How forces move points as they are paired, and with scalars held, now; collective."""
        of = (self._system.version, *self._system.held_scalars)
        operator = self._operator
        if operator is None or of != self._of or not self._are_all(operator):
            points = self._points()
            operator = self._operator = PointOperator(self._system, points)
            self._weights = np.concatenate([one.weights for one in points])
            self._of, self._last, self._local = of, None, None
        return operator

    def _points(self) -> list[ContactPoints]:
        acting = [contact for contact in self._problem.contacts if contact.forces.terms]
        return [ContactPoints(contact) for contact in acting]

    def _are_all(self, operator: PointOperator) -> bool:
        """Whether the points are those that have something opposite now; collective."""
        same = all(one.are_all for one in operator.points)
        return bool(self._system.comm.allreduce(same, op=MPI.LAND))

    @staticmethod
    def _act(operator: PointOperator, answer: ExactForces) -> None:
        """Have the forces act; collective."""
        first = 0
        for one in operator.points:
            last = first + one.count
            rows = answer.rows[first * one.size : last * one.size].reshape(-1, one.size)
            pressure, traction = one.tractions(rows)
            closed, sticks = (
                one.flags(which[first:last]) for which in (answer.closed, answer.sticks)
            )
            assert one.contact.found is not None
            found = replace(
                one.contact.found,
                pressure=pressure,
                traction=traction,
                closed=closed,
                sticks=sticks,
            )
            one.contact.take_found(found)
            first = last


def _acting(points: ContactPoints) -> Array:
    """Forces that act at the points of a contact, (rows,) (force); collective."""
    found = points.contact.found
    assert found is not None
    return points.rows_of(found.pressure, found.traction)


def _none(problem: LocalProblem) -> ExactForces:
    """No answer, and no state that is worth to be kept."""
    nowhere = np.zeros(problem.points, dtype=bool)
    nothing = np.zeros(len(problem.free))
    return ExactForces(nothing, nowhere, nowhere, 0, converged=False, residual=np.inf, way="")


def _tried(work: Callable[[], T]) -> T | None:
    """What rank 0 works out, None where it breaks down: no other rank may wait for it."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            return work()
    except (ArithmeticError, ValueError, LinAlgError) as error:  # numbers that are none
        logger.debug("exact solve: %s", error)
        return None


def _solved(problem: LocalProblem, start: Array | None) -> ExactForces:
    answer = _tried(lambda: solve(problem, start))
    if answer is None:
        return _none(problem)
    return ExactForces(
        rows=answer.forces,
        closed=answer.statuses != OPEN,
        sticks=answer.statuses == STICK,
        steps=answer.steps + answer.sweeps,
        converged=answer.converged,
        residual=answer.residual,
        way=answer.way,
        at_edges=int(np.count_nonzero(points_at_edges(answer))),
    )
