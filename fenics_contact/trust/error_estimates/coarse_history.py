"""A history in far fewer load steps, near which others are found at little cost.

What the mesh, ε₁ and ε do to an answer that remembers its path they do along all of it, but not
otherwise if its steps are larger. So the load steps are taken once more, about a fifth as many,
and from each of their ends the answer with less of an error is a few steps of Newton's method away.
How far the larger steps themselves lead away tells the error by the steps: a step of length h makes
one of the order h², so that of a path is in proportion to the sum of these.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence

import numpy as np

from fenics_contact.solve.coulomb.strategies import solve_step
from fenics_contact.solve.load_steps.accepted_step import StepEnd
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Change,
    Look,
    Measure,
    Quantities,
    Visit,
    differences,
    seen,
    steps_again,
)

# Of so many load steps between two turns of the loads one is left, and so many of these at the
# least, if there are more than that.
_OF, _LEAST = 5, 2
# Of the history's load steps, at the most: with more, bars would cost more than it did.
_MOST = 0.7
# For what is not the leading order; and where no other path confirms it.
_SAFETY, _SAFETY_OF_ONE = 1.25, 3.0

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
            lambda visit: self._along(self._coarse, self._ends, visit=visit),
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
        visit: Visit | None = None,
        look: Look | None = None,
    ) -> Quantities | None:
        """Quantities at the end of other load steps, which begin at known ends; collective."""
        times = [time for part in parts for time in part]
        path = _NearPath(times, near)
        calls = (change, path.solve, kept, visit)
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
