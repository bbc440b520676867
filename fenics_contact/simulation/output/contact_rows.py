"""The lines of ``contact.csv``: a header, and a row a contact point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.wording import one_line
from fenics_contact.results.contact_points import (
    CSV_HEADER,
    WRITTEN,
    ContactPoints,
    of_several_contacts,
)
from fenics_contact.results.records.contacts import ContactRecord


def contact_rows(points: ContactPoints, contacts: Sequence[ContactRecord]) -> list[list[str]]:
    """The header and a row a point; what laws keep of their own stands behind the status.

    Args:
        points: All of them.
        contacts: As in ``result.json``.
    """
    own = of_several_contacts(array for contact in contacts for array in contact.own_arrays)
    names = [one_line(contact.name) for contact in contacts]
    head = [*CSV_HEADER, *(column for array in own for column in array.columns)]
    columns = [_without_round_off(points.coordinates), _without_round_off(points.normals)]
    for array in WRITTEN:
        # The gap is a difference of lengths; closed, round-off is most of it.
        size = np.abs(points.coordinates).max(initial=0.0) if array.name == "gap" else 0.0
        columns.append(_without_round_off(_columns(getattr(points, array.name)), size))
    before = _formatted(np.hstack(columns))
    behind = [_without_round_off(_columns(points.own[array.name])) for array in own]
    after = _formatted(np.hstack(behind)) if own else [[]] * len(before)
    rows = zip(points.contact.tolist(), before, points.status.tolist(), after, strict=True)
    return [head, *([names[number], *left, state, *right] for number, left, state, right in rows)]


def _columns(values: Array) -> Array:
    return values if values.ndim == 2 else values[:, None]


def _formatted(table: Array) -> list[list[str]]:
    """Numbers in words, row by row: one format a row, as there may be many."""
    numbers = ",".join(["%.8g"] * table.shape[1])
    return [(numbers % tuple(values)).split(",") for values in table.tolist()]


def _without_round_off(values: Array, size: float = 0.0) -> Array:
    """Rounded to 1e-12 of the largest, or 1e-13 of a size, so that runs compare line by line."""
    finite = np.abs(values[np.isfinite(values)])
    unit = 1e-13 * size if size > 0 else 1e-12 * finite.max(initial=0.0)
    return np.round(values / unit) * unit + 0.0 if unit > 0 else values
