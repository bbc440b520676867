"""Scalar unknowns that are not the program's: springs behind an obstacle and under a support."""

from fenics_contact.problem import scalar_kinds
from fenics_contact.problem.scalar_unknown import ContactScalar, PrescribedDisplacement

STIFFNESS = 400.0


class Seat(ContactScalar):
    """How deep an obstacle stands on a spring whose other end is driven: k q + m · r_c = k d."""

    kind = "seat"
    own = STIFFNESS
    pushes = 1.0
    drives = True

    @property
    def force(self):
        return STIFFNESS * self.contact.contact.obstacle.indentation

    @property
    def start(self):
        return self.contact.kinematics.indentation


class Foot(ContactScalar):
    """How far a contact's force pushes the support of a body into a spring: k q = m · r_c."""

    kind = "foot"
    own = STIFFNESS
    pushes = -1.0
    force = 0.0
    start = 0.0


def seats(problem):
    """One under each obstacle."""
    return [Seat(contact, contact.kinematics.direction) for contact in problem.contacts]


def feet(problem):
    """One under the first support, which each obstacle pushes along."""
    dofs = problem.supports.applied[0].dofs
    axes = dofs % problem.spaces.components
    ways = [contact.kinematics.direction for contact in problem.contacts]
    return [
        Foot(contact, way, PrescribedDisplacement(dofs, way[axes]))
        for contact, way in zip(problem.contacts, ways, strict=True)
    ]


KINDS = {"seat": seats, "foot": feet}
register, unregister = scalar_kinds.register, scalar_kinds.unregister
