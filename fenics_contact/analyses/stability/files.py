"""The table that a run writes of modes over the friction coefficient."""

from __future__ import annotations

from fenics_contact.analyses.stability.record import StabilityRecord
from fenics_contact.results.result import Result


def tables(result: Result) -> dict[str, list[list[str]]]:
    """Rows of ``stability.csv``, its header first.

    Args:
        result: Of a run that looked at steady sliding.
    """
    found = result.stability
    return {"stability.csv": curve_rows(found)} if found is not None and found.curve else {}


def curve_rows(found: StabilityRecord) -> list[list[str]]:
    """The rows of ``stability.csv``, its header first: one a coefficient and mode.

    Args:
        found: With a curve.
    """
    rows = [["friction_coefficient", "mode", "frequency", "growth_rate"]]
    for point in found.curve:
        pairs = zip(point.frequencies, point.growth_rates, strict=True)
        for number, (frequency, rate) in enumerate(pairs, start=1):
            values = (point.friction_coefficient, frequency, rate)
            coefficient, *numbers = (repr(float(value)) for value in values)
            rows.append([coefficient, str(number), *numbers])
    return rows
