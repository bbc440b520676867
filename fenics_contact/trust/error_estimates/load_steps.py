"""Errors by the load steps, where the answer depends on them: friction that remembers its path.

The load is applied again in other steps; of n steps the error is c/n at the leading order. Of
many steps every other one is left out, then the others: as points of the surface come to touch one
by one, histories with some times in common may be nearer to each other than to the truth. Of one
or two steps between turns of the loads each is cut, in two and in three.

A history in far fewer load steps, near which others are found at little cost. What the mesh, ε₁
and ε do to an answer that remembers its path they do along all of it, but not otherwise if its
steps are larger. So the load steps are taken once more, about a fifth as many, and from each of
their ends the answer with less of an error is a few steps of Newton's method away. How far the
larger steps themselves lead away tells the error by the steps: a step of length h makes one of the
order h², so that of a path is in proportion to the sum of these.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from fenics_contact.solve.coulomb.strategies import solve_step
from fenics_contact.solve.load_steps.accepted_step import AtEachStep, StepEnd, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Change,
    Look,
    Measure,
    Quantities,
    differences,
    seen,
    steps_again,
)

# Of so many load steps between two turns of the loads one is left, and so many of these at the
# least, if there are more than that.
_OF, _LEAST = 5, 2
# Of the history's load steps, at the most: with more, bars would cost more than it did.
_MOST = 0.7

# Pseudo-times of load steps, in parts that end where the loads turn.
Parts = Sequence[Sequence[float]]
Errors = dict[Hashable, float]


class CoarseHistory:
    """The load steps again in fewer; collective.

    Args:
        load_steps: At their end, with the ends of their steps.
        measure: Quantities of a solution, called in its state; collective.
        parts: Of the history.
    """

    def __init__(self, load_steps: LoadSteps, measure: Measure, parts: Parts) -> None:
        assert load_steps.last is not None
        self._load_steps, self._measure, self._parts = load_steps, measure, parts
        self._answer = measure(load_steps.last.solution)
        self._first, self._ends = load_steps.ends or {}, dict[float, StepEnd]()
        self._coarse = [_thinned(part) for part in parts]
        self._displacement = load_steps.last.solution.displacement
        self._found = self._along(self._coarse, self._first, kept=self._ends, look=self._keep)

    @staticmethod
    def pays(parts: Parts) -> bool:
        """Whether it has so few load steps that solving it several times costs little."""
        return sum(len(_thinned(part)) for part in parts) <= _MOST * sum(map(len, parts))

    @property
    def again(self) -> Again | None:
        """How it is solved with something changed; None where it does not come to its end."""
        if self._found is None:
            return None
        every, own = (sum(map(len, parts)) for parts in (self._parts, self._coarse))
        return Again(
            self._found,
            self._displacement,
            lambda change, look: self._along(self._coarse, self._ends, change, look=look),
            every / own,
            walk=lambda visit: self._along(self._coarse, self._ends, listener=AtEachStep(visit)),
        )

    def _keep(self, solution: Solution) -> None:
        self._displacement = solution.displacement.copy()

    def step_errors(self) -> Errors | None:
        """Estimated errors of the history by its load steps; collective.

        Returns:
            By quantity: absolute, of vectors the length of the difference; None where no path with
            fewer steps came to its end, or one with single steps cut did not.
        """
        paths = [self._coarse]
        answers = [self._found]
        shifted = [_thinned(part, 0.5) for part in self._parts]
        if shifted != self._coarse:
            paths.append(shifted)
            answers.append(self._along(shifted, self._first))
        found = [
            errors
            for path, answer in zip(paths, answers, strict=True)
            if (errors := differences(self._answer, answer, self._share(path))) is not None
        ]
        if not found:
            return None
        safety = _SAFETY if len(found) > 1 else _SAFETY_OF_ONE
        known = [key for key in self._answer if all(key in errors for errors in found)]
        every = {key: safety * max(errors[key] for errors in found) for key in known}
        return every if all(len(part) > 1 for part in self._parts) else self._with_single(every)

    def _share(self, path: Parts) -> float:
        """Return the errors of the history over a difference of two answers."""
        begins = [0.0, *(part[-1] for part in self._parts)]
        growths = [
            _squares(begin, other) / _squares(begin, part)
            for begin, part, other in zip(begins, self._parts, path, strict=False)
            if len(other) != len(part)
        ]
        return 1 / (min(growths) - 1)

    def _with_single(self, errors: Errors) -> Errors | None:
        """With those of single steps between turns, of which none is left out but each cut."""
        begins = [0.0, *(part[-1] for part in self._parts)]
        halved = [
            [(begin + part[0]) / 2, *part] if len(part) == 1 else coarse
            for begin, part, coarse in zip(begins, self._parts, self._coarse, strict=False)
        ]
        assert self._found is not None
        more = differences(self._found, self._along(halved, self._ends), 2 * _SAFETY)
        if more is None:
            return None
        return {key: error + more[key] for key, error in errors.items() if key in more}

    def _along(
        self,
        parts: Parts,
        near: Mapping[float, StepEnd],
        change: Change | None = None,
        kept: dict[float, StepEnd] | None = None,
        listener: StepListener | None = None,
        look: Look | None = None,
    ) -> Quantities | None:
        """Quantities at the end of other load steps, which begin at known ends; collective."""
        times = [time for part in parts for time in part]
        path = _NearPath(times, near)
        calls = (change, path.solve, kept, listener)
        return steps_again(self._load_steps, seen(self._measure, look), times, *calls)


class _NearPath:
    """Load steps that begin as far from the ends of others as the last one ended from its own.

    Args:
        times: Their pseudo-times.
        ends: Of the others, by their pseudo-times.
    """

    def __init__(self, times: Sequence[float], ends: Mapping[float, StepEnd]) -> None:
        self._times, self._ends = times, ends
        self._done = 0

    def solve(self, newton: Newton) -> Solution:
        """The present load step, from its beginning; collective.

        Raises:
            NotConvergedError: In words, with the history of the force imbalance.
        """
        number, problem = self._done, newton.problem
        self._done += 1
        end = self._ends.get(self._times[number])
        if end is None:
            if number:
                newton.begin.from_last_step()
            else:
                newton.begin.anew()
            return solve_step(newton)
        end.begin(newton, self._ends.get(self._times[number - 1]) if number else None)
        for contact in problem.coulomb:
            contact.friction_term.follow_pressure()
        newton.run(False if problem.coulomb else None)
        return newton.solution()


def _thinned(part: Sequence[float], shift: float = 0.0) -> list[float]:
    """Pseudo-times between two turns, of which a few are left, evenly.

    Args:
        part: All of them.
        shift: Of a step, by which all those left but the last one are earlier.
    """
    every = len(part)
    count = min(max(math.ceil(every / _OF), _LEAST), max(every - 1, 1))
    ends = np.rint(every * (np.arange(1, count) - shift) / count).astype(int) - 1
    return [part[number] for number in sorted({*np.maximum(ends, 0).tolist(), every - 1})]


def _squares(begin: float, times: Sequence[float]) -> float:
    """Sum of the squares of load steps."""
    return float(np.sum(np.diff([begin, *times]) ** 2))


# Steps between turns from which half of them say something.
_ENOUGH = 3
# For what is not the leading order (P. J. Roache, J. Fluids Eng. 116 (1994) 405-413, and later);
# and where no other path confirms one, or did not come to its end.
_SAFETY, _SAFETY_OF_ONE = 1.25, 3.0
# Of two pseudo-times that are the same.
_SAME = 1e-9


def step_errors(
    load_steps: LoadSteps, measure: Measure, parts: Sequence[Sequence[float]]
) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by the steps; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.
        parts: Pseudo-times of the steps as they were accepted, ``between_turns``.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where no path with
        other steps came to its end.
    """
    assert load_steps.last is not None
    answer = measure(load_steps.last.solution)
    others = _other_steps(parts)
    count = sum(map(len, parts))
    found: list[dict[Hashable, float]] = []
    for other in others:
        factor = 1 / abs(count / len(other) - 1)
        errors = differences(answer, steps_again(load_steps, measure, other), factor)
        if errors is not None:
            found.append(errors)
    if not found:
        return None
    safety = _SAFETY if len(found) == len(others) else _SAFETY_OF_ONE
    known = [name for name in answer if all(name in errors for errors in found)]
    return {name: safety * max(errors[name] for errors in found) for name in known}


