"""How near parts are to slipping as a whole."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fenics_contact.results.records.record import Record


@dataclass(frozen=True, eq=False, kw_only=True)
class SlipLimitRecord(Record):
    """How much friction there is against rigid slip, and how much of it is used.

    Attributes:
        parts: Part → how much of what friction can hold of it is used, all its contacts together
            and the other parts at rest, 0 … 1; null where supports hold it, or where no motion
            that they leave slips along all that touches.
        motion: The motion, of one part or several, against which most of it is used, in words;
            empty where there is none.
    """

    parts: Mapping[str, float | None]
    motion: str = ""
