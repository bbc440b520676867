"""What several checks share: the worst of many, and tolerances of round-off."""

from __future__ import annotations

from fenics_contact.result import Check

# Round-off of traces, beside the imbalance that the solver accepted.
TRACE = 1e-6


def nearer_to_failing(first: Check | None, second: Check) -> Check:
    """The one that fails, is not a number, or uses more of its limit."""
    if first is None:
        return second
    if first.value != first.value:
        return first
    return first if second.value / second.limit <= first.value / first.limit else second
