"""Numbers that are found together with the displacements, each with the equation that finds it.

Of an unknown q of a contact, with the direction m, r_c being the force of the contact on the body,
it is

    own · q + pushes · (m · r_c) = force.

That of the shortening q of a preloaded part is N(u, q) = force, N being the force along the part,
or q as it was where the part is locked.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from fenics_contact.body.parts.preloaded_part import PreloadForces
from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.loading.load_paths import KeyedPath

# Of a pseudo-time, by which one is later than another.
_LATER = 1e-9


class ScalarUnknown(ABC):
    """A number that is found together with the displacements.

    Attributes:
        contact: The contact whose forces are in its equation; None where the body's are.
        column: Displacement of ``Problem.far_field.dofs`` over it; None where it moves none.
        bulk: What a unit of it does to the body, and back; None where it does nothing.
    """

    contact: ContactSurface | None = None
    column: Array | None = None
    bulk: PreloadForces | None = None

    @property
    @abstractmethod
    def name(self) -> str:
        """For results."""

    @property
    @abstractmethod
    def force(self) -> float:
        """The right-hand side of its equation (force)."""

    @property
    @abstractmethod
    def start(self) -> float:
        """Where Newton's method starts."""

    @property
    def held(self) -> float | None:
        """The value that it is held at; None where its equation finds it."""
        return None


class ContactScalar(ScalarUnknown):
    """One whose equation has the force of a contact.

    Args:
        contact: The contact.
        direction: Unit vector that it is along, (components,).
        column: As of every scalar unknown.

    Attributes:
        contact: See the arguments.
        direction: Likewise.
        column: Likewise.
        drives: Whether it is the obstacle's indentation.
        kind: What it is, for results.
        own: Its own factor in its equation.
        pushes: The factor of the contact's force along the direction.
    """

    contact: ContactSurface
    drives: ClassVar[bool] = False
    kind: ClassVar[str]
    own: ClassVar[float]
    pushes: ClassVar[float]

    def __init__(
        self, contact: ContactSurface, direction: Array, column: Array | None = None
    ) -> None:
        self.contact, self.direction, self.column = contact, direction, column

    @property
    def name(self) -> str:
        """For results: what it is, where, and its direction unless that of the obstacle."""
        name = f"{self.kind} at {self.contact.label}"
        if self.direction is self.contact.kinematics.direction:
            return name
        return f"{name} along ({', '.join(f'{round(x, 3) + 0.0:g}' for x in self.direction)})"

    def imbalance(self, value: float, pushed: float) -> float:
        """What its equation leaves (force).

        Args:
            value: Of the unknown.
            pushed: Force of its contact on the body along the direction.
        """
        return self.own * value + self.pushes * pushed - self.force


class Indentation(ContactScalar):
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


class Resultant(ContactScalar):
    """A component of a contact's force, which a half-space's far field follows: R = m · r_c."""

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


@dataclass(frozen=True)
class PreloadState:
    """A preloaded part in an answer.

    Attributes:
        force: Along it, > 0 where it is pulled (force).
        shortening: Of its unstressed length (length).
        initial_strain: Its strain that is free of stress.
        is_locked: Whether its unstressed length was kept.
    """

    force: float
    shortening: float
    initial_strain: float
    is_locked: bool


class Shortening(ScalarUnknown):
    """By how much the unstressed length of a preloaded part is shortened: N = F, or as it was.

    Attributes:
        scene: What the scene says.
        bulk: What a unit of it does to the body.
        force: That it is tightened to at present (force).
        is_locked: Whether the unstressed length is kept at present.

    Args:
        preload: What the scene says.
        key: Where, for messages.
        bulk: Of the part.
    """

    bulk: PreloadForces

    def __init__(self, preload: Preload, key: str, bulk: PreloadForces) -> None:
        self.scene, self.bulk = preload, bulk
        self._path = KeyedPath(preload.path, f"{key}.path")
        self._force, self.is_locked = 0.0, False
        self._reached = 0.0
        self._kept_at: float | None = None

    @property
    def name(self) -> str:
        """For results."""
        return f"shortening of {self.scene.label}"

    @property
    def force(self) -> float:
        """That it is tightened to at present (force)."""
        return self._force

    @property
    def start(self) -> float:
        """Where it stands (length)."""
        return self._reached

    @property
    def held(self) -> float | None:
        """Where it is locked, the value that the last load step ended with; or as ``keep`` says."""
        return self._reached if self.is_locked else self._kept_at

    def keep(self, value: float | None) -> None:
        """Hold it at a value though it is not locked, or let its equation find it (length)."""
        self._kept_at = value

    def set_time(self, time: float, more: float = 0.0) -> None:
        """Bring force and lock to a pseudo-time.

        Args:
            time: The pseudo-time.
            more: Force over pseudo-time besides the scene's.
        """
        locked = self.scene.locked_from
        self.is_locked = locked is not None and time > locked * (1 + _LATER)
        self._force = 0.0 if self.is_locked else self.scene.force * self._path(time) + more * time

    def force_factor(self, time: float) -> float:
        """Share of the scene's force that it is tightened to; 0 where it is locked."""
        return 0.0 if self.is_locked else self._path(time)

    def reach(self, value: float) -> None:
        """Take the value that a load step ended with; one that is locked is held there."""
        self._reached = value

    def set(self, value: float) -> None:
        """Give the body its present value, for stresses (length)."""
        self.bulk.part.shortening.value = value

    @property
    def value(self) -> float:
        """That the body has at present (length)."""
        return float(self.bulk.part.shortening.value)

    def state(self, displacement: Array, mean_stress: Array) -> PreloadState:
        """Of an answer, in whose state the problem is; collective.

        Args:
            displacement: Of this rank's nodes, (nodes, components) (length).
            mean_stress: At its dofs of this rank; empty without one (stress).
        """
        return self.state_at(self.bulk.force(displacement, mean_stress), self.value)

    def state_at(self, force: float, shortening: float) -> PreloadState:
        """Of an answer with a force along the part, at a shortening (force, length)."""
        return PreloadState(
            force=force,
            shortening=shortening,
            initial_strain=-shortening / self.bulk.part.length,
            is_locked=self.is_locked,
        )
