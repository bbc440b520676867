"""What ``result.json`` tells of how sure a quantity is, by its numbers and by the mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from fenics_contact.results.records.record import Record


@dataclass(frozen=True, eq=False, kw_only=True)
class Uncertainty(Record):
    """How far a quantity may be off, by the tolerances of the scene and by its discretisation.

    Attributes:
        data: By all tolerances together, as independent ones: the root of the sum of squares; null
            where a derivative is not known.
        data_at_most: The same where all conspire: the sum.
        by: Key of the scene → what its tolerance alone makes of the quantity.
        numerical: The error bar of the run, null where it was not estimated.
        larger: Whether `"data"` or `"mesh"` makes more of it; null where one is not known.
    """

    data: float | None
    data_at_most: float | None
    by: Mapping[str, float | None]
    numerical: float | None
    larger: Literal["data", "mesh"] | None
