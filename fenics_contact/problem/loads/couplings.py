"""The motions of points that faces are coupled with, as scalar unknowns of the problem.

A rigid face moves with its point. One that stays elastic has a second scalar for each way, the
force between point and face, by which its mean motion is that of the point.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, cast

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.body.coupled_face import CoupledFace, MotionForces, PointForces, SpreadForces
from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.preloaded_part import ScalarForces
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.problem.scalar_unknown import (
    BodyScalar,
    KnownProblem,
    MassLoad,
    ScalarUnknown,
)
from fenics_contact.scene.loading.couplings import Coupling, Way
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.values import AXES

# Of forces of inertia, which in small steps are far larger than what bodies exert on each other.
OF_FLIGHT = 1e-3


@dataclass(frozen=True)
class PointStep:
    """State of a point at the begin of a step of motion, along one way.

    Attributes:
        force: Of the right-hand side of its equation, besides what acts at the end (force).
        acting: The part of it that acts at the begin (force).
        start: Where the point would be at the end if no force acted (length).
    """

    force: float
    acting: float
    start: float


class PointMotion(BodyScalar):
    """One way in which a coupled point moves, as a length q: its force N(u, q) = F, or q is given.

    F is the work of the coupling's force or moment over q. N is that of the force between the point
    and its face, where this stays elastic.

    Attributes:
        way: Along or about which axis.
        is_mirrored: Whether symmetry keeps it at 0, as the face and its mirror image are one.

    Args:
        scene: The coupling.
        key: Its key, for messages.
        face: The face.
        way: Along or about which axis.
        forces: What a unit of it does to the body.
        is_mirrored: Whether symmetry keeps it at 0, as the face and its mirror image are one.
    """

    has_slack: ClassVar[bool] = False
    check: ClassVar[str] = "coupling"

    def __init__(
        self,
        scene: Coupling,
        key: str,
        face: CoupledFace,
        way: Way,
        forces: ScalarForces,
        is_mirrored: bool,
    ) -> None:
        super().__init__(f"{'.'.join(way)} of {scene.label}", forces)
        self.scene, self.way, self._face = scene, way, face
        self._path = KeyedPath(scene.path, f"{key}.path")
        self._is_given, self.is_mirrored = is_mirrored or way in scene.given, is_mirrored
        self._amount = 0.0 if is_mirrored else face.amount(way, scene.given.get(way, 0.0))
        self._work = face.work(way, scene.acting.get(way, 0.0))
        self._factor, self._besides, self._weight = 0.0, 0.0, 0.0
        self._step: PointStep | None = None
        self._weights: list[tuple[float, Callable[[float], float]]] = []

    @property
    def name(self) -> str:
        """Name of the scalar in results."""
        return self.label

    @property
    def term(self) -> str | None:
        """Name of the energy term that its force makes, for results; None without one."""
        if self.is_locked or not self._work:
            return None
        kind = "force" if self.way[0] == "displacement" else "moment"
        return f"{kind} on {self.scene.label} along {self.way[1]}"

    @property
    def force(self) -> float:
        """Work over q of the coupling's force and of the weight of its mass (force)."""
        before = 0.0 if self._step is None else self._step.force
        return self._work * self._factor + self._weight + self._besides + before

    def applied(self, found: float) -> float:
        """Size of a force that an imbalance of its equation is small against (force)."""
        if self._step is None:
            return super().applied(found)
        acting = max(abs(self.own_force), abs(self._step.acting))
        return acting + OF_FLIGHT * max(abs(self.force), abs(found))

    @property
    def own_force(self) -> float:
        """Force and weight at the point without loads on the face; 0 where q is given (force)."""
        return 0.0 if self._is_given else self._work * self._factor + self._weight

    def acting_at(self, time: float) -> float:
        """Force and weight at the point at a time (force)."""
        return self._work * self._path(time) + self._weight_at(time)

    def _weight_at(self, time: float) -> float:
        return sum(force * path(time) for force, path in self._weights)

    def force_factor(self, time: float) -> float:
        """The force on the scalar over the scene's force or moment; 0 where its motion is given."""
        return 0.0 if self._is_given else self._face.work(self.way, 1.0) * self._path(time)

    @property
    def has_force(self) -> bool:
        """Whether anything pushes it; a given motion counts."""
        return True

    @property
    def is_locked(self) -> bool:
        """Whether the scene gives the motion."""
        return self._is_given

    @property
    def keeps_last(self) -> bool:
        """Whether it keeps the value of the last load step: no, the scene gives each."""
        return False

    @property
    def held(self) -> float | None:
        """The motion that is given at present; None where its equation finds it (length)."""
        return self._amount * self._factor if self._is_given else self._kept_at

    @property
    def start(self) -> float:
        """The motion at which Newton's method starts (length)."""
        if self.held is not None:
            return self.held
        return self._reached if self._step is None else self._step.start

    def take_step(self, step: PointStep) -> None:
        """Take what a step of motion begins from."""
        self._step = step

    def set_time(self, time: float, more: float = 0.0) -> None:
        """Bring force and given motion to a pseudo-time."""
        self._factor = self._path(time)
        self._weight = self._weight_at(time)
        self._besides = more * time

    def take_loads(self, loads: Sequence[MassLoad]) -> None:
        """Take the loads that act on the mass at the point into account; collective."""
        self._weights = [
            (force, path) for at, path in loads if (force := self.weight_of(at)) is not None
        ]

    def weight_of(self, load: Callable[[Array, AnyIntegers], Array | None]) -> float | None:
        """Force of a load on the mass at the point along this way; None for none; collective.

        Args:
            load: Gives its force over mass at a place that is coupled with nodes.
        """
        if self.mass == 0:
            return None
        found = load(self._face.at, self._face.nodes)
        return None if found is None else self.mass * float(found[AXES.index(self.way[1])])

    def momentum(self, velocity: Array) -> Array | None:
        """What the mass at the point adds to M v of nodal velocities; None for none; collective."""
        if self.mass == 0:
            return None
        (along,) = self.ways_in(velocity[..., None])
        return np.asarray(self.mass * along * self.measured)

    @property
    def mass(self) -> float:
        """The mass at the point that this way moves; 0 for none (mass)."""
        moves_none = self.way[0] == "rotation" or self.is_mirrored
        return 0.0 if self.scene.mass is None or moves_none else self.scene.mass

    def amount_of(self, value: float) -> float:
        """Displacement or rotation of a value of the scalar (length, radian)."""
        return value / self._face.amount(self.way, 1.0)

    def ways_in(self, fields: Array) -> Array:
        """Its value in motions of the body that do not strain it, (motions,); collective (length).

        Args:
            fields: Displacements of these, (nodes, components, motions) (length).
        """
        spaces, own = self._face.spaces, slice(self._face.spaces.owned_nodes)
        works = np.einsum("nc,ncm->m", self.measured[own], fields[own])
        return np.asarray(total(spaces.comm, works))

    @property
    @abstractmethod
    def measured(self) -> Array:
        """Weights of nodal displacements that give its value, (nodes, components)."""

    def force_of(self, stress: Expr) -> Expr | None:
        """None: all its force is that of nodal forces."""
        return None


