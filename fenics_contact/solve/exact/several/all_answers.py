"""All answers of a problem with few points that may touch, else those that many starts lead to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.solve.exact.active_system import FrictionRows, adhesive_rows, linearised
from fenics_contact.solve.exact.answer import ExactAnswer
from fenics_contact.solve.exact.local_problem import NONE, LocalProblem
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.newton import newton
from fenics_contact.solve.exact.scalars import Scalars
from fenics_contact.solve.exact.several.energy_bound import EnergyBound, Rest
from fenics_contact.solve.exact.several.statuses import PointStatuses
from fenics_contact.solve.exact.several.uniqueness import surely_unique_up_to
from fenics_contact.solve.exact.solver import solve

# Points that may touch, at most, whose statuses are all tried.
MOST_POINTS = 24
# Combinations of statuses of some of the points that are looked at, at most.
_MOST_COMBINATIONS = 20_000
# Of the largest force: answers that differ by less are the same.
_SAME = 1e-7
# Relative changes of the forces of each start.
_PERTURBED = 0.2


@dataclass(frozen=True, eq=False)
class AllAnswers:
    """Answers of a problem that differ from each other.

    Attributes:
        answers: The answers, in the order in which they were found.
        complete: Whether there are surely no others.
        way: How they were looked for, in one sentence.
    """

    answers: tuple[ExactAnswer, ...]
    complete: bool
    way: str


def all_answers(problem: LocalProblem) -> AllAnswers:
    """Find all answers of a problem.

    With up to 24 points that may touch, all combinations of open, stick and slip are tried, except
    those that the energy of the body rules out. In the plane no answer is missed. In space the
    directions of slip are found by Newton's method from each combination, so that answers which
    differ in these alone may be missed. With more points, and with laws whose bounds are not linear
    in the force, starts are tried: the adhesive one, all open, without friction, all slipping
    either way along each axis under these pressures, all touching and sticking, or slipping either
    way; each of these as it is and perturbed twice.

    Args:
        problem: W, q and the laws.
    """
    search = _Search(problem)
    found = search.from_starts()
    if found and surely_unique_up_to(problem) > 1:
        return AllAnswers(tuple(found), True, "by the compliance, which leaves one answer")
    combined = search.from_combinations() if _has_straight_laws(problem) else None
    if combined is None:
        way = f"from {search.starts} starts; there may be others"
        return AllAnswers(tuple(found), False, way)
    every = list(found)
    for answer in combined:
        _add(every, answer)
    way = f"by the statuses of {search.candidates} points that may touch"
    if problem.dimension > 2 and problem.laws.rubs.any():
        way += ", with directions of slip found by Newton's method; there may be others"
        return AllAnswers(tuple(every), False, way)
    return AllAnswers(tuple(every), True, way)


def _has_straight_laws(problem: LocalProblem) -> bool:
    """Whether bounds of friction are straight lines in the force across."""
    laws = problem.laws
    bonded = ~laws.unilateral & ~laws.given & laws.rubs
    return laws.bound is None and not laws.elastic.any() and not bonded.any()


def _add(known: list[ExactAnswer], answer: ExactAnswer) -> None:
    """Add an answer unless it is known."""
    count = answer.equations.count
    forces = answer.state.forces[:count]
    scale = max(np.abs(forces).max(), max((a.equations.scale(a.state) for a in known), default=0.0))
    same = (np.abs(one.state.forces[:count] - forces).max() <= _SAME * scale for one in known)
    if not any(same):
        known.append(answer)


class _Search:
    """Answers of a problem.

    Attributes:
        starts: Number of starts that were tried.
        candidates: Number of points that may touch.
    """

    def __init__(self, problem: LocalProblem) -> None:
        self.problem, self.equations = problem, NaturalMap(problem)
        self.starts = self.candidates = 0

    def from_starts(self) -> list[ExactAnswer]:
        """Answers that Newton's method finds from a list of starts; that of ``solve`` first."""
        first = solve(self.problem)
        found = [first] if first.converged else []
        for start in self._all_starts(first):
            self.starts += 1
            answer = self._from(start, "from another start")
            if answer is not None:
                _add(found, answer)
        return found

    def from_combinations(self) -> list[ExactAnswer] | None:
        """Answers with each combination of statuses; None where there are too many of these."""
        scalars = Scalars(self.equations)
        if not scalars.is_exact:
            return None
        compliance, free = scalars.without()
        found: list[ExactAnswer] = []
        try:
            points = self._that_may_touch(compliance, free)
            if points is None or len(points) == 0:
                return None if points is None else found
            statuses, bound = self._bounded(compliance, free, points)
        except LinAlgError:
            return None
        self._looked = 0
        for rest in self._leaves(statuses, bound, bound.whole(), 0):
            start = np.zeros(len(self.equations.free))
            start[statuses.kept] = bound.forces(rest)
            answer = self._from(start, "from a combination of statuses")
            if answer is not None:
                _add(found, answer)
        return found if self._looked <= _MOST_COMBINATIONS else None

    def _bounded(
        self, compliance: Array, free: Array, points: Integers
    ) -> tuple[PointStatuses, EnergyBound]:
        """Statuses of points that may touch, and the ellipsoid in which all answers are."""
        statuses = PointStatuses(self.equations, compliance, free, points)
        smooth = self._smooth[statuses.kept]
        left = statuses.compliance @ smooth + statuses.free
        across = left[:: self.equations.dimension]
        across[self.equations.unilateral[points]] = 0.0
        rows, constants = statuses.inequalities, statuses.constants
        return statuses, EnergyBound(statuses.compliance, smooth, left, rows, constants)

    def _leaves(
        self, statuses: PointStatuses, bound: EnergyBound, rest: Rest, number: int
    ) -> Iterator[Rest]:
        """Parts of the ellipsoid in which all points have a status."""
        if number == self.candidates:
            yield rest
            return
        for status, holds in statuses.of(number):
            self._looked += 1
            if self._looked > _MOST_COMBINATIONS:
                return
            cut = bound.cut(rest, status.rows, status.values, holds)
            if cut is not None:
                yield from self._leaves(statuses, bound, cut, number + 1)

    def _that_may_touch(self, compliance: Array, free: Array) -> Integers | None:
        """Points that may touch, those first that are deepest in the obstacle; None if too many."""
        equations, size = self.equations, self.equations.dimension
        order = np.argsort(free[::size], kind="stable")
        points = order[equations.active.any(axis=1)[order] | equations.unilateral[order]]
        while len(points):
            statuses, bound = self._bounded(compliance, free, points)
            may = [self._may_touch(statuses, bound, number) for number in range(len(points))]
            self.candidates = int(np.count_nonzero(may))
            if all(may):
                return points if len(points) <= MOST_POINTS else None
            points = points[np.array(may)]
        return points

    def _may_touch(self, statuses: PointStatuses, bound: EnergyBound, number: int) -> bool:
        """Whether a point has a status other than open that the energy allows."""
        whole = bound.whole()
        every = list(statuses.of(number))
        touching = every[1:] if self.equations.unilateral[statuses.points[number]] else every
        return any(
            bound.cut(whole, status.rows, status.values, holds) is not None
            for status, holds in touching
        )

    def _from(self, start: Array | None, way: str) -> ExactAnswer | None:
        """The answer that Newton's method finds from forces, if it finds one."""
        run = newton(self.equations, start)
        if not run.converged:
            return None
        return ExactAnswer(self.problem, self.equations, run.state, run.steps, 0, True, way)

    def _all_starts(self, first: ExactAnswer) -> Iterator[Array]:
        """Forces to begin with, in scaled units."""
        equations, size, count = self.equations, self.equations.dimension, self.equations.count
        random = np.random.default_rng(0)
        nothing = np.zeros(len(equations.free))
        without = self._smooth
        begins = [first.state.forces, nothing, without]
        for axis in range(1, size):
            for sign in (1.0, -1.0):
                slides = without.copy()
                bound = equations.bounds(np.maximum(without[:count:size], 0.0))[0]
                slides[axis:count:size] = sign * np.where(equations.rubs, bound, 0.0)
                begins.append(slides)
        begins += [forces for forces in self._all_touching() if forces is not None]
        scale = max(np.abs(forces[:count]).max() for forces in begins)
        for forces in begins:
            yield forces
            for _ in range(2):
                yield forces + _PERTURBED * scale * random.normal(size=len(forces))

    def _all_touching(self) -> Iterator[Array | None]:
        """Forces where all points touch, and stick, or slip one way along an axis; also pulling."""
        equations = self.equations
        yield self._touching(adhesive_rows(equations))
        rubs = np.flatnonzero(equations.rubs)
        bound, slope = (each[rubs, None] for each in equations.bounds(np.ones(equations.points)))
        along = equations.dimension - 1
        for axis in range(along):
            for sign in (1.0, -1.0):
                way = sign * np.eye(along)[[axis] * len(rubs)]
                turning = np.zeros((len(rubs), along, along))
                known = np.where(equations.given[rubs, None], bound, bound - slope)
                yield self._touching(FrictionRows(rubs, turning, slope * way, known * way))

    def _touching(self, friction: FrictionRows) -> Array | None:
        """Forces where all points touch; None where there are none."""
        equations = self.equations
        system = linearised(equations, np.ones(equations.points, dtype=bool), friction)
        if system is None:
            return None
        forces = np.zeros(len(equations.free))
        forces[system.rows] = system.solve(system.right)
        return forces

    @cached_property
    def _smooth(self) -> Array:
        """Forces of the problem without any force along the contact, in scaled units."""
        laws = replace(self.problem.laws, along=np.full(self.problem.points, NONE))
        return solve(self.problem.with_laws(laws)).state.forces
