"""A scene with less of an error that its contacts bring in, to see what that does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.scene import Scene

# The part of ε and of ε₁ that is left.
_LEFT = 1 / 32
#: Of the difference, for what is left: errors of first order, and not of the leading order alone.
FACTOR = 1 / (1 - _LEFT) ** 2


def with_reduced(scene: Scene, contacts: Sequence[ContactRecord], name: str) -> Scene | None:
    """A scene with a small part of ε or of ε₁; the same one where contacts have none.

    Args:
        scene: That was solved.
        contacts: With ε and ε₁ as used.
        name: ``penalty_parameter`` or ``regularisation_parameter``.

    Returns:
        None where it varies over a contact, so that no number stands for it.
    """

    def less(contact: Contact, record: ContactRecord) -> Contact:
        used = record.parameters.get(name)
        return replace(contact, **{name: _LEFT * used}) if used else contact

    if any(isinstance(record.parameters.get(name), str) for record in contacts):
        return None
    pairs = zip(scene.contact, contacts, strict=True)
    return replace(scene, contact=tuple(less(contact, record) for contact, record in pairs))
