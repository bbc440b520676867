"""The depth of an obstacle that a force drives, found by the balance with its contact's force."""

from __future__ import annotations

from fenics_contact.problem.scalars.scalar import ContactScalar, KnownProblem, ScalarUnknown


class Indentation(ContactScalar):
    """How deep an obstacle stands that a force F drives (length): m · r_c = F."""

    kind = "indentation"
    pushes = 1.0
    drives = True

    @property
    def force(self) -> float:
        """What drives the obstacle (force)."""
        return self.contact.force or 0.0

    @property
    def start(self) -> float:
        """Where the obstacle stands (length)."""
        return self.contact.kinematics.indentation

    @property
    def term(self) -> str:
        """Name of the energy term that its force makes, for results."""
        return f"force on the obstacle at {self.contact.label}"


def indentations(problem: KnownProblem) -> list[ScalarUnknown]:
    """One for each obstacle whose position is not known."""
    return [
        Indentation(contact, contact.kinematics.direction)
        for contact in problem.contacts
        if contact.has_unknown_position
    ]
