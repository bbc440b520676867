"""Points of couplings in a step of motion: their masses, and the forces on them.

A way q of a point with a mass m, F, springs J(q) and damping d has in a step of motion, twice the
midpoint rule as the nodes have it, with the mean force N of the point on its face,

    2 N + J(q₁) + J(q₀) + (4 m/Δt²) (q₁ − q₀ − Δt q̇₀) + (2 d/Δt) (q₁ − q₀) = F₀ + F₁.

Of a rigid face 2 N is the work of the nodal balance of the step on the motion of the face, whose
nodes have their own masses. Of one that stays elastic it is twice the tie, one force for the step
as that of friction is: if it were that of the end, it would swing about its mean for ever, as
masses at both sides leave it undamped. Where q is given its velocity is (q₁ − q₀)/Δt, as supports
have it; so the point goes on from q₀ + ½ (q₁ − q₀) + ½ Δt q̇₀ in place of q₀ + Δt q̇₀.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.body.coupled_face import MotionForces
from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.preloaded_part import ScalarColumns
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, total
from fenics_contact.problem.loads.couplings import PointMotion, PointStep, SpreadForce
from fenics_contact.problem.motion_states import MovingState, StepStiffness
from fenics_contact.problem.scalar_unknown import BodyScalar, ScalarState
from fenics_contact.scene.loading.motion import Motion

# Of the largest velocity.
_AT_REST = 1e-9


class MovingPoints:
    """Ways of all points, and what the present step begins from; collective.

    Attributes:
        every: All ways of the points of all couplings.
        are_given: Whether each way is given, (ways,).
        masses: That it moves, (ways,) (mass).

    Args:
        motion: Of the scene.
        scalars: Of the body.
        elastic: The body, with the springs between points.
        spaces: Likewise.
    """

    def __init__(
        self, motion: Motion, scalars: Sequence[BodyScalar], elastic: ElasticBody, spaces: Spaces
    ) -> None:
        self._scalars, self._elastic, self._spaces = scalars, elastic, spaces
        self._size = motion.size
        self.every = [one for one in scalars if isinstance(one, PointMotion)]
        self._numbers = [scalars.index(one) for one in self.every]
        shape = (len(self.every), len(spaces.coordinates), spaces.components)
        # The mean motion of a face across a plane of symmetry is not that of its point.
        none = np.zeros(shape[1:])
        measured = [none if one.is_mirrored else one.measured for one in self.every]
        self._measured = np.array(measured).reshape(shape)
        moved = [none if one.moved is None else one.moved for one in self.every]
        self._moved = np.array(moved).reshape(shape)
        self.are_given: Flags = np.array([one.is_locked for one in self.every], dtype=bool)
        self.masses = np.array([one.mass for one in self.every])
        damped = 0.0 if motion.rayleigh is None else motion.rayleigh.mass
        self._damped = damped * self.masses
        self._begun: tuple[MovingState, Array, Array] | None = None

    def along(self, vectors: Array) -> Array:
        """How far points move by vectors at the nodes, (ways,).

        Args:
            vectors: Displacements or velocities, (nodes, components).
        """
        if not self.every:
            return np.zeros(0)
        own = slice(self._spaces.owned_nodes)
        found = np.einsum("wnc,nc->w", self._measured[:, own], vectors[own])
        return np.asarray(total(self._spaces.comm, found))

    def pushed(self, reactions: Array, scalars: Sequence[ScalarState]) -> Array:
        """Forces by which points push their faces in a step, (ways,) (force).

        Args:
            reactions: Of rigid faces, and of supports, at the nodes, (nodes, components) (force).
            scalars: States of the body's scalars.
        """
        if not self.every:
            return np.zeros(0)
        own = slice(self._spaces.owned_nodes)
        works = np.einsum("wnc,nc->w", self._moved[:, own], reactions[own])
        works = np.asarray(total(self._spaces.comm, works))
        by_ties = [scalars[number].force for number in self._numbers]
        return np.where([one.moved is None for one in self.every], by_ties, works)

    def mean_forces(
        self, begin: MovingState, ends: tuple[Array, Array], pushed: Array
    ) -> tuple[Array, Array]:
        """Mean forces on points in a step, as asked and as found, (ways,) each (force).

        Args:
            begin: State at the begin.
            ends: Displacement and velocity of the nodes at the end, (nodes, components) each.
            pushed: As of the method.
        """
        place, velocity = self._at_begin(begin)
        place_then, velocity_then = (self.along(one) for one in ends)
        pulled = self._pull(place)
        rates = self.masses * (velocity_then - velocity) + self._damped * (place_then - place)
        found = pushed + 0.5 * (pulled + self._pull(place_then)) + rates / self._size
        now = np.array([one.own_force for one in self.every])
        then = np.array([one.acting_at(begin.time) for one in self.every])
        return np.where(self.are_given, found, 0.5 * (now + then)), found

    def momenta(self, velocity: Array) -> Array:
        """Momenta of masses of points, at the nodes that tell how these move, (nodes, components).

        Args:
            velocity: Of the nodes, (nodes, components) (length/time).
        """
        return self._at_nodes(self.masses, velocity)

    def dragged(self, moved: Array) -> Array:
        """Mean force of damping on masses of points in a step, (nodes, components) (force).

        Args:
            moved: In the step, (nodes, components) (length).
        """
        return self._at_nodes(self._damped / self._size, moved)

    def _at_nodes(self, factors: Array, vectors: Array) -> Array:
        if not factors.any():
            return np.zeros_like(vectors)
        return np.tensordot(factors * self.along(vectors), self._measured, 1)

    def of_rigid(self, vectors: Array) -> Array:
        """Vectors at nodes of rigid faces as these can move, others as they are.

        Args:
            vectors: Such as velocities, (nodes, components).
        """
        if not self.every:
            return vectors
        on_faces = (self._moved != 0).any(axis=0)
        rigid = np.tensordot(self.along(vectors), self._moved, 1)
        return np.where(on_faces, rigid, vectors)

    def of_given(self, vectors: Array) -> Array:
        """The part of vectors at nodes of rigid faces along ways that are given."""
        if not self.are_given.any():
            return np.zeros_like(vectors)
        return np.tensordot(np.where(self.are_given, self.along(vectors), 0.0), self._moved, 1)

    def require_held_at_rest(self, velocity: Array) -> None:
        """Refuse a velocity at time 0 by which points move along ways that are given.

        Args:
            velocity: Of the nodes, (nodes, components) (length/time).

        Raises:
            InputError: On every rank.
        """
        size = largest(self._spaces.comm, np.abs(velocity))
        astray = np.abs(np.where(self.are_given, self.along(velocity), 0.0)) > _AT_REST * size
        for one in (self.every[number] for number in np.flatnonzero(astray)[:1]):
            raise InputError(
                f"motion.velocity: moves the boundary of the coupling '{one.scene.label}', whose "
                f"{'.'.join(one.way)} is given; leave one of the two out, or take kind = 'rigid'"
            )

    def tied(self, scalars: Sequence[ScalarState]) -> Array:
        """Forces of ties in the equations of a step, (nodes, components) (force).

        Args:
            scalars: States of the body's scalars.
        """
        found = np.zeros(self._moved.shape[1:])
        for one, state in zip(self._scalars, scalars, strict=True):
            if isinstance(one, SpreadForce):
                found += 2 * state.value * one.forces_on_body.nodal
        return found

    def columns(self, stiffness: StepStiffness) -> StepStiffness:
        """The matrix of a step with its columns of the body's scalars.

        Args:
            stiffness: Without them.
        """
        if not self.every:
            return stiffness
        first, factor = self._numbers[0], stiffness.of_bulk
        forces, corner = self._elastic.scalar_forces, self._elastic.scalar_stiffness.copy()
        nodal, stresses = [one.nodal for one in forces], [one.on_mean_stress for one in forces]
        joints = self._elastic.joints.stiffness[first:, first:]
        ties = [number for number, one in enumerate(self._scalars) if isinstance(one, SpreadForce)]
        for number in ties:
            nodal[number] = 2 * nodal[number]
            corner[number, first:] *= 2
            corner[first:, number] *= 2
        added = np.einsum("nij,wnj->wni", stiffness.nodal, self._moved)
        for number, more in zip(self._numbers, added, strict=True):
            if isinstance(forces[number], MotionForces):
                nodal[number] = factor * nodal[number] + more
                stresses[number] = factor * stresses[number]
        own = slice(self._spaces.owned_nodes)
        works = np.einsum("wnc,vnc->wv", self._moved[:, own], added[:, own])
        of_faces = factor * (corner[first:, first:] - joints) + joints
        inertial = 4 / self._size**2 * self.masses + 2 / self._size * self._damped
        of_faces += np.asarray(total(self._spaces.comm, works)) + np.diag(inertial)
        corner[first:, first:] = of_faces
        columns = ScalarColumns(nodal, stresses, corner)
        return StepStiffness(stiffness.nodal, stiffness.of_bulk, columns)

    def begin(self, state: MovingState) -> None:
        """Give points what the present step begins from, but for loads on their faces.

        Args:
            state: At its begin.
        """
        if not self.every:
            return
        place, velocity = self._at_begin(state)
        acting = np.array([one.acting_at(state.time) for one in self.every]) - self._pull(place)
        start = place + self._size * velocity
        given = np.array([0.0 if one.held is None else one.held for one in self.every])
        on = np.where(self.are_given, 0.5 * (place + given + self._size * velocity), start)
        force = (
            acting + 4 / self._size**2 * self.masses * on + 2 / self._size * self._damped * place
        )
        for one, *parts in zip(self.every, force, acting, start, strict=True):
            one.take_step(PointStep(*map(float, parts)))

    def lag(self, state: MovingState) -> Array:
        """How much less far than by its velocity a step takes given faces, (nodes, components).

        Args:
            state: At its begin.
        """
        if not self.are_given.any():
            return np.zeros_like(state.displacement)
        place, velocity = self._at_begin(state)
        given = np.array([0.0 if one.held is None else one.held for one in self.every])
        less = np.where(self.are_given, 0.5 * (given - place - self._size * velocity), 0.0)
        return np.tensordot(less, self._moved, 1)

    def _at_begin(self, state: MovingState) -> tuple[Array, Array]:
        """Places and velocities of points at the begin of a step, (ways,) each."""
        if self._begun is None or self._begun[0] is not state:
            self._begun = state, self.along(state.displacement), self.along(state.velocity)
        return self._begun[1:]

    def values(self, displacement: Array) -> Array:
        """Values that ways of points have, 0 of the body's other scalars, (scalars,) (length).

        Args:
            displacement: At the nodes, (nodes, components) (length).
        """
        return self._values(self.along(displacement))

    def _values(self, place: Array) -> Array:
        found = np.zeros(len(self._scalars))
        found[self._numbers] = place
        return found

    def _pull(self, place: Array) -> Array:
        """Forces by which springs pull points back, (ways,) (force)."""
        return np.asarray(self._elastic.joints.pull(self._values(place))[self._numbers])
