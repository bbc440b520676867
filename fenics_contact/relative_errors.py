"""Estimated errors of a result over what measures its quantities."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fenics_contact.result import Result
from fenics_contact.scene_accuracy import MEASURED_BY

# By quantity, then by source, with their total; None where it is not estimated.
Errors = Mapping[str, Mapping[str, float | None]]


def relative_errors(result: Result, asked: Mapping[str, float]) -> Errors:
    """Of the quantities asked for, by source.

    Args:
        result: With ``errors``.
        asked: The quantities.
    """
    found: dict[str, dict[str, float | None]] = {}
    for name in asked:
        size = float(np.linalg.norm(result.quantities[MEASURED_BY.get(name, name)]))
        row = result.errors.get(name, {"mesh": None, "total": None})
        found[name] = {source: _over(error, size) for source, error in row.items()}
    return found


def others_than_mesh(found: Mapping[str, float | None]) -> dict[str, float]:
    """A quantity's errors by the other sources, of those that it has."""
    return {s: v for s, v in found.items() if s not in ("mesh", "total") and v}


def _over(error: float | None, size: float) -> float | None:
    """Relative; of what is nothing, any error is infinite."""
    if error is None or error == 0:
        return error
    return error / size if size > 0 else float("inf")


def is_met(errors: Errors, asked: Mapping[str, float]) -> bool:
    """Whether all are estimated and small enough."""
    totals = {name: found["total"] for name, found in errors.items()}
    return all(value is not None and value <= asked[name] for name, value in totals.items())