class FaceMotion(PointMotion):
    """One way in which a rigid face moves with its point.

    Its force N is the work of K u on the face over q. The loads that act on the nodes of the face
    are a part of F.

    Args:
        scene: The coupling.
        key: Its key, for messages.
        face: The face.
        way: Along or about which axis.
        forces: What a unit of it does to the body.
        is_mirrored: Whether symmetry keeps it at 0, as the face and its mirror image are one.
    """

    def __init__(
        self,
        scene: Coupling,
        key: str,
        face: CoupledFace,
        way: Way,
        forces: MotionForces,
        is_mirrored: bool,
    ) -> None:
        super().__init__(scene, key, face, way, forces, is_mirrored)
        self._motion, self._by_loads = forces, 0.0

    @property
    def force(self) -> float:
        """Work over q of the coupling's force and of loads on its face (force)."""
        return super().force + self._by_loads

    @property
    def moved(self) -> Array:
        """Displacement of a unit of it, 0 off the face, (nodes, components)."""
        return self._motion.moved

    def follow_loads(self, nodal: Array) -> None:
        """Take the loads on the face into account; collective.

        Args:
            nodal: Of the present time, (nodes, components) (force).
        """
        own = slice(self._motion.spaces.owned_nodes)
        works = float(np.sum(self._motion.moved[own] * nodal[own]))
        self._by_loads = float(total(self._motion.spaces.comm, works))

    @property
    def works(self) -> bool:
        """No: its work is that of nodal forces on the face."""
        return False

    @cached_property
    def measured(self) -> Array:
        """Weights of nodal displacements by least squares over the face, (nodes, components)."""
        face, own = self._face, slice(self._face.spaces.owned_nodes)
        every = np.zeros_like(face.fields)
        every[:, face.nodes] = face.fields[:, face.nodes]
        fields = every[:, own]
        gram = np.asarray(total(face.spaces.comm, np.einsum("inc,jnc->ij", fields, fields)))
        row = np.linalg.pinv(gram, hermitian=True)[face.ways.index(self.way)]
        return np.tensordot(row, every, 1)


