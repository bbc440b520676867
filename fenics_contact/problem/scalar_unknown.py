"""Numbers that are found together with the displacements, with the equation of each.

Each is one border of the equations of the displacements u. With the scalar q, the nodal forces c q
of its column, the displacements U q that it prescribes, its corner D, and the force r_c of a
contact along a direction m, it has

    K u + c q = f + r_c,    u = U q where it prescribes displacements,
    c · u + D q + own q + pushes (m · r_c) = force,

or q = held in place of the last one. Every kind has some of these parts, and every system asks for
all of them in the same way.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.preloaded_part import ScalarForces
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.supports import Supports
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.parallel import gather_rows
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.far_field import FarField
from fenics_contact.results.records.contacts import ScalarRecord
from fenics_contact.scene.quantity_names import OfScalar
from fenics_contact.scene.scene import Scene


class KnownProblem(Protocol):
    """A problem as far as it is known before its scalar unknowns are found."""

    @property
    def scene(self) -> Scene:
        """The scene as users gave it."""
        ...

    @property
    def spaces(self) -> Spaces:
        """Finite element spaces of the body."""
        ...

    @property
    def elastic(self) -> ElasticBody:
        """Elastic energy of the body."""
        ...

    @property
    def supports(self) -> Supports:
        """Supports of the body."""
        ...

    @property
    def contacts(self) -> Sequence[ContactSurface]:
        """Contacts, in the order of the scene."""
        ...

    @property
    def far_field(self) -> FarField | None:
        """The far field of a half-space; None without one."""
        ...


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
        field: Displacements by which that force does work in it, at all nodes of the surface,
            (nodes, components); unit vectors along a direction, or those of a rotation.
        along: The same at all dofs of the surface, of all ranks, (dofs,).
        moved_along: Displacements of the contact's obstacle with it, as jumps have them, likewise.
        prescribes: Displacements that it prescribes; None for none.
        own: Factor of the scalar itself in its equation.
        pushes: Factor of the work of the contact's force in its equation.
        drives: Whether it is the indentation of the contact's obstacle.
        turns: Whether it is the angle of the contact's obstacle, as a length.
    """

    contact: ContactSurface | None = None
    field: Array = np.zeros((0, 0))
    along: Array = np.zeros(0)
    moved_along: Array = np.zeros(0)
    prescribes: PrescribedDisplacement | None = None
    own: float = 0.0
    pushes: ClassVar[float] = 0.0
    drives: ClassVar[bool] = False
    turns: ClassVar[bool] = False

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the scalar in results."""

    @property
    @abstractmethod
    def force(self) -> float:
        """The right-hand side of its equation (force)."""

    @property
    @abstractmethod
    def start(self) -> float:
        """The value at which Newton's method starts."""

    @property
    def moves_obstacle(self) -> bool:
        """Whether the contact's obstacle moves with it."""
        return self.drives or self.turns

    @property
    def moved_field(self) -> Array:
        """Displacements of the contact's obstacle with it, as jumps have them, at all nodes."""
        return self.field

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
    def is_given(self) -> bool:
        """Whether the scene gives its value at all times, so that it is no unknown for users."""
        return False

    @property
    def keeps_last(self) -> bool:
        """Whether it keeps the value that the last load step ended with."""
        return self.is_locked

    @property
    def held(self) -> float | None:
        """The value that it is held at; None where its equation finds it."""
        return None

    def imbalance(self, value: float, pushed: float) -> float:
        """Residual of its equation without forces of the body (force).

        Args:
            value: Of the unknown.
            pushed: Work of the force of its contact on the body; 0 without a contact.
        """
        return self.own * value + self.pushes * pushed - self.force

    def reach(self, value: float) -> None:  # noqa: B027  (most begin each load step elsewhere)
        """Take the value that a load step ended with."""

    def take(self, value: float) -> None:  # noqa: B027  (most are in no form)
        """Give the body its present value, for stresses."""


class ContactScalar(ScalarUnknown):
    """A scalar unknown whose equation has the force of a contact; collective.

    Args:
        contact: The contact.
        direction: Unit vector along which its force counts, (components,).
        prescribes: Displacements that the scalar prescribes; None for none.

    Attributes:
        kind: What it is, for results.
        direction: Unit vector along which the contact's force counts, (components,).
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
        nodes = len(contact.trace.all_nodes)
        self._act_by(np.broadcast_to(direction, (nodes, len(direction))))

    def _act_by(self, field: Array) -> None:
        """Take the field in which the contact's force does work; collective."""
        surface, self.field = self.contact.trace.surface, field
        owned = slice(surface.owned_nodes)
        self.along = gather_rows(surface.comm, field[owned]).reshape(-1)
        self.moved_along = gather_rows(surface.comm, self.moved_field[owned]).reshape(-1)

    @property
    def name(self) -> str:
        """Name in results: kind, place, and the direction unless that of the obstacle."""
        name = f"{self.kind} at {self.contact.label}"
        if self.direction is self.contact.kinematics.direction:
            return name
        return f"{name} along ({', '.join(f'{round(x, 3) + 0.0:g}' for x in self.direction)})"

    def take(self, value: float) -> None:
        """Bring the contact's obstacle to where it is driven (length)."""
        if self.drives:
            self.contact.kinematics.drive(value)


