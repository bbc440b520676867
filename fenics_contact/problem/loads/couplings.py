"""The motions of faces that are rigid, as scalar unknowns of the problem."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, cast

import numpy as np
from ufl.core.expr import Expr

from fenics_contact.body.coupled_face import CoupledFace, MotionForces
from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.problem.scalar_unknown import (
    BodyScalar,
    KnownProblem,
    ScalarState,
    ScalarUnknown,
)
from fenics_contact.scene.loading.couplings import Coupling, Way
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.values import AXES


class FaceMotion(BodyScalar):
    """One way in which a coupled face moves, as a length q: its force N(u, q) = F, or q is given.

    N is the work of K u on the face over q, F that of the coupling's force or moment and of the
    loads that act on the nodes of the face.

    Attributes:
        way: Along or about which axis.

    Args:
        scene: The coupling.
        key: Its key, for messages.
        face: The face.
        way: Along or about which axis.
        forces: What a unit of it does to the body.
        is_mirrored: Whether symmetry keeps it at 0, as the face and its mirror image are one.
    """

    has_slack: ClassVar[bool] = False

    def __init__(
        self,
        scene: Coupling,
        key: str,
        face: CoupledFace,
        way: Way,
        forces: MotionForces,
        is_mirrored: bool,
    ) -> None:
        super().__init__(f"{'.'.join(way)} of {scene.label}", forces)
        self.scene, self.way, self._face, self._motion = scene, way, face, forces
        self._path = KeyedPath(scene.path, f"{key}.path")
        self._is_given = is_mirrored or way in scene.given
        self._amount = 0.0 if is_mirrored else face.amount(way, scene.given.get(way, 0.0))
        self._work = face.work(way, scene.acting.get(way, 0.0))
        self._factor, self._by_loads, self._besides = 0.0, 0.0, 0.0

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
        """Work over q of the coupling's force and of loads on its face (force)."""
        return self._work * self._factor + self._by_loads

    @property
    def own_force(self) -> float:
        """Force of the coupling on the scalar without loads on its face; 0 where q is given."""
        return 0.0 if self._is_given else self._work * self._factor

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
    def held(self) -> float | None:
        """The motion that is given at present; None where its equation finds it (length)."""
        return self._amount * self._factor if self._is_given else self._kept_at

    @property
    def start(self) -> float:
        """The motion at which a load step begins (length)."""
        return self._reached if self.held is None else self.held

    @property
    def moved(self) -> Array:
        """Displacement of a unit of it, 0 off the face, (nodes, components)."""
        return self._motion.moved

    def set_time(self, time: float, more: float = 0.0) -> None:
        """Bring force and given motion to a pseudo-time."""
        self._factor = self._path(time)
        self._besides = more * time

    def follow_loads(self, nodal: Array) -> None:
        """Take the loads on the face into account; collective.

        Args:
            nodal: Of the present time, (nodes, components) (force).
        """
        own = slice(self._motion.spaces.owned_nodes)
        works = float(np.sum(self._motion.moved[own] * nodal[own]))
        self._by_loads = float(total(self._motion.spaces.comm, works)) + self._besides

    def state_at(self, force: float, value: float) -> ScalarState:
        """State in an answer; its work is that of the displacement of the face's nodes."""
        return ScalarState(force, value, self.is_locked, works=False)

    def amount_of(self, value: float) -> float:
        """Displacement or rotation of a value of the scalar (length, radian)."""
        return value / self._face.amount(self.way, 1.0)

    def force_of(self, stress: Expr) -> Expr | None:
        """None: all its force is that of nodal forces on the face."""
        return None


def face_motions(problem: KnownProblem) -> list[ScalarUnknown]:
    """Return a scalar for each way of each coupling of the scene, in its order; collective.

    Raises:
        InputError: A motion is given that symmetry does not allow.
    """
    elastic, found = problem.elastic, list[ScalarUnknown]()
    motions = iter(elastic.scalar_forces[len(elastic.preloaded) :])
    held = problem.supports.held
    rows = zip(problem.scene.coupling, elastic.faces, held.by_couplings, strict=True)
    for number, (coupling, face, at) in enumerate(rows):
        mirrored = {AXES[axis] for axis in held.reached_planes(at.dofs)}
        for way in face.ways:
            kind, axis = way
            across = axis in mirrored if kind == "displacement" else bool(mirrored - {axis})
            if across and coupling.given.get(way, 0.0) != 0:
                raise InputError(
                    f"coupling[{number}].{kind}.{axis} = {coupling.given[way]:g}: the boundary "
                    "reaches a plane of symmetry, and is one with its mirror image, so that it "
                    "cannot move so; leave it out"
                )
            forces = cast(MotionForces, next(motions))
            found.append(FaceMotion(coupling, f"coupling[{number}]", face, way, forces, across))
    return found


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
        motions = [one for one in scalars if isinstance(one, FaceMotion)]
        self.given = [one.is_locked for one in motions]
        self.held, self.work = np.zeros((0, fields.shape[-1])), np.zeros(fields.shape[-1])
        if not motions:
            return
        own, comm = slice(spaces.owned_nodes), spaces.comm
        moved = np.array([one.moved[own] for one in motions])
        gram = total(comm, np.einsum("inc,jnc->ij", moved, moved))
        products = total(comm, np.einsum("inc,ncm->im", moved, fields[own]))
        ways = np.linalg.pinv(np.asarray(gram), hermitian=True) @ products
        ways[np.abs(ways) <= 1e-12 * np.abs(ways).max()] = 0.0
        self.work = np.array([one.own_force for one in motions]) @ ways
        if comm.rank == 0:
            first = len(scalars) - len(motions)
            springs = elastic.joints.stiffness[first:, first:]
            sprung = springs @ ways / (np.abs(springs).max() or 1.0)
            self.held = np.concatenate([ways[np.array(self.given, dtype=bool)], sprung])