def _other_steps(parts: Sequence[Sequence[float]]) -> list[list[float]]:
    """Pseudo-times of the steps to compare with.

    Args:
        parts: Those of the path, between turns of the loads.
    """
    if any(len(part) < _ENOUGH for part in parts):
        return [_cut([time for part in parts for time in part], pieces) for pieces in (2, 3)]
    left_out = [
        [time for part in parts for time in sorted({*part[first::2], part[-1]})] for first in (0, 1)
    ]
    return left_out if left_out[0] != left_out[1] else left_out[:1]


def between_turns(times: Sequence[float], turns: Sequence[float]) -> list[list[float]]:
    """Pseudo-times in parts, which end with the first at or beyond each turn of a load path.

    Args:
        times: Of all load steps, increasing.
        turns: Of the loads.
    """
    last = times[-1] * (1 - _SAME)
    ends = [np.searchsorted(np.asarray(times) * (1 + _SAME), t) for t in turns if 0 < t < last]
    cuts = sorted({0, len(times), *(int(end) + 1 for end in ends)})
    return [list(times[a:b]) for a, b in pairwise(cuts)]


def _cut(times: Sequence[float], pieces: int) -> list[float]:
    """Each step in equal pieces."""
    begins = [0.0, *times[:-1]]
    shares = np.arange(1, pieces + 1) / pieces
    return [
        float(begin + share * (end - begin))
        for begin, end in zip(begins, times, strict=True)
        for share in shares
    ]
