"""Errors by the load steps, where the answer depends on them: friction that remembers its path.

The history is solved again with about half as many steps; of n steps the error is c/n at the
leading order, so the difference is the error. A step or two between turns of the loads are too few
for that: then each step is cut in two and in four.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise

import numpy as np

from fenics_contact.load_paths import knots
from fenics_contact.load_steps import History
from fenics_contact.solving_again import Measure, differences, history_again

# Steps between turns from which half of them say something.
_ENOUGH = 3
# For what is not the leading order (P. J. Roache, J. Fluids Eng. 116 (1994) 405-413, and later).
_SAFETY = 1.25
# Of two pseudo-times that are the same.
_SAME = 1e-9
# By how much a difference falls when steps are cut in two, at the most that is believed: far from
# the leading order it may not fall at all.
_SLOWEST = 0.75


def step_errors(
    history: History, measure: Measure, times: Sequence[float]
) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by the steps; collective.

    Args:
        history: At its end; it is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.
        times: Pseudo-times of the steps as they were accepted.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the history with
        other steps did not come to its end.
    """
    assert history.last is not None
    answer = measure(history.last.solution)
    parts = _between_turns(times, knots(history.problem.scene))
    if all(len(part) >= _ENOUGH for part in parts):
        fewer = [time for part in parts for time in part[::-2][::-1]]
        factor = _SAFETY * max(((len(part) + 1) // 2) / (len(part) // 2) for part in parts)
        return differences(answer, history_again(history, measure, fewer), factor)
    halves = history_again(history, measure, _cut(times, 2))
    quarters = history_again(history, measure, _cut(times, 4))
    if halves is None or quarters is None:
        return None
    first, second = differences(answer, halves), differences(halves, quarters)
    assert first is not None and second is not None
    return {name: _of_all_cuts(first[name], second[name]) for name in first}


def _between_turns(times: Sequence[float], turns: Sequence[float]) -> list[list[float]]:
    """Pseudo-times in parts, which end with the first at or beyond each turn of a load path."""
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


def _of_all_cuts(first: float, second: float) -> float:
    """The sum of all differences that further cuts would make, each smaller by the same ratio."""
    ratio = second / first if first > 0 else 0.0
    if ratio > _SLOWEST:
        return max(first, second) / (1 - _SLOWEST)
    return first / (1 - ratio)
