"""A run's curve or quantity as a function of numbers of its scene, with derivatives.

Between load steps a curve is straight. Over a quantity its rows are found on it in the order in
which they were measured, from one turning point to the next: so a loop has its two branches.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.results.result import Check
from fenics_contact.simulation.fits.measured import TIME, Measured
from fenics_contact.simulation.studies.solved_history import History
from fenics_contact.simulation.studies.study import Study
from fenics_contact.simulation.sweeps.rows import row_of_step

# A curve turns where it goes back by more than this share of its width; noise goes less far.
_TURN = 0.05
# Rows may lie beyond the ends of a branch by so much of its width, where it goes on straight.
_BEYOND = 0.05


@dataclass(frozen=True, eq=False)
class CurveAnswer:
    """Answer of a run at the rows of a curve.

    Attributes:
        values: (rows,).
        slopes: Derivatives in the parameters, (rows, parameters).
        errors: Source → what it is estimated to change, (draws, rows).
        checks: Of the physics, of every run that was made.
    """

    values: Array
    slopes: Array
    errors: Mapping[str, Array] = field(default_factory=dict)
    checks: Sequence[Mapping[str, Check]] = ()


class Curve(Protocol):
    """A measured curve that a study can be asked along."""

    def answer(self, study: Study, values: Mapping[str, float], is_judged: bool) -> CurveAnswer:
        """Solve the scene with values of the parameters; collective.

        Args:
            study: Of the scene.
            values: Key → value.
            is_judged: Whether to check the physics and to estimate errors.

        Raises:
            InputError: The scene cannot have such values, has no equilibrium with them, or the
                curve does not reach the rows.
            NotConvergedError: There is no answer.
        """


def curve_of(measured: Measured, study: Study) -> Curve:
    """Return the kind of curve by which answers at the rows are found.

    Args:
        measured: The rows.
        study: Whose scene is solved.
    """
    if measured.over == (TIME,):
        return _OverTime(measured)
    try:
        study.scene.names.find(measured.over[0])
    except ValueError:
        return _OverKeys(measured)
    return _OverQuantity(measured)


class _OverTime:
    """One history; the rows are at pseudo-times."""

    def __init__(self, measured: Measured) -> None:
        self._measured = measured

    def answer(self, study: Study, values: Mapping[str, float], is_judged: bool) -> CurveAnswer:
        of = [self._measured.quantity]
        history = study.history(of, list(values), values, is_judged)
        times = np.array([step.load_factor for step in history.steps])
        at = self._measured.at[:, 0]
        self._require_reached(times, at)
        upper = np.clip(np.searchsorted(times, at), min(1, len(times) - 1), len(times) - 1)
        lower = np.maximum(upper - 1, 0)
        length = np.where(upper > lower, times[upper] - times[lower], 1.0)
        share = (at - times[lower]) / length

        def along(quantities: Array) -> Array:
            y = quantities[:, 0]
            return np.asarray((1 - share) * y[lower] + share * y[upper])

        return _answer(history, along(_values(history, of)), along)

    def _require_reached(self, times: Array, at: Array) -> None:
        close = 1e-9 * max(abs(times[-1]), 1e-300)
        outside = np.flatnonzero((at < times[0] - close) | (at > times[-1] + close))
        if len(outside):
            row = int(outside[0])
            raise InputError(
                f"{self._measured.source}: row {row + 1}: time {at[row]:g} is not between those of "
                f"the load steps, {times[0]:g} and {times[-1]:g}; leave the row out, or change "
                "steps"
            )


class _OverQuantity:
    """One history; the rows are where another quantity has its measured values."""

    def __init__(self, measured: Measured) -> None:
        self._measured = measured
        self._branches = branches(measured.at[:, 0])

    def answer(self, study: Study, values: Mapping[str, float], is_judged: bool) -> CurveAnswer:
        measured = self._measured
        of = [measured.over[0], measured.quantity]
        history = study.history(of, list(values), values, is_judged)
        found = _values(history, of)
        x, y = found.T
        lower = self._segments(x, y)
        upper = lower + 1
        length = x[upper] - x[lower]
        share = (measured.at[:, 0] - x[lower]) / length
        steepness = (y[upper] - y[lower]) / length

        def at_rows(y: Array) -> Array:
            return np.asarray((1 - share) * y[lower] + share * y[upper])

        def along(changes: Array) -> Array:  # at a place that itself moves
            return np.asarray(at_rows(changes[:, 1]) - steepness * at_rows(changes[:, 0]))

        return _answer(history, at_rows(y), along)

    def _segments(self, x: Array, y: Array) -> Integers:
        """The load step behind which each row lies, (rows,).

        A row at a turning point of the data may be on either branch: it is on the nearer one.
        """
        ours, theirs = branches(x), self._branches
        name, source = self._measured.over[0], self._measured.source
        if len(ours) != len(theirs):
            raise InputError(
                f"{source}: '{name}' turns {len(theirs) - 1} times in the data, and "
                f"{len(ours) - 1} times in the run; measure and solve the same path, or give the "
                f"curve over {TIME}"
            )
        found: dict[int, int] = {}
        for (first, last), (start, end) in zip(theirs, ours, strict=True):
            for row in range(first, last + 1):
                value = self._measured.at[row, 0]
                place = _segment(x, start, end, value)
                if place is None:
                    raise InputError(
                        f"{source}: row {row + 1}: {name} = {value:g}: there the run goes from "
                        f"{x[start]:g} to {x[end]:g}; leave the row out, or let the run go further"
                    )
                known = found.get(row, place)
                apart = [
                    abs(_between(x, y, one, value) - self._measured.values[row])
                    for one in (known, place)
                ]
                found[row] = place if apart[1] < apart[0] else known
        return np.array([found[row] for row in range(len(self._measured))])


def _between(x: Array, y: Array, place: int, value: float) -> float:
    """A curve on the straight line behind a place."""
    share = (value - x[place]) / (x[place + 1] - x[place])
    return float((1 - share) * y[place] + share * y[place + 1])


def _segment(x: Array, start: int, end: int, value: float) -> int | None:
    """The first segment of a branch that a value is on, or the end that is a little before it."""
    lengths = np.diff(x[start : end + 1])
    usable = np.flatnonzero(lengths) + start
    if not len(usable):
        return None
    for place in usable:
        if min(x[place], x[place + 1]) <= value <= max(x[place], x[place + 1]):
            return int(place)
    if min(abs(value - x[start]), abs(value - x[end])) > _BEYOND * abs(x[end] - x[start]):
        return None
    return int(usable[0] if abs(value - x[start]) < abs(value - x[end]) else usable[-1])


def branches(x: Array) -> list[tuple[int, int]]:
    """First and last place of each part of a path that does not turn; ends are in both parts.

    Args:
        x: Along the path.

    >>> branches(np.array([0.0, 1.0, 2.0, 1.99, 2.0, 0.0, -2.0, 0.0]))
    [(0, 2), (2, 6), (6, 7)]
    """
    limit = _TURN * float(np.ptp(x))
    turns, best, sign = [], 0, 0.0
    for place in range(1, len(x)):
        moved = x[place] - x[best]
        if sign == 0.0:
            sign, best = (np.sign(moved), place) if abs(moved) > limit else (0.0, best)
        elif sign * moved > 0:
            best = place
        elif sign * moved < -limit:
            turns.append(best)
            best, sign = place, -sign
    starts, ends = [0, *turns], [*turns, len(x) - 1]
    return list(zip(starts, ends, strict=True))


class _OverKeys:
    """A run a row, with the row's values of keys of the scene, as of a sweep."""

    def __init__(self, measured: Measured) -> None:
        self._measured = measured

    def answer(self, study: Study, values: Mapping[str, float], is_judged: bool) -> CurveAnswer:
        measured, of = self._measured, [self._measured.quantity]
        parts = []
        for row in measured.at:
            given = dict(zip(measured.over, row.tolist(), strict=True))
            history = study.history(
                of, list(values), {**given, **values}, is_judged, is_whole=False
            )
            value = _values(history, of)[-1:, 0]
            parts.append(_answer(history, value, lambda changes: np.asarray(changes[-1:, 0])))
        names = list(parts[0].errors)
        return CurveAnswer(
            np.concatenate([part.values for part in parts]),
            np.concatenate([part.slopes for part in parts]),
            {name: np.concatenate([p.errors[name] for p in parts], axis=1) for name in names},
            [checks for part in parts for checks in part.checks],
        )


