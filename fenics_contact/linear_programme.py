"""Linear programmes, by SciPy's HiGHS."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# Of SciPy: neither solved, nor found infeasible or unbounded.
_NUMERICAL_DIFFICULTIES = 4

# What is tried in turn: method, and options besides those given.
_WAYS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("highs", {}),
    ("highs-ipm", {}),
    ("highs-ipm", {"presolve": False}),
    ("highs-ds", {"presolve": False}),
)


def minimised(cost: Any, options: Mapping[str, Any], **given: Any) -> Any:
    """As ``scipy.optimize.linprog``; by other methods where the first gives up.

    Older versions of HiGHS do, now and then, on programmes with many nearly parallel rows.
    """
    from scipy.optimize import linprog

    for method, more in _WAYS:
        found = linprog(cost, method=method, options={**options, **more}, **given)
        if found.status != _NUMERICAL_DIFFICULTIES:
            break
    return found