# Force over mass of a load at a place that is coupled with nodes, None for none; and its path.
MassLoad = tuple[Callable[[Array, AnyIntegers], Array | None], Callable[[float], float]]


@dataclass(frozen=True)
class ScalarState:
    """A scalar unknown of the body in an answer.

    Attributes:
        force: The body's force that does work on it (force).
        value: Its value (length).
        is_locked: Whether the scene kept its value.
        works: Whether its work is besides that of nodal forces on the displacement.
    """

    force: float
    value: float
    is_locked: bool
    works: bool = True


class BodyScalar(ScalarUnknown):
    """A scalar q of the body's energy W(u, q), found by ∂W/∂q = force.

    Attributes:
        label: What results call it.
        force_name: Name of ∂W/∂q among quantities of results; None where these have none.
        check: Name of the check that compares ∂W/∂q with the force asked for.
        has_slack: Whether without a force it may stay anywhere, as the shortening of a loose bolt.

    Args:
        label: What results call it.
        forces: What a unit of it does to the body.
    """

    force_name: ClassVar[str | None] = None
    check: ClassVar[str] = "preload"
    has_slack: ClassVar[bool] = True

    @property
    def works(self) -> bool:
        """Whether its work is besides that of nodal forces on the displacement."""
        return True

    def applied(self, found: float) -> float:
        """Size of a force that an imbalance of its equation is small against (force).

        Args:
            found: The body's force on it, at the last residual.
        """
        return max(abs(self.force), abs(found))

    def __init__(self, label: str, forces: ScalarForces) -> None:
        self.label, self._forces = label, forces
        self._reached = 0.0
        self._kept_at: float | None = None

    @property
    def forces_on_body(self) -> ScalarForces:
        """Forces c of a unit of it on the body, with the corner D."""
        return self._forces

    def follow_forces(self, forces: ScalarForces) -> None:
        """Take what a unit of it does to the body, as temperatures there have changed.

        Args:
            forces: With the same present value.
        """
        self._forces = forces

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

    @property
    def moved(self) -> Array | None:
        """Displacement of a unit of it, (nodes, components); None where it moves no node."""
        return None

    @property
    def at_begin(self) -> float:
        """Its value before anything acts (length)."""
        return 0.0

    @property
    def brings(self) -> float:
        """How far it may bring nodes at present, where its value is held (length)."""
        return abs(self.held) if self.moved is not None and self.held else 0.0

    def on_face(self, value: float) -> tuple[str, Array] | None:
        """Forces of a point on the face that it is coupled with; None for none.

        Args:
            value: Of the scalar (length).

        Returns:
            Label of the coupling, and its nodal forces, (nodes, components) (force).
        """
        return None

    def take_loads(self, loads: Sequence[MassLoad]) -> None:
        """Take the loads that act on a mass at its point into account; collective.

        Args:
            loads: Those of the scene, with their paths.
        """

    def momentum(self, velocity: Array) -> Array | None:
        """What a mass at its point adds to M v of nodal velocities; None for none; collective.

        Args:
            velocity: v, (nodes, components).
        """
        return None

    def work_on(self, test: Expr) -> ufl.Form | None:
        """Work of its present traction on a boundary, as a form in UFL; None without one.

        Args:
            test: The displacement that it works on.
        """
        return None

    def follow_loads(self, nodal: Array) -> None:
        """Take loads into account that act on what it moves; collective.

        Args:
            nodal: Of the present time, (nodes, components) (force).
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
        """State of the scalar in an answer, in whose state the problem is; collective.

        Args:
            displacement: Of this rank's nodes, (nodes, components) (length).
            mean_stress: At its dofs of this rank; empty without one (stress).
        """
        return self.state_at(self._forces.force(displacement, mean_stress), self.value)

    def state_at(self, force: float, value: float) -> ScalarState:
        """State of the scalar in an answer with a force ∂W/∂q, at a value (force, length)."""
        return ScalarState(force, value, self.is_locked, self.works)

    def record(self, state: ScalarState) -> ScalarRecord | None:
        """Record of the scalar in an answer; None for nothing."""
        return None

    @abstractmethod
    def force_of(self, stress: Expr) -> Expr | None:
        """∂W/∂q of a stress of the body as a form in UFL, weighted.

        Args:
            stress: (3, 3).

        Returns:
            None where all of it is that of nodal forces on what the scalar moves.
        """
