"""Estimated errors of a result over what measures its quantities.

Most are measured by themselves. What may vanish is measured by what is its size then: components by
the length of their vector, friction by the normal force, areas that stick or slip by that in
contact. And forces and displacements by no less than a small share of the largest of their kind:
that of a support that carries next to nothing need not be known to a share of that.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Iterable, Mapping

import numpy as np

from fenics_contact.quantities import table
from fenics_contact.quantities.names import OF_POINTS, REACTION, STRAIN_ENERGY
from fenics_contact.results.records.record import Errors, Quantities
from fenics_contact.results.result import Result
from fenics_contact.scene.quantity_names import (
    OF_PRELOADS,
    QuantityName,
    QuantityNames,
)

# Of the largest force, or displacement, by which smaller ones are measured.
_SMALL = 0.01


def relative_errors(result: Result, asked: Mapping[str, float], names: QuantityNames) -> Errors:
    """Return the relative errors of the requested quantities, by source.

    Args:
        result: With ``errors``.
        asked: The quantities by their names.
        names: Those of its scene.

    Returns:
        By name; without sources, and None in total, where the answer has no such quantity.
    """
    found: dict[str, dict[str, float | None]] = {}
    for text in asked:
        name = names.find(text)
        values, errors = _of_owner(result, name)
        quantity = _given(values, name.quantity)
        row = errors.get(quantity) or {"mesh": None, "total": None}
        if values.get(quantity) is None:
            row = {"total": None}
        size = _size(result, values, quantity)
        found[text] = {source: _over(error, size) for source, error in row.items()}
    return found


def measured_keys(
    result: Result, asked: Iterable[str], names: QuantityNames
) -> dict[str, Hashable]:
    """The key among what is measured of each quantity asked for; as of ``relative_errors``."""
    found = {}
    for text in asked:
        name = names.find(text)
        quantity = _given(_of_owner(result, name)[0], name.quantity)
        found[text] = names.key(dataclasses.replace(name, quantity=quantity))
    return found


def _of_owner(result: Result, name: QuantityName) -> tuple[Quantities, Errors]:
    """Quantities and their errors, of what a name says that they are of."""
    if not name.owner:
        return result.quantities, result.errors
    if name.quantity == REACTION:
        of_supports = result.reactions[name.owner]
        return of_supports, of_supports.errors
    if name.quantity in OF_PRELOADS:
        preload = result.preloads[name.owner]
        return preload, preload.errors
    contact = next(contact for contact in result.contacts if contact.name == name.owner)
    return contact.quantities, contact.errors


def _given(values: Quantities, quantity: str) -> str:
    """Return the quantity, or that which replaces a normal force without an axis."""
    row = table.find(quantity)
    has_other = row is not None and row.instead and values.get(quantity) is None
    return row.instead if row is not None and has_other else quantity


def _size(result: Result, values: Quantities, quantity: str) -> float:
    """Return the size that errors of a quantity are relative to; 0 where it is not known."""
    row = table.find(quantity)
    by = _given(values, (row and row.relative_to) or quantity)
    value = values.get(by, result.quantities.get(by))
    if value is None:
        return 0.0
    force = _largest_force(result)
    least = 0.0
    if quantity in _forces():
        least = _SMALL * force
    elif quantity.startswith(OF_POINTS) and force > 0:
        least = _SMALL * 2 * result.quantities[STRAIN_ENERGY] / force  # that goes with the force
    return max(float(np.linalg.norm(value)), least)


def _largest_force(result: Result) -> float:
    """Return the largest of the resultants of all contacts and supports (force)."""
    values = [of.get(force) for of in _parts(result) for force in _forces()]
    return max((float(np.linalg.norm(v)) for v in values if v is not None), default=0.0)


def _forces() -> tuple[str, ...]:
    """Names of resultants of contacts and supports."""
    return (*table.resultants_of_contacts(), REACTION)


def _parts(result: Result) -> list[Quantities]:
    return [*(contact.quantities for contact in result.contacts), *result.reactions.values()]


def others_than_mesh(found: Mapping[str, float | None]) -> dict[str, float]:
    """A quantity's errors by the other sources, of those that it has."""
    return {s: v for s, v in found.items() if s not in ("mesh", "total") and v}


def _over(error: float | None, size: float) -> float | None:
    """Relative; of what is nothing, any error is infinite."""
    if error is None or error == 0:
        return error
    return error / size if size > 0 else float("inf")


def is_met(errors: Errors, asked: Mapping[str, float]) -> bool:
    """Whether all are estimated and small enough."""
    totals = {name: found["total"] for name, found in errors.items()}
    return all(value is not None and value <= asked[name] for name, value in totals.items())
