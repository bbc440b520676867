"""The kinds of scalar unknowns, each with what finds those of a problem: a line for a new one.

These are the depth of an obstacle that a force drives, the angle of one that a moment turns, the
resultant of a contact that the far field of a half-space follows, the motions of faces that are
rigid (``couplings``), and the shortening of a preloaded part, such as a tight bolt. The force N
along the part is the one that the scene asks for; or the part is locked, and keeps the length that
it has.
"""

from __future__ import annotations

from collections.abc import Callable

import ufl
from ufl.core.expr import Expr

from fenics_contact.body.preloaded_part import PreloadedPart, ScalarForces
from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.loads.couplings import face_motions
from fenics_contact.problem.loads.temperatures import thermal_strains
from fenics_contact.problem.scalar_unknown import (
    BodyScalar,
    ContactScalar,
    KnownProblem,
    PrescribedDisplacement,
    ScalarState,
    ScalarUnknown,
)
from fenics_contact.results.records.contacts import PreloadRecord
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.loading.load_paths import KeyedPath


class Indentation(ContactScalar):
    """How deep an obstacle stands that a force F drives (length): m · r_c = F."""

    kind = "indentation"
    pushes = 1.0
    drives = True

    @property
    def force(self) -> float:
        """Force that drives the obstacle (force)."""
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


class Turn(ContactScalar):
    """How far a moment M turns an obstacle: Σ (a × (x − at)) · r_c = M about its axis a.

    It is the path q = θ l of the points farthest from the axis, at a distance l, so that its
    equation is one of forces: Σ (a × (x − at)) / l · r_c = M / l.
    """

    kind = "rotation of the obstacle"
    pushes = 1.0
    turns = True

    def __init__(self, contact: ContactSurface) -> None:
        kinematics = contact.kinematics
        self._lever = kinematics.lever
        super().__init__(contact, kinematics.direction)
        self._act_by(kinematics.turned_nodes / self._lever)

    @property
    def force(self) -> float:
        """The moment over its lever (force)."""
        return (self.contact.moment or 0.0) / self._lever

    @property
    def start(self) -> float:
        """How far the obstacle has turned (length)."""
        return self.contact.kinematics.angle * self._lever

    @property
    def moved_field(self) -> Array:
        """Displacements of the obstacle with it at all nodes, and what widens the gap."""
        kinematics = self.contact.kinematics
        return (kinematics.turned_nodes + kinematics.shape_field) / self._lever

    @property
    def term(self) -> str:
        """Name of the energy term that its moment makes, for results."""
        return f"moment on the obstacle at {self.contact.label}"

    def take(self, value: float) -> None:
        """Turn the obstacle (length)."""
        self.contact.kinematics.turn(value / self._lever)


def turns(problem: KnownProblem) -> list[ScalarUnknown]:
    """One for each obstacle that a moment turns; collective."""
    return [Turn(contact) for contact in problem.contacts if contact.has_unknown_angle]


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
    """Resultants of each contact that no obstacle's force gives, and those along the surface."""
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


# Of a pseudo-time, by which one is later than another.
_LATER = 1e-9


class Shortening(BodyScalar):
    """The shortening q of a preloaded part (length): N(u, q) = F, or as it was where it is locked.

    Attributes:
        scene: What the scene says.

    Args:
        preload: What the scene says.
        key: Its key in the scene, for messages.
        part: The part of the body.
        forces: What a unit of its shortening does to the body.
    """

    force_name = "force"

    def __init__(
        self, preload: Preload, key: str, part: PreloadedPart, forces: ScalarForces
    ) -> None:
        super().__init__(preload.label, forces)
        self.scene, self._part = preload, part
        self._path = KeyedPath(preload.path, f"{key}.path")
        self._force, self._is_locked = 0.0, False

    @property
    def name(self) -> str:
        """Name of the shortening in results."""
        return f"shortening of {self.label}"

    @property
    def term(self) -> str:
        """Name of the energy term that its force makes, for results."""
        return f"preload of {self.label}"

    @property
    def force(self) -> float:
        """The force that the part is tightened to at present (force)."""
        return self._force

    @property
    def has_force(self) -> bool:
        """Whether the scene tightens the part at any time."""
        return self.scene.force != 0

    @property
    def is_locked(self) -> bool:
        """Whether the unstressed length is kept at present."""
        return self._is_locked

    def set_time(self, time: float, more: float = 0.0) -> None:
        """Bring force and lock to a pseudo-time."""
        locked = self.scene.locked_from
        self._is_locked = locked is not None and time > locked * (1 + _LATER)
        self._force = self.scene.force * self.force_factor(time)
        self._force += 0.0 if self.is_locked else more * time

    def force_factor(self, time: float) -> float:
        """Share of the scene's force that it is tightened to; 0 where it is locked."""
        return 0.0 if self.is_locked else self._path(time)

    def record(self, state: ScalarState) -> PreloadRecord:
        """Record of the preload in an answer."""
        return PreloadRecord(
            on=self.scene.on,
            force=state.force,
            elongation=state.value,
            initial_strain=-state.value / self._part.length,
            locked=state.is_locked,
        )

    def force_of(self, stress: Expr) -> Expr:
        """The force along the part of a stress, (1/l) ∫ a · σ a, as a form in UFL, weighted."""
        strain = -self._part.stressless_strain(ufl.as_ufl(1.0))
        return self._part.spaces.weight * ufl.inner(stress, strain) * self._part.measure


def shortenings(problem: KnownProblem) -> list[ScalarUnknown]:
    """One for each preload of the scene, in its order."""
    elastic = problem.elastic
    forces = elastic.scalar_forces[: len(elastic.preloaded)]
    known = zip(problem.scene.preload, elastic.preloaded, forces, strict=True)
    return [
        Shortening(preload, f"preload[{number}]", part, forces)
        for number, (preload, part, forces) in enumerate(known)
    ]


Kind = Callable[[KnownProblem], list[ScalarUnknown]]

# Each returns the scalar unknowns of a kind of a problem whose contacts and far field are known.
_KINDS: list[Kind] = [
    indentations,
    turns,
    resultants,
    shortenings,
    thermal_strains,
    face_motions,
]


def register(kind: Kind) -> None:
    """Make a kind known.

    Args:
        kind: Returns the scalar unknowns of the kind of a problem; collective.
    """
    _KINDS.append(kind)


def unregister(kind: Kind) -> None:
    """Take out a kind that was registered."""
    _KINDS.remove(kind)


def scalars_of(problem: KnownProblem) -> list[ScalarUnknown]:
    """All scalar unknowns of a problem, those of the body last; collective."""
    found = [scalar for kind in _KINDS for scalar in kind(problem)]
    return sorted(found, key=lambda scalar: isinstance(scalar, BodyScalar))
