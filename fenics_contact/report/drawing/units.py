"""Units in pictures: what axes, bars of colours, legends and captions say where a run has units."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from fenics_contact.results.records.record import UnitsRecord

_units: ContextVar[UnitsRecord | None] = ContextVar("units of the run that is drawn", default=None)


@contextmanager
def in_units(units: UnitsRecord | None) -> Iterator[None]:
    """Within it, what is drawn bears the units of a run, if it has some.

    Args:
        units: Of its ``result.json``.
    """
    before = _units.set(units)
    try:
        yield
    finally:
        _units.reset(before)


def unit_of(measured: str) -> str:
    """The unit of what is measured, such as ``stress``; empty where the run has no units."""
    units = _units.get()
    return "" if units is None else units.of(measured)


def labelled(words: str, measured: str) -> str:
    """Return the label of an axis or colour bar, with its unit in brackets, if the run has one.

    Args:
        words: Such as ``contact pressure``.
        measured: Such as ``stress``.
    """
    unit = unit_of(measured)
    return f"{words} ({unit})" if unit else words


def with_unit(value: float | str, measured: str) -> str:
    """A number and its unit, if the run has one.

    Args:
        value: In words, or it is written with four digits.
        measured: What it measures.
    """
    unit, number = unit_of(measured), value if isinstance(value, str) else f"{value:.4g}"
    return f"{number} {unit}" if unit else number
