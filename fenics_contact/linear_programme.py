"""Linear programmes, by SciPy's HiGHS."""

from __future__ import annotations

from typing import Any

# Of SciPy: neither solved, nor found infeasible or unbounded.
_NUMERICAL_DIFFICULTIES = 4


def minimised(cost: Any, **given: Any) -> Any:
    """As ``scipy.optimize.linprog``; by interior points where the simplex method gives up.

    Older versions of HiGHS do, now and then, on programmes with many nearly parallel rows.
    """
    from scipy.optimize import linprog

    found = linprog(cost, **given)
    if found.status == _NUMERICAL_DIFFICULTIES:
        found = linprog(cost, method="highs-ipm", **given)
    return found
