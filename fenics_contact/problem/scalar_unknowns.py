"""Numbers that are found together with the displacements, each with the equation that finds it.

Of an unknown q with the direction m, r_c being the force of its contact on the body, it is

    own · q + pushes · (m · r_c) = force.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface


@dataclass(frozen=True, eq=False)
class ScalarUnknown(ABC):
    """A number that is found together with the displacements.

    Attributes:
        contact: The contact that it belongs to.
        direction: Unit vector that it is along, (components,).
        column: Displacement of ``Problem.far_field.dofs`` over it; None where it moves none.
        kind: What it is, for results.
        own: Its own factor in its equation.
        pushes: The factor of the contact's force along the direction.
        drives: Whether it is the obstacle's indentation.
    """

    contact: ContactSurface
    direction: Array
    column: Array | None = None
    kind: ClassVar[str]
    own: ClassVar[float]
    pushes: ClassVar[float]
    drives: ClassVar[bool]

    @property
    def name(self) -> str:
        """For results: what it is, where, and its direction unless that of the obstacle."""
        name = f"{self.kind} at {self.contact.label}"
        if self.direction is self.contact.kinematics.direction:
            return name
        return f"{name} along ({', '.join(f'{round(x, 3) + 0.0:g}' for x in self.direction)})"

    @property
    @abstractmethod
    def force(self) -> float:
        """The right-hand side of its equation (force)."""

    @property
    @abstractmethod
    def start(self) -> float:
        """Where Newton's method starts."""

    def imbalance(self, value: float, pushed: float) -> float:
        """What its equation leaves (force).

        Args:
            value: Of the unknown.
            pushed: Force of its contact on the body along the direction.
        """
        return self.own * value + self.pushes * pushed - self.force


class Indentation(ScalarUnknown):
    """How deep an obstacle stands that a force drives: m · r_c = F."""

    kind = "indentation"
    own = 0.0
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


class Resultant(ScalarUnknown):
    """A component of a contact's force, which a half-space's far field follows: R = m · r_c."""

    kind = "resultant"
    own = 1.0
    pushes = -1.0
    drives = False

    @property
    def force(self) -> float:
        """Nothing acts besides."""
        return 0.0

    @property
    def start(self) -> float:
        """No force yet."""
        return 0.0
