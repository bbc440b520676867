"""The laws across a contact, one file each: prescribed, unilateral, foundation, bonded.

The paper's (1.8) and (4.1). A new law is a file of its own and a line in ``LAWS``.
"""

from __future__ import annotations

from fenics_contact.contact.laws.allowed import own_law
from fenics_contact.contact.laws.normal.bonded import Bonded
from fenics_contact.contact.laws.normal.formula_law import FormulaLaw
from fenics_contact.contact.laws.normal.foundation import Foundation
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.normal.normal_compliance import NormalCompliance
from fenics_contact.contact.laws.normal.own_energy import UserContactEnergy
from fenics_contact.contact.laws.normal.prescribed import Prescribed
from fenics_contact.contact.laws.normal.unilateral import Unilateral
from fenics_contact.contact.laws.normal.untouched import Untouched
from fenics_contact.scene.contact import Contact

LAWS: tuple[type[NormalLaw], ...] = (
    Prescribed,
    Unilateral,
    Foundation,
    Bonded,
    NormalCompliance,
    FormulaLaw,
)


def law_of(contact: Contact) -> type[NormalLaw]:
    """The law that a scene's contact names.

    Raises:
        InputError: It is one of a user's that is not allowed, or not there.
    """
    known = next((law for law in LAWS if law.kind == contact.kind), None)
    return known or own_law(
        contact.kind, UserContactEnergy, f"contact '{contact.label}': normal_law.kind"
    )


def acting_law(contact: Contact) -> type[NormalLaw]:
    """The same, or ``Untouched`` where no force drives an obstacle that is to be pressed on."""
    law, obstacle = law_of(contact), contact.obstacle
    return Untouched if law.pushes_only and obstacle is not None and obstacle.force == 0 else law
