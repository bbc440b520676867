"""The tables of a run's files: ``contact.csv`` and ``steps.csv``."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.atomic_files import append, replace_file
from fenics_contact.common.wording import one_line
from fenics_contact.quantities import table
from fenics_contact.quantities.names import REACTION
from fenics_contact.results.contact_points import (
    CSV_HEADER,
    WRITTEN,
    ContactPoints,
    of_several_contacts,
)
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.quantity_names import OF_PRELOADS
from fenics_contact.scene.values import AXES


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


class StepTable:
    """The table; a run that is killed leaves whole rows.

    Args:
        path: Of the file, which the first row makes anew.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._columns: list[str] = []
        self._rows = 0

    def follow(self, steps: Sequence[StepRecord]) -> None:
        """Append the rows of the steps that were accepted since the last time.

        Args:
            steps: All so far.
        """
        rows = [row_of(step) for step in steps[self._rows :]]
        for row in rows:
            self._append({"step": self._rows + 1, **row}, rows)
            self._rows += 1

    def _append(self, row: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> None:
        text = io.StringIO()
        if not self._columns:  # those of a run that goes on may be more than it had
            self._columns = ["step", *dict.fromkeys(name for one in rows for name in one)]
            csv.writer(text).writerow(self._columns)
        csv.DictWriter(text, self._columns).writerow(row)
        write = append if self._rows else replace_file
        write(self._path, text.getvalue().encode())


def row_of(step: StepRecord) -> dict[str, Any]:
    """A load step by column.

    Quantities are those of the whole model and, where there are several contacts, then those
    of each, as ``contact.quantity``, and of each preload; vectors by component, as ``quantity_x``.
    What has no value is empty.
    """
    components = len(step.quantities[REACTION])
    row = {
        "time": step.load_factor,
        "newton_iterations": step.newton_iterations,
        "outer_iterations": step.outer_iterations,
        **_by_component(step.quantities, components),
    }
    for contact in step.contacts if len(step.contacts) > 1 else []:
        found = _by_component(contact.quantities, components)
        row |= {f"{one_line(contact.name)}.{name}": value for name, value in found.items()}
    for name, preload in step.preloads.items():
        row |= {f"{one_line(name)}.{quantity}": preload[quantity] for quantity in OF_PRELOADS}
    return row


def _by_component(quantities: Quantities, components: int) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, given in quantities.items():
        value = [None] * components if given is None and table.is_vector(name) else given
        if isinstance(value, list):
            named = zip(AXES, value, strict=False)
            found |= {f"{name}_{axis}": component for axis, component in named}
        else:
            found[name] = value
    return found
