"""A number that is found together with the displacements, with the equation that finds it.

Each is one border of the equations of the displacements u. With the scalar q, the nodal forces
c q of its column, the displacements U q that it prescribes, its corner D, and the force r_c of a
contact along a direction m, it has

    K u + c q = f + r_c,    u = U q where it prescribes displacements,
    c · u + D q + own q + pushes (m · r_c) = force,

or q = held in place of the last one. Every kind has some of these parts, and every system asks for
all of them in the same way.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fenics_contact.body.parts.scalar_forces import ScalarForces
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.contact_surface import ContactSurface


@dataclass(frozen=True, eq=False)
class PrescribedDisplacement:
    """Displacements that a unit of a scalar unknown prescribes, as on a boundary that it moves.

    Attributes:
        dofs: Constrained dofs that it moves, sorted (local indices, owned and ghost).
        displacement: Theirs over the scalar, (dofs,).
    """

    dofs: Integers
    displacement: Array

    def owned(self, size: int) -> tuple[Integers, Array]:
        """The part of it that a rank owns: dofs, and their displacement over the scalar.

        Args:
            size: Number of displacement dofs that the rank owns; these come first.
        """
        mine = self.dofs < size
        return self.dofs[mine], self.displacement[mine]

    def of_all(self, size: int) -> Array:
        """Displacement of all dofs of a rank over the scalar, 0 at others, (dofs,).

        Args:
            size: Number of the rank's displacement dofs, owned and ghost.
        """
        found = np.zeros(size)
        found[self.dofs] = self.displacement
        return found


class ScalarUnknown(ABC):
    """A number that is found together with the displacements.

    Attributes:
        contact: The contact whose force is in its equation; None for none.
        direction: Unit vector along which that force counts, (components,).
        prescribes: Displacements that it prescribes; None for none.
        own: Factor of the scalar itself in its equation.
        pushes: Factor of the contact's force along the direction in its equation.
        drives: Whether it is the indentation of the contact's obstacle.
    """

    contact: ContactSurface | None = None
    direction: Array = np.zeros(0)
    prescribes: PrescribedDisplacement | None = None
    own: float = 0.0
    pushes: ClassVar[float] = 0.0
    drives: ClassVar[bool] = False

    @property
    @abstractmethod
    def name(self) -> str:
        """Its name in results."""

    @property
    @abstractmethod
    def force(self) -> float:
        """The right-hand side of its equation (force)."""

    @property
    @abstractmethod
    def start(self) -> float:
        """The value at which Newton's method starts."""

    @property
    def term(self) -> str | None:
        """Name of the energy term that its force makes, for results; None without one."""
        return None

    @property
    def forces_on_body(self) -> ScalarForces | None:
        """Forces c of a unit of it on the body, with the corner D; None where there are none."""
        return None

    @property
    def is_locked(self) -> bool:
        """Whether the scene keeps its value at present, in place of its equation."""
        return False

    @property
    def held(self) -> float | None:
        """The value that it is held at; None where its equation finds it."""
        return None

    def imbalance(self, value: float, pushed: float) -> float:
        """What its equation leaves, but for forces of the body (force).

        Args:
            value: Of the unknown.
            pushed: Force of its contact on the body along the direction; 0 without a contact.
        """
        return self.own * value + self.pushes * pushed - self.force

    def reach(self, value: float) -> None:  # noqa: B027  (most begin each load step elsewhere)
        """Take the value that a load step ended with."""

    def take(self, value: float) -> None:  # noqa: B027  (most are in no form)
        """Give the body its present value, for stresses."""


class ContactScalar(ScalarUnknown):
    """A scalar unknown whose equation has the force of a contact.

    Args:
        contact: The contact.
        direction: Unit vector along which its force counts, (components,).
        prescribes: Displacements that the scalar prescribes; None for none.

    Attributes:
        kind: What it is, for results.
    """

    contact: ContactSurface
    kind: ClassVar[str]

    def __init__(
        self,
        contact: ContactSurface,
        direction: Array,
        prescribes: PrescribedDisplacement | None = None,
    ) -> None:
        self.contact, self.direction, self.prescribes = contact, direction, prescribes

    @property
    def name(self) -> str:
        """Its name in results: what it is, where, and its direction unless that of the obstacle."""
        name = f"{self.kind} at {self.contact.label}"
        if self.direction is self.contact.kinematics.direction:
            return name
        return f"{name} along ({', '.join(f'{round(x, 3) + 0.0:g}' for x in self.direction)})"
