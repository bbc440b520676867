"""Rows of ``sweep.csv``: numbers of an answer by the names of quantities."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fenics_contact.quantities.table import MEASURED_BY_PRELOADS
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.quantities import reactions_by_name
from fenics_contact.results.records.contacts import PreloadRecord, SupportRecord
from fenics_contact.results.records.record import Errors
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Result
from fenics_contact.scene.values import AXES
from fenics_contact.simulation.studies.quick_answers import Answer

#: What the name of an error bar ends in.
BAR = "_error"
# Numbers of the statuses in ``states.npz``.
_STATUS = {"OPEN": 0, "STICK": 1, "SLIP": 2}
_VECTORS = ("", "traction_", "slip_")
#: Arrays of ``states.npz`` besides the row, and their kinds.
STATES: dict[str, Any] = {
    "contact": np.int32,
    **dict.fromkeys((f"{before}{axis}" for before in _VECTORS for axis in AXES), np.float64),
    "gap": np.float64,
    "contact_pressure": np.float64,
    "status": np.int8,
}
Row = dict[str, float | None]


def row_of(answer: Result) -> Row:
    """All numbers of an answer by their names, each followed by its error bar if bars are made.

    Args:
        answer: That converged.
    """
    supports = {name: together.errors for name, together in answer.reactions.items()}
    return _row(
        [
            ("", answer.quantities, answer.errors),
            *((f"{each.name}.", each.quantities, each.errors) for each in answer.contacts),
            *_of_supports(answer.supports, supports),
            *((f"{name}.", _measured(one), one.errors) for name, one in answer.preloads.items()),
        ]
    )


def row_of_quick(answer: Answer, names: Sequence[str]) -> Row:
    """Return the row of a quick answer, which has no error bars.

    Args:
        answer: That converged.
        names: Of the contacts.
    """
    return _row(
        [
            ("", answer.quantities, {}),
            *((f"{name}.", one, {}) for name, one in zip(names, answer.contacts, strict=True)),
            *_of_supports(answer.supports, {}),
            *((f"{name}.", _measured(one), {}) for name, one in answer.preloads.items()),
        ]
    )


def row_of_step(step: StepRecord) -> Row:
    """Return the row of a load step, which has no error bars.

    Args:
        step: That was accepted.
    """
    return _row(
        [
            ("", step.quantities, {}),
            *((f"{each.name}.", each.quantities, {}) for each in step.contacts),
            *_of_supports(step.supports, {}),
            *((f"{name}.", _measured(one), {}) for name, one in step.preloads.items()),
        ]
    )


# What stands before the names of quantities, the quantities and their errors.
_Part = tuple[str, Mapping[str, Any], Errors]


def _row(parts: Iterable[_Part]) -> Row:
    row: Row = {}
    for owner, quantities, errors in parts:
        for name, value in quantities.items():
            row |= _numbers(f"{owner}{name}", value, errors.get(name))
    return row


def _of_supports(
    supports: Sequence[SupportRecord], errors: Mapping[str, Errors]
) -> Iterator[_Part]:
    for name, quantities in reactions_by_name(supports).items():
        yield f"{name}.", quantities, errors.get(name, {})


def _measured(preload: PreloadRecord) -> dict[str, Any]:
    return {name: preload[name] for name in MEASURED_BY_PRELOADS}


def _numbers(name: str, value: Any, error: Mapping[str, float | None] | None) -> Row:
    """A number, or the components of a vector; and the error bar, once."""
    if isinstance(value, Sequence):
        row = {f"{name}_{axis}": _finite(one) for axis, one in zip(AXES, value, strict=False)}
    else:
        row = {name: _finite(value)}
    if error is not None:
        row[f"{name}{BAR}"] = _finite(error.get("total"))
    return row


def _finite(value: float | None) -> float | None:
    """Return a number as in ``result.json``, where null stands for what is not finite."""
    return None if value is None or not math.isfinite(value) else float(value)


def columns_of(rows: Iterable[Row]) -> list[str]:
    """The names of all rows, in the order of each of them.

    A quantity without a value in any row, as of several contacts together, is left out.

    Args:
        rows: Those of the answers.
    """
    patterns = dict.fromkeys(tuple(_named(row)) for row in rows)
    found: list[str] = []
    for names in patterns:
        place = 0
        for name in names:
            if name not in found:
                is_before_bar = any(one.endswith(BAR) for one in found[place : place + 1])
                # a bar stays behind its quantity
                found.insert(place + (is_before_bar and not name.endswith(BAR)), name)
            place = found.index(name) + 1
    return found


def _named(row: Row) -> Iterator[str]:
    """Names of the quantities that have a value, and of the bars of these."""
    has_value = False
    for name, value in row.items():
        is_bar = name.endswith(BAR)
        has_value = has_value if is_bar else value is not None
        if has_value:
            yield name


def states_of(points: ContactPoints | None) -> dict[str, Any]:
    """Return the arrays of an answer's contact points in ``states.npz``.

    Args:
        points: Of the answer.
    """
    if points is None:
        return {}
    vectors = (points.coordinates, points.friction_traction, points.slip)
    found = {
        f"{before}{axis}": vector[:, number]
        for before, vector in zip(_VECTORS, vectors, strict=True)
        for number, axis in enumerate(AXES)
    }
    return found | {
        "contact": points.contact,
        "gap": points.gap,
        "contact_pressure": points.contact_pressure,
        "status": np.array([_STATUS[status] for status in points.status], dtype=np.int8),
    }
