"""Values in as many figures as their error bars leave sure, and differences in error bars.

Error bars are estimates of the whole error, not standard deviations, and those of two runs on
similar meshes are far from independent: they do not add up as squares. So differences are counted
in the sum of both bars: at 1 the two intervals just touch, and beyond it no value lies in both.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from fenics_contact.quantities.names import STRAIN_ENERGY
from fenics_contact.quantities.table import QuantityValue, measured_by
from fenics_contact.results.records.contacts import ContactRecord, ReactionRecord
from fenics_contact.results.records.record import ErrorRow, Quantities

#: In place of an error that was not estimated.
UNKNOWN = "?"
# Figures where nothing is known of the error.
_FIGURES = 6
# A bar that starts with these digits has two figures, else one: a rounded bar is never shorter,
# and longer by a quarter at the most.
_TWO_FIGURES_BELOW = 3.55
# What is below this share of the value, or of the forces at work, is round-off: no estimate.
_ROUND_OFF = 1e-8
# Decimal powers between which numbers are written without one.
_PLAIN = range(-4, 7)


def rounded(value: QuantityValue, row: ErrorRow | None, size: float = 0.0) -> tuple[str, str]:
    """A value and its error bar in words, such as ``4246`` and ``5``.

    Args:
        value: A number, or the components of a vector.
        row: Its errors by source and in ``total``, of vectors the length of the difference; None
            of what has none.
        size: What it adds up from, such as the largest force: less than round-off of this is 0.

    Returns:
        The bar is ``?`` where it was not estimated, or not in full; empty where the scene leaves
        no error but round-off, as of a force that is given.
    """
    parts = list(value) if isinstance(value, Sequence) else [value]
    scale = max(size, *map(abs, parts))
    parts = [0.0 if is_none(part, size) else part for part in parts]
    total = None if row is None else row["total"]
    if total is None:
        return _joined(f"{part:.{_FIGURES}g}" for part in parts), UNKNOWN
    if not total > _ROUND_OFF * scale:
        return _joined(f"{part:.{_FIGURES}g}" for part in parts), ""
    place, bar = _rounded_up(total)
    largest = max(bar, *map(abs, parts))
    return _joined(_written(part, place, largest) for part in parts), _written(bar, place, largest)


def is_none(value: QuantityValue, size: float) -> bool:
    """Whether a value is 0 up to round-off.

    Args:
        value: A number, or the components of a vector.
        size: As of ``rounded``.
    """
    parts = value if isinstance(value, Sequence) else [value]
    return all(abs(part) <= _ROUND_OFF * size for part in parts)


def bar_in_words(error: float | None) -> str:
    """An error alone, rounded up to one figure or two; ``?`` where it was not estimated.

    >>> bar_in_words(4.66), bar_in_words(0.00123), bar_in_words(0.0), bar_in_words(None)
    ('5', '0.0013', '0', '?')
    """
    if error is None or not math.isfinite(error):
        return UNKNOWN
    if error == 0:
        return "0"
    place, bar = _rounded_up(abs(error))
    return _written(bar, place, bar)


def sizes_of(
    quantities: Quantities, contacts: Iterable[ContactRecord | ReactionRecord]
) -> Mapping[str, float]:
    """Largest value of each quantity in a run: round-off is judged against it.

    Args:
        quantities: Of the whole model.
        contacts: Its contacts; or its supports.

    Returns:
        Of each that is measured, such as ``force``, the largest component; of lengths what the
        largest force moves with the energy that is stored.
    """
    found: dict[str, float] = defaultdict(float)
    for place in (quantities, *(contact.quantities for contact in contacts)):
        for name, value in place.items():
            parts = value if isinstance(value, list) else [0.0 if value is None else value]
            kind = measured_by(name)
            found[kind] = max(found[kind], *map(abs, parts))
    energy, force = quantities.get(STRAIN_ENERGY) or 0.0, found["force"]
    found.update({"": 0.0, "length": energy / force if force else 0.0})
    return found


def _rounded_up(bar: float) -> tuple[int, float]:
    """The decimal power of its last figure, and the bar in such figures."""
    place = _magnitude(bar)
    if bar / 10.0**place < _TWO_FIGURES_BELOW:
        place -= 1
    # What was rounded already is not to be rounded up again.
    return place, math.ceil(round(bar / 10.0**place, 6)) * 10.0**place


def _magnitude(number: float) -> int:
    return math.floor(math.log10(abs(number))) if number else 0


def _written(number: float, place: int, largest: float) -> str:
    """A number up to a decimal power, as numbers up to the largest are written."""
    unit = 10.0**place
    number = round(number / unit) * unit
    if not number:
        return "0"
    if _magnitude(largest) in _PLAIN:
        return f"{number:.{max(0, -place)}f}"
    return f"{number:.{max(0, _magnitude(number * (1 + 1e-12)) - place)}e}"


def _joined(words: Iterable[str]) -> str:
    return ", ".join("0" if word == "-0" else word for word in words)


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
