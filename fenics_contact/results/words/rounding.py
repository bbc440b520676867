"""Values in as many figures as their error bars leave sure."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

from fenics_contact.quantities.names import STRAIN_ENERGY
from fenics_contact.quantities.table import QuantityValue, measured_by
from fenics_contact.results.records.contacts import ContactRecord
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


def sizes_of(quantities: Quantities, contacts: Iterable[ContactRecord]) -> Mapping[str, float]:
    """How large what is measured gets in a run: by this it is told what is round-off.

    Args:
        quantities: Of the whole model.
        contacts: Its contacts.

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