class MeanMotion(PointMotion):
    """One way in which a point moves by the mean motion of a face that stays elastic."""

    def __init__(
        self,
        scene: Coupling,
        key: str,
        face: CoupledFace,
        way: Way,
        forces: ScalarForces,
        is_mirrored: bool,
        measured: Array,
    ) -> None:
        super().__init__(scene, key, face, way, forces, is_mirrored)
        self._mean = measured

    @property
    def works(self) -> bool:
        """Whether its work is besides; in a step of motion all of points is counted together."""
        return self._step is None

    @property
    def measured(self) -> Array:
        """Weights of nodal displacements that give the mean motion, (nodes, components)."""
        return self._mean


class SpreadForce(BodyScalar):
    """The force between a point and a face that stays elastic, as a length m: κ m.

    Its equation is κ (q − C u) = 0: the point has the mean motion of the face.

    Args:
        motion: Of the point.
        face: The face.
        spread: How it takes forces on its point.
        forces: What a unit of m does to the body.
        is_mirrored: Whether symmetry leaves no force, as the face and its mirror image are one.
    """

    has_slack: ClassVar[bool] = False
    check: ClassVar[str] = "coupling"

    def __init__(
        self,
        motion: MeanMotion,
        face: CoupledFace,
        spread: SpreadForces,
        forces: PointForces,
        is_mirrored: bool,
    ) -> None:
        super().__init__(f"force of {motion.label}", forces)
        self.motion, self._face, self._spread = motion, face, spread
        self.tie, self._is_mirrored = forces.tie, is_mirrored
        self._besides = 0.0

    @property
    def name(self) -> str:
        """Name of the scalar in results."""
        return self.label

    @property
    def force(self) -> float:
        """Nothing keeps the point from the mean motion (force)."""
        return self._besides

    @property
    def has_force(self) -> bool:
        """Whether anything pushes it; that the point follows counts."""
        return True

    @property
    def is_locked(self) -> bool:
        """Whether symmetry leaves no force."""
        return self._is_mirrored

    @property
    def held(self) -> float | None:
        """0 where symmetry leaves no force."""
        return 0.0 if self._is_mirrored else self._kept_at

    def set_time(self, time: float, more: float = 0.0) -> None:
        """Take what disturbs its equation at a pseudo-time."""
        self._besides = more * time

    def on_face(self, value: float) -> tuple[str, Array]:
        """Label of the coupling, and nodal forces on the face, (nodes, components) (force)."""
        return self.motion.scene.label, -value * self._forces.nodal

    def resultant(self, way: Way) -> float:
        """Force or moment on the face along a way, over the value."""
        return self._face.amount(way, self.tie) if way == self.motion.way else 0.0

    def work_on(self, test: Expr) -> ufl.Form:
        """Work of the present traction on a displacement, as a form in UFL.

        Args:
            test: The displacement.
        """
        return self._spread.work_of(self.motion.way, self.tie * self._forces.present, test)

    def force_of(self, stress: Expr) -> Expr | None:
        """None: its equation has displacements of the face alone."""
        return None


