"""The unknown resultant of a contact, which the far field of a half-space follows."""

from __future__ import annotations

from fenics_contact.problem.scalars.scalar import (
    ContactScalar,
    KnownProblem,
    PrescribedDisplacement,
    ScalarUnknown,
)


class Resultant(ContactScalar):
    """A component of a contact's force (force): R = m · r_c."""

    kind = "resultant"
    own = 1.0
    pushes = -1.0

    @property
    def force(self) -> float:
        """Nothing acts besides."""
        return 0.0

    @property
    def start(self) -> float:
        """No force yet."""
        return 0.0


def resultants(problem: KnownProblem) -> list[ScalarUnknown]:
    """Those of each contact that no force on its obstacle tells, and those along the surface."""
    far_field = problem.far_field
    if far_field is None:
        return []
    found: list[ScalarUnknown] = []
    for number, contact in enumerate(problem.contacts):
        along = list(far_field.sideways[number])
        if contact.force is None:
            along.insert(0, (contact.kinematics.direction, far_field.columns[number]))
        for direction, column in along:
            prescribes = PrescribedDisplacement(far_field.dofs, column)
            found.append(Resultant(contact, direction, prescribes))
    return found
