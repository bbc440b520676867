"""The end of a cycle that wears, where most of them are passed over, in ``result.json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fenics_contact.results.records.record import Quantities, Record


@dataclass(frozen=True, eq=False, kw_only=True)
class WornCycleEnd(Record):
    """Result of a cycle that wears, where most of them are passed over.

    Attributes:
        passed_over: How many cycles before it were not computed, since the last one that was.
        pressure_change: Largest change of a pressure since then, over the largest pressure.
        depth_over_width: Deepest wear over half the width that is worn, about a slope; beyond .1
            the linear theory of gaps ends.
        stick_areas: Name of a contact → what touched in the cycle and never slipped (area).
        losses: Name of a contact → what friction dissipates there in the cycle (energy).
        errors: `worn_volume` and `max_wear_depth` → estimated absolute error of all jumps so far
            (volume, length).
    """

    passed_over: int
    pressure_change: float
    depth_over_width: float
    stick_areas: Quantities
    losses: Quantities
    errors: Mapping[str, float]
