"""Errors by the load steps, where the answer depends on them: friction that remembers its path.

The load is applied again in other steps; of n steps the error is c/n at the leading order. Of
many steps every other one is left out, then the others: as points of the surface come to touch one
by one, histories with some times in common may be nearer to each other than to the truth. Of one
or two steps between turns of the loads each is cut, in two and in three.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise

import numpy as np

from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.solving_again import Measure, differences, steps_again

# Steps between turns from which half of them say something.
_ENOUGH = 3
# For what is not the leading order (P. J. Roache, J. Fluids Eng. 116 (1994) 405-413, and later);
# and where the path that was to confirm another one did not come to its end.
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
