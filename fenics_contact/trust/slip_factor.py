"""Factor by which varying loads can grow until friction no longer holds a part.

Loads vary if their factor changes in the last load step; all others are constant. With the
pressures of the answer the factor is the least (j(r) − f₀(r))/f₁(r) over rigid motions r that slip
along all that touches, where j is the most work that friction can take, f₀ and f₁ the work of
constant and of varying loads (``rigid_slip``). That holds if the pressures do not follow the loads,
which a solve with slightly larger loads tells. If they do, the loads grow step by step instead,
where the scene asks for it: each time to most of the factor by the pressures found there. Else
there is an upper bound, for pressures that may be any (``load_growth``).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.problem.existence.load_growth import MOST, GrowthLimit, growth_limit
from fenics_contact.problem.existence.slip_shares import slip_shares
from fenics_contact.problem.loads.disturbance import Disturbance
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.solving_again import Quantities, last_step_again

HELD, STEPS, BOUND = "pressures held", "load steps", "upper bound"
# By how much loads grow to see whether the pressures follow them.
_MORE = 0.01
# Of the factor: how far it may move until it is reached, if the pressures count as held.
_SAME = 0.01
# Of the way to where parts would slip: how much of it is taken at once.
_WAY = 0.8
# Of the factor: how near the loads come to it, and steps at the most.
_NEAR, _TRIES = 5e-3, 12
_FACTOR = "factor"


@dataclass(frozen=True)
class SlipFactor:
    """Factor by which varying loads can grow until a part slips as a whole.

    Attributes:
        factor: At which parts slip as a whole, 1 for the present loads; None if it is not known.
        kind: How it was found: ``pressures held``, ``load steps`` or ``upper bound``; empty if it
            was not.
        motion: Of an upper bound, that which runs there, in words.
        bracket: How far parts may slip before or after it, as loads were not taken there; None if
            that cannot be told.
        loaded: Factor of the loads at which load steps ended.
    """

    factor: float | None = None
    kind: str = ""
    motion: str = ""
    bracket: float | None = 0.0
    loaded: float | None = None

    @property
    def is_bound(self) -> bool:
        """Whether parts may slip before."""
        return self.kind == BOUND


@dataclass(frozen=True, eq=False)
class _Growth:
    """The last load step with its varying loads multiplied.

    Attributes:
        load_steps: At their end.
        varying: Nodal forces of the varying loads for a factor of 1, (nodes, components) (force).
    """

    load_steps: LoadSteps
    varying: Array

    def limit(self, solution: Solution, factor: float) -> float | None:
        """The factor at which parts slip by the pressures of an answer; collective.

        Args:
            solution: In whose state the problem is.
            factor: Of the varying loads in it.
        """
        shares = slip_shares(self.load_steps.problem, solution.states)
        return None if shares is None else shares.factor(self.varying, factor)

    def limit_at(self, factor: float) -> float | None:
        """The factor by the pressures with larger loads; None without an answer; collective."""

        def measure(solution: Solution) -> Quantities:
            found = self.limit(solution, factor)
            return {} if found is None else {_FACTOR: found}

        found = last_step_again(self.load_steps, measure, partial(self._grow, factor))
        return None if not found else float(np.ravel(found[_FACTOR])[0])

    def _grow(self, factor: float, problem: Problem) -> None:
        assert self.load_steps.last is not None
        time = self.load_steps.last.time
        problem.disturbance = Disturbance.growing((factor - 1) * self.varying, time)
        problem.set_time(time)


def slip_factor(load_steps: LoadSteps, by_steps: bool, near: float | None = None) -> SlipFactor:
    """Find the factor by which the varying loads of an answer can grow; collective.

    Args:
        load_steps: At their end; all is as it was afterwards.
        by_steps: Whether the loads are to grow step by step, where the pressures follow them.
        near: A factor of the loads that is to be tried before all others; None for none.
    """
    last, problem = load_steps.last, load_steps.problem
    if last is None or problem.inertia.moves or not problem.frictional:
        return SlipFactor()
    if not problem.elastic.is_linear:  # the tractions would have to move with the body
        return SlipFactor()
    before = 0.0 if last.before is None else last.before.time
    drives = [[one.paths.force(time) for one in problem.contacts] for time in (before, last.time)]
    growth = _Growth(load_steps, _varying_load(problem, before))
    first = growth.limit(last.solution, 1.0)
    if first is None or drives[0] != drives[1]:  # an obstacle's force is no load of the body
        return SlipFactor()
    bound = growth_limit(problem, growth.varying, 1.0)
    is_reached = bound is None or first <= bound.factor * (1 + _NEAR)
    if first - 1 <= _NEAR:
        return SlipFactor(first, HELD, bracket=first - 1)
    moves = _moves(growth, first) if is_reached else None
    if moves is not None and moves <= _SAME * first:
        return SlipFactor(first, HELD, bracket=moves)
    found = _by_steps(growth, first, bound, near) if by_steps else SlipFactor()
    if found.factor is not None or bound is None:
        return found
    return SlipFactor(bound.factor, BOUND, bound.motion)


def _varying_load(problem: Problem, before: float) -> Array:
    """Present nodal forces of the loads whose factor was another one at an earlier pseudo-time."""
    time = problem.scene.path_time(before)
    found = np.zeros((len(problem.spaces.coordinates), problem.spaces.components))
    for load, (_, nodal, share) in zip(problem.loads, problem.acting_loads, strict=True):
        if load.path(time) != share:
            found += nodal * share
    return found


def _moves(growth: _Growth, first: float) -> float | None:
    """How far the factor moves until it is reached, by how it does at first; collective.

    None where slightly larger loads have no answer.
    """
    grown = min(_MORE, (first - 1) / 2)
    more = growth.limit_at(1 + grown)
    return None if more is None else abs(more - first) * (first - 1) / grown


def _by_steps(
    growth: _Growth, first: float, bound: GrowthLimit | None, near: float | None
) -> SlipFactor:
    """Let the loads grow until they are near the factor by the pressures with them; collective.

    Or near the bound, beyond which they have no answer, as where a part tips. What the loads were
    before they grew to a factor does not matter, so that one that is known to be near comes first.
    """
    most = np.inf if bound is None else bound.factor
    factor, limit, way = 1.0, min(first, most), _WAY
    moves = 0.0  # by how much the limit does over the factor
    for _ in range(_TRIES):
        if limit - factor <= _NEAR * factor:
            bracket = _bracket(factor, limit, moves, most)
            return SlipFactor(limit, STEPS, bracket=bracket, loaded=factor)
        if factor > MOST:
            break
        tried = factor + way * (limit - factor) if near is None else near
        found = growth.limit_at(tried)
        if found is None:
            way = way / 2 if near is None else way
            near = None
            continue
        near = None
        moves = (min(found, most) - limit) / (tried - factor)
        factor, limit = tried, min(found, most)
    return SlipFactor()


def _bracket(factor: float, limit: float, moves: float, most: float) -> float | None:
    """How far parts may slip before or after a limit; None if that cannot be told.

    Before: the loads hold up to the factor. After: where the limit L grows with the factor f, as
    more and more points slide, L − f closes as a power of what is left, at most the square of it;
    then f ends at f + 2 (L − f)/(1 − L′). No pressures allow more than the bound.

    Args:
        factor: That was reached.
        limit: By the pressures there.
        moves: L′, by the last two.
        most: The bound.
    """
    beyond = (limit - factor) * (1 + moves) / (1 - moves) if moves < 1 else np.inf
    found = float(max(limit - factor, min(beyond, most - limit)))
    return found if np.isfinite(found) else None