def face_motions(problem: KnownProblem) -> list[ScalarUnknown]:
    """Return the scalars of the scene's couplings, forces between points and faces first.

    Each has one for each way of each coupling, in its order; collective.

    Raises:
        InputError: A motion or a force is given that symmetry does not allow.
    """
    elastic, forces_found, found = problem.elastic, list[ScalarUnknown](), list[ScalarUnknown]()
    every = iter(elastic.of_points)
    ties = [next(every) for _ in range(elastic.ties)]
    spread_forces = iter(cast(list[PointForces], ties))
    rows = zip(problem.scene.coupling, elastic.faces, elastic.spreads, strict=True)
    for number, (coupling, face, spread) in enumerate(rows):
        key = f"coupling[{number}]"
        _require_allowed(coupling, key, face)
        for place, way in enumerate(face.ways):
            across, forces = way in face.barred, next(every)
            if spread is None:
                own = cast(MotionForces, forces)
                found.append(FaceMotion(coupling, key, face, way, own, across))
                continue
            mean = spread.nodal[place]
            motion = MeanMotion(coupling, key, face, way, forces, across, mean)
            found.append(motion)
            forces_found.append(SpreadForce(motion, face, spread, next(spread_forces), across))
    return [*forces_found, *found]


def _require_allowed(coupling: Coupling, key: str, face: CoupledFace) -> None:
    """Refuse motions that symmetry keeps at 0, and forces that copies in a ring take away.

    Raises:
        InputError: One is given.
    """
    why = "the boundary reaches a plane of symmetry, and is one with its mirror image"
    if face.along is not None:
        why = (
            "the point is on the axis of cyclic_symmetry, and is one with its copies in the other "
            f"sectors: {face.along} is along the axis"
        )
    for way in sorted(face.barred):
        kind, axis = way
        if coupling.given.get(way, 0.0) != 0:
            raise InputError(
                f"{key}.{kind}.{axis} = {coupling.given[way]:g}: {why}, so that it cannot move so; "
                "leave it out"
            )
        if face.along is not None and coupling.acting.get(way, 0.0) != 0:
            force = "force" if kind == "displacement" else "moment"
            raise InputError(
                f"{key}.{force} along {axis} = {coupling.acting[way]:g}: {why}, and of all sectors "
                "together there is no such force; leave it out"
            )


class CoupledMotions:
    """How coupled faces move in rigid motions of the body, by their ways; collective.

    Attributes:
        given: Whether each way is given, so that it holds the body.
        held: These ways in each motion, and what springs between faces resist, on the first rank,
            (rows, motions).
        work: Work of the forces and moments of couplings on each motion, (motions,)
            (force × length).

    Args:
        scalars: Of the body, those of faces last.
        elastic: Energy of the body, with the springs between faces.
        spaces: Those of the body.
        fields: Displacements of the motions, (nodes, components, motions).
    """

    def __init__(
        self,
        scalars: Sequence[BodyScalar],
        elastic: ElasticBody,
        spaces: Spaces,
        fields: Array,
    ) -> None:
        motions = [one for one in scalars if isinstance(one, PointMotion)]
        self.given = [one.is_locked for one in motions]
        self.held, self.work = np.zeros((0, fields.shape[-1])), np.zeros(fields.shape[-1])
        if not motions:
            return
        ways = np.array([one.ways_in(fields) for one in motions])
        ways[np.abs(ways) <= 1e-12 * np.abs(ways).max()] = 0.0
        self.work = np.array([one.own_force for one in motions]) @ ways
        if spaces.comm.rank == 0:
            first = len(scalars) - len(motions)
            springs = elastic.joints.stiffness[first:, first:]
            sprung = springs @ ways / (np.abs(springs).max() or 1.0)
            self.held = np.concatenate([ways[np.array(self.given, dtype=bool)], sprung])
