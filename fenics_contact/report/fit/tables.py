"""Numbers of a fit in words, with their units."""

from __future__ import annotations

from fenics_contact.quantities.table import MEASURED_BY_PRELOADS, measured_by
from fenics_contact.report.sweep.columns import unit_of_key
from fenics_contact.results.fit_record import FitRecord
from fenics_contact.results.words.rounding import bar_in_words, rounded
from fenics_contact.scene.values import AXES

TIME = "time"


def measured_as(name: str) -> str:
    """Return the dimension of a quantity by its name; empty for others.

    >>> measured_as("top.friction_force_x"), measured_as("time")
    ('force', '')
    """
    owner, _, quantity = name.rpartition(".")
    if quantity[-2:-1] == "_" and quantity[-1] in AXES:
        quantity = quantity[:-2]
    if owner and quantity in MEASURED_BY_PRELOADS:
        return MEASURED_BY_PRELOADS[quantity]
    return measured_by(quantity)


def interval_in_words(record: FitRecord, key: str) -> str:
    """A value and its interval, such as ``0.299, 95 %: 0.295 to 0.303``.

    Args:
        record: Of the fit.
        key: Of the parameter.
    """
    found, unit = record.parameters[key], unit_of_key(key, record.units)
    unit = f" {unit}" if unit else ""
    if found.low is None or found.high is None:
        return f"{found.value:.6g}{unit}, not determined by the data"
    half = max(found.high - found.value, found.value - found.low)
    value = rounded(found.value, {"total": half})[0]
    ends = [rounded(end, {"total": half / 10})[0] for end in (found.low, found.high)]
    return f"{value}{unit}, {record.confidence:.0%}: {ends[0]} to {ends[1]}{unit}"


def parameter_rows(record: FitRecord) -> list[list[str]]:
    """A row a parameter, after one of heads.

    Args:
        record: Of the fit.
    """
    head = ["parameter", "value and interval", "by the noise", "by mesh, ε₁ and ε", "start"]
    rows = [
        [
            key,
            interval_in_words(record, key),
            _part(one.noise),
            _part(one.discretisation),
            f"{one.start:.6g}",
        ]
        for key, one in record.parameters.items()
    ]
    return [head, *rows]


def _part(half: float | None) -> str:
    words = bar_in_words(half)
    return words if half is None else f"± {words}"


def correlation_rows(record: FitRecord) -> list[list[str]]:
    """A row a parameter, after one of heads.

    Args:
        record: Of the fit.
    """
    keys = list(record.parameters)
    rows = zip(keys, record.correlations, strict=True)
    return [["", *keys], *([key, *(f"{one:.3f}" for one in row)] for key, row in rows)]
