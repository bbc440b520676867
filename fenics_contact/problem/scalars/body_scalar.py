"""Scalar unknowns that put forces on the body, and whose equation has the body's own forces."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from fenics_contact.body.forms import Expr
from fenics_contact.body.parts.scalar_forces import ScalarForces
from fenics_contact.common.arrays import Array
from fenics_contact.problem.scalars.scalar import ScalarUnknown
from fenics_contact.results.records.contacts import ScalarRecord
from fenics_contact.scene.quantity_names import OfScalar


@dataclass(frozen=True)
class ScalarState:
    """A scalar unknown of the body in an answer.

    Attributes:
        force: The body's force that does work on it (force).
        value: Its value (length).
        is_locked: Whether the scene kept its value.
    """

    force: float
    value: float
    is_locked: bool


class BodyScalar(ScalarUnknown):
    """A scalar q of the body's energy W(u, q), found by ∂W/∂q = force.

    Attributes:
        label: What results call it.
        force_name: Name of ∂W/∂q among quantities of results; None where these have none.

    Args:
        label: What results call it.
        forces: What a unit of it does to the body.
    """

    force_name: ClassVar[str | None] = None

    def __init__(self, label: str, forces: ScalarForces) -> None:
        self.label, self._forces = label, forces
        self._reached = 0.0
        self._kept_at: float | None = None

    @property
    def forces_on_body(self) -> ScalarForces:
        """Forces c of a unit of it on the body, with the corner D."""
        return self._forces

    @property
    def key_of_force(self) -> OfScalar | None:
        """Key of ∂W/∂q among measured quantities; None where results do not have it."""
        return None if self.force_name is None else OfScalar(self.label, self.force_name)

    @property
    def start(self) -> float:
        """The value that the last load step ended with (length)."""
        return self._reached

    @property
    def held(self) -> float | None:
        """Where it is locked, the value that the last load step ended with; or as ``keep`` says."""
        return self._reached if self.is_locked else self._kept_at

    def keep(self, value: float | None) -> None:
        """Hold it at a value though it is not locked, or let its equation find it (length)."""
        self._kept_at = value

    @abstractmethod
    def set_time(self, time: float, more: float = 0.0) -> None:
        """Bring its force, and whether it is locked, to a pseudo-time.

        Args:
            time: The pseudo-time.
            more: Force over pseudo-time besides the scene's.
        """

    def reach(self, value: float) -> None:
        """Take the value that a load step ended with; one that is locked is held there."""
        self._reached = value

    def take(self, value: float) -> None:
        """Give the body its present value, for stresses (length)."""
        self._forces.present.value = value

    @property
    @abstractmethod
    def has_force(self) -> bool:
        """Whether the scene gives it a force at any time."""

    @property
    def value(self) -> float:
        """The value that the body has at present (length)."""
        return float(self._forces.present.value)

    def state(self, displacement: Array, mean_stress: Array) -> ScalarState:
        """Its state in an answer, in whose state the problem is; collective.

        Args:
            displacement: Of this rank's nodes, (nodes, components) (length).
            mean_stress: At its dofs of this rank; empty without one (stress).
        """
        return self.state_at(self._forces.force(displacement, mean_stress), self.value)

    def state_at(self, force: float, value: float) -> ScalarState:
        """Its state in an answer with a force ∂W/∂q, at a value (force, length)."""
        return ScalarState(force, value, self.is_locked)

    def record(self, state: ScalarState) -> ScalarRecord | None:
        """What results have of it in an answer; None for nothing."""
        return None

    @abstractmethod
    def force_of(self, stress: Expr) -> Expr:
        """∂W/∂q of a stress of the body as a form in UFL, weighted.

        Args:
            stress: (3, 3).
        """