def _values(history: History, of: Sequence[str]) -> Array:
    """Quantities of all load steps, (steps, quantities).

    Raises:
        InputError: A step has none of them.
    """
    rows = [row_of_step(step) for step in history.steps]
    for name in of:
        for row, step in zip(rows, history.steps, strict=True):
            if row.get(name) is None:
                raise InputError(f"the run has no {name} at time {step.load_factor:g}")
    return np.array([[row[name] for name in of] for row in rows], dtype=np.float64)


def _answer(history: History, values: Array, along: Callable[[Array], Array]) -> CurveAnswer:
    """At the rows, of a history.

    Args:
        history: With derivatives and errors.
        values: At the rows.
        along: From changes of the quantities, (steps, quantities), to those at the rows.
    """
    slopes = [along(slope) for slope in history.slopes.values()]
    return CurveAnswer(
        values,
        np.stack(slopes, axis=1) if slopes else np.zeros((len(values), 0)),
        {
            source: np.array([along(draw) for draw in draws])
            for source, draws in history.errors.items()
        },
        [history.checks] if history.checks else [],
    )


class Objective:
    """A quantity of a study's answers, and its exact derivatives; collective.

    Attributes:
        of: Name of the quantity.
        by: Keys of the numbers.
        evaluations: How many answers were asked for.

    Args:
        study: Whose answers.
        of: Name of the quantity.
        by: Keys of the numbers, in the order in which they are passed.
        changes: What else is not as in the scene.
    """

    def __init__(
        self, study: Study, of: str, by: Sequence[str], changes: Mapping[str, Any] | None = None
    ) -> None:
        self._study, self._changes = study, dict(changes or {})
        self.of, self.by = of, tuple(by)
        self.evaluations = 0

    def __call__(self, values: ArrayLike) -> tuple[float, Array]:
        """The quantity, and its gradient in the numbers; collective.

        Args:
            values: The numbers, in the order of ``by``.

        Raises:
            InputError: There are not as many numbers; or as of ``Study.derivatives``.
            NotConvergedError: There is no answer.
        """
        numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
        if numbers.shape != (len(self.by),):
            raise InputError(
                f"objective: {numbers.size} values were passed for {len(self.by)} numbers: "
                + ", ".join(self.by)
            )
        changes = self._changes | dict(zip(self.by, numbers.tolist(), strict=True))
        history = self._study.history([self.of], self.by, changes, is_whole=False)
        self.evaluations += 1
        found = row_of_step(history.steps[-1]).get(self.of)
        if found is None:
            raise InputError(f"objective: the answer has no {self.of}")
        return found, np.array([history.slopes[key][-1, 0] for key in self.by])
