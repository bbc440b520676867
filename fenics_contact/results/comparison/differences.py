"""How far a quantity of a run is from that of another, and by how many error bars.

Error bars are estimates of the whole error, not standard deviations, and those of two runs on
similar meshes are far from independent: they do not add up as squares. So differences are counted
in the sum of both bars: at 1 the two intervals just touch, and beyond it no value lies in both.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fenics_contact.quantities.table import QuantityValue
from fenics_contact.results.records.record import ErrorRow
from fenics_contact.results.words.rounding import UNKNOWN, is_none, rounded

#: In place of a number of bars where neither value has an error but round-off.
NO_BARS = "∞"
NOT_COMPARABLE = "not comparable"


@dataclass(frozen=True)
class Estimate:
    """A quantity of a run.

    Attributes:
        value: None where it has none.
        errors: By source and in ``total``; None where they were not estimated.
        reason: Why there is no value, in words.
        has_bar: Whether it has a true value, to be apart from.
    """

    value: QuantityValue | None
    errors: ErrorRow | None = None
    reason: str = ""
    has_bar: bool = True

    def words(self, size: float) -> str:
        """The value with its bar, in as many figures as that leaves sure.

        Args:
            size: What it adds up from: less than round-off of this is 0.
        """
        if self.value is None:
            return self.reason or "none"
        said, bar = rounded(self.value, self.errors, size)
        return f"{said} ± {bar}" if bar and self.has_bar else said


@dataclass(frozen=True)
class Difference:
    """Difference of a quantity between two runs.

    Attributes:
        words: Second less first, component by component.
        share: Its size over that of the first, in words; empty where that is 0.
        bars: Its size over the sum of both error bars, in words; ``?`` where one is missing.
        count: The same as a number; None where it is not known.
        is_there: Whether it is more than round-off.
    """

    words: str
    share: str
    bars: str
    count: float | None
    is_there: bool

    @property
    def is_beyond_bars(self) -> bool:
        """Whether the two intervals are apart."""
        return self.is_there and self.count is not None and self.count > 1


def difference(first: Estimate, second: Estimate, size: float) -> Difference:
    """How far the second value is from the first.

    Args:
        first: Of a run.
        second: Of another.
        size: What both add up from.

    >>> found = difference(Estimate(10.0, {"total": 0.5}), Estimate(12.0, {"total": 1.5}), 0.0)
    >>> found.words, found.share, found.bars
    ('2.0', '20 %', '1')
    >>> difference(Estimate(10.0, {"total": None}), Estimate(12.0, {"total": 1.5}), 0.0).bars
    '?'
    """
    if first.value is None or second.value is None:
        same = first.value is None and second.value is None and first.reason == second.reason
        return Difference("", "", "", None, not same)
    one, other = _parts(first.value), _parts(second.value)
    if len(one) != len(other):
        return Difference(NOT_COMPARABLE, "", UNKNOWN, None, True)
    apart = [b - a for a, b in zip(one, other, strict=True)]
    length, whole = math.hypot(*apart), math.hypot(*one)
    scale = max(size, *map(abs, (*one, *other)))
    if is_none(apart, scale):
        return Difference("0", "", "0" if first.has_bar else "", 0.0, False)
    total = _sum_of_bars(first, second)
    row = None if total is None else {"total": total}
    words = rounded(apart if len(apart) > 1 else apart[0], row, size)[0]
    share = "" if is_none(whole, scale) else f"{_in_two_figures(100 * length / whole)} %"
    if not first.has_bar:
        return Difference(words, share, "", None, True)
    if total is None:
        return Difference(words, share, UNKNOWN, None, True)
    if is_none(total, scale):
        return Difference(words, share, NO_BARS, math.inf, True)
    count = length / total
    return Difference(words, share, _in_two_figures(count), count, True)


def _in_two_figures(number: float) -> str:
    """Return a number in two figures, large ones in more, so that there is no power of ten."""
    return f"{number:.2g}" if number < 100 else f"{number:.0f}"


def _parts(value: QuantityValue) -> list[float]:
    return list(value) if isinstance(value, Sequence) else [value]


def _sum_of_bars(first: Estimate, second: Estimate) -> float | None:
    """None where one is not known."""
    bars = [None if one.errors is None else one.errors["total"] for one in (first, second)]
    known = [bar for bar in bars if bar is not None]
    return sum(known) if len(known) == len(bars) else None
