"""A step of motion as a problem of statics, with another stiffness and another load.

By the midpoint rule, with A = K + 4 M/Δt² (twice the matrix of the rule as it is mostly written):
where there is mass A u₁ = f₀ + f₁ − K u₀ + λ₀ + λ₁ + 2 τ + (4 M/Δt²)(u₀ + Δt v₀), and across
contacts, where there is none, K u₁ = f₁ + λ₁. There, f are loads, λ pressures of contacts and τ
friction, which is one force for the step. So pressures act once in this balance, and friction twice
(``ContactForces.friction_weight``). Then v₁ = 2 (u₁ − u₀)/Δt − v₀; across contacts and where
supports hold (u₁ − u₀)/Δt.

Friction follows the velocity at the end of the step: it counts slip from u₀ + ½ Δt v₀, and
u₁ − u₀ − ½ Δt v₀ = ½ Δt v₁. What moves opposite has its mean velocity of the step. Slip up to ε
goes back: each step counts on from what the last has left of it, so that what sticks does not
creep.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.mass import Mass
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.damping import damping_of
from fenics_contact.problem.inertia import Inertia
from fenics_contact.problem.loads.couplings import OF_FLIGHT
from fenics_contact.problem.loads.moving_points import MovingPoints
from fenics_contact.problem.massless import ContactMasses, FreeModes, ModalMasses
from fenics_contact.problem.motion_states import (
    Drag,
    FirstState,
    MovingState,
    StepForces,
    StepStiffness,
    along_contact,
    elastic_slip,
    end_speeds,
    first_velocity,
    follow,
)
from fenics_contact.problem.scalar_unknown import BodyScalar, ScalarState
from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.motion import Motion

# Of what is brought into a motion: beyond that, steps that leave more open have its energy wrong.
_MOST_OPEN = 0.1


class MovingInertia(Inertia):
    """Masses of a problem, and the state that its present step begins from; collective.

    Attributes:
        size: Length of a step (time).
        masses: Of the nodes.
        points: Of couplings, with their masses.
        damping: What takes energy out, None where nothing does.
        stiffness: The matrix of a step, A.
        state: At the begin of the present step.
        first: At time 0.

    Args:
        motion: Of the scene.
        materials: Of the scene.
        elastic: The body.
        spaces: Likewise.
        contacts: Of the problem, which follow velocities from now on.
        held: Dofs that supports hold (local indices, owned and ghost), without coupled faces.
        scalars: Of the body.

    Raises:
        InputError: A density is missing, or a group of a velocity, or cells are too few; or a
            velocity moves a coupled face that is held.
    """

    moves = True
    most_open = _MOST_OPEN
    size: float
    stiffness: StepStiffness

    def __init__(
        self,
        motion: Motion,
        materials: Sequence[Material],
        elastic: ElasticBody,
        spaces: Spaces,
        contacts: Sequence[ContactSurface],
        held: Integers,
        scalars: Sequence[BodyScalar],
    ) -> None:
        self.size = motion.size
        self._spaces, self._contacts = spaces, contacts
        self.points = MovingPoints(motion, scalars, elastic, spaces)
        density = Mass(materials, spaces)
        shape = (len(spaces.coordinates), spaces.components)
        is_held = np.zeros(shape[0] * shape[1], dtype=bool)
        is_held[held] = True
        self._held = is_held.reshape(shape)
        masses = ContactMasses(density.lumped(), contacts, spaces, self._held)
        self.masses: ContactMasses | ModalMasses = masses
        inertial = masses.blocks * (4 / self.size**2)
        self.stiffness = StepStiffness(inertial)
        known = motion, masses.blocks, density, elastic, spaces, masses.split_forces
        self.damping = damping_of(*known)
        if self.damping is not None:
            self.stiffness = self.damping.added_to(inertial)
        self.stiffness = self.points.columns(self.stiffness)
        for contact in contacts:
            contact.act_in_motion()
        self._found: tuple[MovingState, Array, StepForces] | None = None
        self._left: tuple[MovingState, Array, Array] | None = None
        none = np.zeros(shape)
        self.state = MovingState(
            time=0.0,
            displacement=none,
            velocity=self._first_velocity(motion),
            internal=none,
            load=none,
            pressed=none,
            motions=np.zeros((len(contacts), shape[1])),
            elastic=tuple(np.zeros_like(contact.trace.normals) for contact in contacts),
            drag=Drag(none, none),
        )
        self.first = FirstState(0.0, np.zeros_like(self.state.motions), (0.0,) * len(contacts))

    def _first_velocity(self, motion: Motion) -> Array:
        """At time 0, (nodes, components) (length/time)."""
        points = self.points
        found = points.of_rigid(np.where(self._held, 0.0, first_velocity(motion, self._spaces)))
        found = found - points.of_given(found)
        points.require_held_at_rest(found)
        return found

    def modes(self, find: Callable[[ContactMasses, Flags], FreeModes]) -> FreeModes:
        """Let the bodies move in modes alone, by the matrix K of statics; collective.

        Args:
            find: Finds them, by masses at the nodes and what supports hold there.
        """
        assert isinstance(self.masses, ContactMasses)
        found = find(self.masses, self._held)
        self.masses = ModalMasses(self.masses, found, self._held, self._spaces)
        self._left = None  # by the other masses
        self.stiffness = StepStiffness(np.zeros_like(self.stiffness.nodal))
        return found

    def begin(self, load: Array) -> None:
        """Take what is given at time 0, when what stands opposite is where it is then.

        Args:
            load: At the nodes (force).
        """
        self.state = replace(self.state, load=load, motions=self._motions())

    def begin_deformed(
        self,
        displacement: Array,
        internal: Array,
        pressed: Array,
        elastic: tuple[Array, ...],
        first: FirstState,
    ) -> None:
        """Begin from bodies that are deformed and in balance, as of ``MovingState``."""
        self.first = first
        self.state = replace(
            self.state,
            displacement=displacement,
            internal=internal,
            pressed=pressed,
            elastic=elastic,
        )

    @property
    def displacement(self) -> Array:
        """Where the present step begins, (nodes, components) (length)."""
        return self.state.displacement

    @property
    def motions(self) -> Array:
        """How far what stands opposite has moved when the step begins, (contacts, components)."""
        return self.state.motions

    @property
    def energy(self) -> float:
        """Energy stored at time 0, and kinetic energy when the step begins (energy); collective."""
        return self.first.energy + self.kinetic_energy(self.state.velocity)

    def _motions(self) -> Array:
        """How far what stands opposite has moved at present, (contacts, components) (length)."""
        return np.reshape(
            [one.kinematics.translation for one in self._contacts], self.motions.shape
        )

    def follow_velocities(self) -> None:
        """Let friction count from where no velocity is left at the end of the step; collective."""
        state, now = self.state, self._motions()
        moved = state.displacement + 0.5 * self.size * state.velocity
        opposite, taken = 0.5 * (state.motions + now), (now - state.motions) / self.size
        every = zip(self._contacts, opposite, taken, state.elastic, strict=True)
        for number, (contact, motion, velocity, elastic) in enumerate(every):
            if contact.friction.has_friction:
                contact.friction.accept(along_contact(contact, moved, motion) - elastic)
            if contact.friction.follows_speed and state.sliding is not None:
                contact.follow_speed(state.sliding[number])
            elif contact.friction.follows_speed:
                first = along_contact(contact, state.velocity, velocity)
                contact.follow_speed(np.linalg.norm(first, axis=1))

    def goes_by_end(self) -> bool:
        """Let friction go by speeds at the end of the step, as it was solved; collective.

        What begins to slide in it would else do so under the friction of what sticks.

        Returns:
            Whether that makes it another, so that the step is to be solved again.
        """
        if not any(contact.friction.follows_speed for contact in self._contacts):
            return False
        speeds = end_speeds(self._contacts, self.size)
        self.state = replace(self.state, sliding=speeds)
        return follow(self._contacts, speeds)

    def advance(self, time: float, displacement: Array, step: StepForces, load: Array) -> None:
        """A step is done: the next one begins at its end.

        Args:
            time: At its end.
            displacement: Then (length).
            step: What it needed.
            load: That was given then (force).
        """
        self.state = MovingState(
            time=time,
            displacement=displacement,
            velocity=step.velocity,
            internal=step.internal,
            load=load,
            pressed=step.pressed,
            motions=self._motions(),
            elastic=tuple(elastic_slip(contact) for contact in self._contacts),
            sliding=end_speeds(self._contacts, self.size),
            drag=step.drag,
        )

    def kinetic_energy(self, velocity: Array) -> float:
        """½ v · M v (energy); collective.

        Args:
            velocity: Of the nodes, (nodes, components) (length/time).
        """
        own, momenta = slice(self._spaces.owned_nodes), self.masses.times(velocity)
        momenta = momenta + self.points.momenta(velocity)
        return float(0.5 * total(self._spaces.comm, np.sum(velocity[own] * momenta[own])))

    @property
    def missing(self) -> Array:
        """Force out of balance across contacts at the begin of the step (force).

        Only of the first one: where nothing has mass, a load that acts at once moves it at once.
        """
        return self._left_at_begin[0] - self.state.drag.across

    @property
    def _left_at_begin(self) -> tuple[Array, Array]:
        """Forces out of balance at the begin of the step: at what has no mass, and at masses."""
        state = self.state
        if self._left is None or self._left[0] is not state:
            left = state.load - state.internal + state.pressed
            self._left = state, *self.masses.split_forces(left)
        return self._left[1:]

    def applied(self, effective: Array, load: Array) -> Array:
        """Sizes of forces that an imbalance is small against, not those of a flight (force)."""
        return np.abs(load) + np.abs(self.state.internal) + OF_FLIGHT * np.abs(effective)

    def times(self, vectors: Array) -> Array:
        """4 M/Δt² times vectors at the nodes."""
        return np.asarray(self.masses.times(vectors) * (4 / self.size**2))

    @property
    def predicted(self) -> Array:
        """Where nodes are at the end of the step if no force acts, (nodes, components) (length)."""
        return self.state.displacement + self.size * self.state.velocity

    def effective_load(self, load: Array) -> Array:
        """The right-hand side of the step, but for contacts that press and rub (force).

        Args:
            load: That is given at the end of the step (force).
        """
        state = self.state
        flown = self.predicted + self.points.lag(state)
        found = load + self._left_at_begin[1] + self.times(flown)
        if self.damping is None:
            return found
        return found + self.damping.pull(state.displacement, state.internal, state.drag)

    def follow_points(self) -> None:
        """Give points of couplings what the step begins from, once these have its time."""
        self.points.begin(self.state)

    def of_given(self, vectors: Array) -> Array:
        """The part of vectors at nodes along what supports and couplings give."""
        return np.where(self._held, vectors, 0.0) + self.points.of_given(vectors)

    def forces(
        self,
        displacement: Array,
        balanced: Array,
        load: Array,
        pressed: Array,
        scalars: Sequence[ScalarState],
    ) -> StepForces:
        """Forces of a step, from the answer of its system; the same object for the same step.

        Args:
            displacement: At its end (length).
            balanced: What its system makes of u₁: A u₁, or K u₁ where modes move (force).
            load: The ``effective_load`` that it was solved with (force).
            pressed: Forces of pressures at its end (force).
            scalars: States of the body's scalars.
        """
        known = self._found
        if known is None or known[0] is not self.state or known[1] is not displacement:
            found = self._forces(displacement, balanced, load, pressed, scalars)
            self._found = known = self.state, displacement, found
        return known[2]

    def _forces(
        self,
        displacement: Array,
        balanced: Array,
        load: Array,
        pressed: Array,
        scalars: Sequence[ScalarState],
    ) -> StepForces:
        """Forces of a step; see ``forces``."""
        stiffness = self.stiffness
        added = np.einsum("nij,nj->ni", stiffness.nodal, displacement) + self.points.tied(scalars)
        internal = (balanced - added) / stiffness.of_bulk
        velocity = self._velocity(displacement)
        if not self.masses.in_matrix:
            balanced = internal + self.times(displacement)
        slowed = (self.state.velocity - velocity) / self.size
        needed = self.masses.needed(balanced - load, pressed, slowed)
        dragged, drag = self._drag(displacement, internal)
        return StepForces(
            internal=internal,
            needed=needed,
            velocity=velocity,
            pressed=pressed,
            dragged=dragged,
            drag=drag,
        )

    def _drag(self, displacement: Array, internal: Array) -> tuple[Array, Drag]:
        """Force of damping in a step, and its state at the end; collective."""
        state, spaces = self.state, self._spaces
        if self.damping is None:
            return np.zeros_like(internal), state.drag
        moved = displacement - state.displacement
        dragged, drag = self.damping.drag(moved, internal - state.internal, state.drag)
        every = dragged + self.points.dragged(moved)
        work = np.sum((every * moved)[: spaces.owned_nodes])
        return dragged, replace(drag, lost=drag.lost + float(total(spaces.comm, work)))

    def _velocity(self, displacement: Array) -> Array:
        """At the end of a step."""
        mean = (displacement - self.state.displacement) / self.size
        _, more = self.masses.split_motions(mean - self.state.velocity)
        more = np.where(self._held, 0.0, more)
        return mean + more - self.points.of_given(more)


def moving(inertia: Inertia) -> MovingInertia:
    """The inertia of a problem whose bodies move, for whoever has to do with these alone."""
    assert isinstance(inertia, MovingInertia)
    return inertia
