"""Quantities of a run by its contacts and supports: which say something, and sums by name."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

from fenics_contact.quantities import table
from fenics_contact.results.records.contacts import ContactRecord, SupportRecord
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.normal_laws import NormalLawTable
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.quantity_names import OF_PRELOADS, OfScalar
from fenics_contact.scene.reference import measured_by as measured_by_key


def measured_by_parameter(name: str) -> str:
    """Return the dimension of a contact's parameter, that of the scene's key of its name."""
    return measured_by_key(name, Contact, Obstacle, *NormalLawTable.__subclasses__())


def idle_quantities(contacts: Sequence[ContactRecord]) -> set[str]:
    """Names of the quantities that say nothing about some contacts, and are not shown."""
    missing = set()
    if all(not contact.carries_shear for contact in contacts):
        missing.add("friction")
    if all(contact.pressure_is_given for contact in contacts):
        missing.add("contact found")
    return {one.name for one in table.every() if one.needs in missing}


def secondary_quantities(contacts: Sequence[ContactRecord]) -> set[str]:
    """Names of the quantities that others say as well, and that are not shown.

    One that stands for a quantity which some contact has not is shown.
    """
    found = {one.name for one in table.every() if one.is_secondary}
    for one in table.every():
        if any(contact.quantities.get(one.name) is None for contact in contacts):
            found.discard(one.instead)
    return found


def without_value(name: str) -> str:
    """Why a quantity of a contact has no value, in words.

    Args:
        name: Of the quantity.
    """
    row = table.find(name)
    return "none" if row is None else row.no_value


def scalars_of_step(step: Mapping[str, Any]) -> Mapping[str, Mapping[str, Any]]:
    """Records of the scalar unknowns that a load step's results name, by these names."""
    return dict(step.get("preloads", {}))


def quantities_of_scalars(records: Mapping[str, Mapping[str, Any]]) -> dict[Hashable, float]:
    """The quantities of records of scalar unknowns that have error bars, by ``OfScalar`` keys."""
    return {
        OfScalar(name, quantity): record[quantity]
        for name, record in records.items()
        for quantity in OF_PRELOADS
    }


def reactions_by_name(supports: Sequence[SupportRecord]) -> dict[str, list[float]]:
    """Resultant of the supports of each name."""
    found: dict[str, list[float]] = {}
    for support in supports:
        before = found.get(support.name, [0.0] * len(support.reaction))
        found[support.name] = [a + b for a, b in zip(before, support.reaction, strict=True)]
    return found
