"""The laws across a contact: prescribed, unilateral, foundation, bonded and others.

The paper's (1.8) and (4.1). A new law is a class and a line in ``LAWS``.
"""

from __future__ import annotations

from fenics_contact.contact.laws.allowed import own_law
from fenics_contact.contact.laws.normal.elastic_laws import (
    Bonded,
    Foundation,
    NormalCompliance,
    Prescribed,
    Unilateral,
    Untouched,
)
from fenics_contact.contact.laws.normal.energy_law import UserContactEnergy
from fenics_contact.contact.laws.normal.formula_law import FormulaLaw
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.law_tables import NORMAL_LAWS, NormalLawTable

LAWS: tuple[type[NormalLaw], ...] = (
    Prescribed,
    Unilateral,
    Foundation,
    Bonded,
    NormalCompliance,
    FormulaLaw,
)
_REGISTERED: dict[type[NormalLaw], type[NormalLawTable]] = {}


def register(law: type[NormalLaw], table: type[NormalLawTable]) -> None:
    """Add a law across a contact, and its table of a scene.

    Args:
        law: The law.
        table: A scene class, whose ``kind`` is that of the law: its keys are the law's numbers.

    Raises:
        ValueError: There is a law of this kind with a table.
    """
    NORMAL_LAWS.register(table)
    _REGISTERED[law] = table


def unregister(law: type[NormalLaw]) -> None:
    """Take out a law that was registered."""
    NORMAL_LAWS.unregister(_REGISTERED.pop(law))


def law_of(contact: Contact) -> type[NormalLaw]:
    """The law that a scene's contact names.

    Raises:
        InputError: It is one of a user's that is not allowed, or not there.
    """
    known = next((law for law in (*LAWS, *_REGISTERED) if law.kind == contact.kind), None)
    return known or own_law(
        contact.kind, UserContactEnergy, f"contact '{contact.label}': normal_law.kind"
    )


def acting_law(contact: Contact) -> type[NormalLaw]:
    """The law of a contact; ``Untouched`` where an obstacle that is pressed on has no force."""
    law, obstacle = law_of(contact), contact.obstacle
    return Untouched if law.pushes_only and obstacle is not None and obstacle.force == 0 else law
