"""A contact surface: its kinematics, its laws and what happens on it.

One object per ``[[contact]]``.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.contact.against_body import BodyKinematics
from fenics_contact.contact.against_obstacle import ObstacleKinematics
from fenics_contact.contact.contact_forces import ContactForces, ContactWork
from fenics_contact.contact.finite.current_obstacle import CurrentObstacle, along, carried_along
from fenics_contact.contact.kinematics import ContactKinematics
from fenics_contact.contact.laws.found import FoundTractions
from fenics_contact.contact.laws.friction import friction_law
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.law import ContactLaw
from fenics_contact.contact.laws.normal import acting_law, law_of
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import ContactPaths, ContactScales, LawSite
from fenics_contact.contact.laws.terms import FrictionTerm, NormalTerm
from fenics_contact.contact.laws.wear import Unworn, wear_of
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.contact.state import OPEN, SLIP, STICK, ContactState, LastStep
from fenics_contact.contact.surface.trace import SurfaceSupports
from fenics_contact.results.contact_points import of_one_contact
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.values import differing

# Keys of a contact, and of its obstacle, of which nothing is made but laws and paths.
_VALUES = {"friction_coefficient", "pressure", "interference", "obstacle"}
_DRIVES = {"indentation", "displacement", "force"}


class ContactSurface:
    """Contact of a boundary with a rigid obstacle, with a body, or with a prescribed pressure.

    Args:
        contact: What the scene says.
        key: Where, for messages.
        sides: The surfaces, which know nothing of laws; one contact at a time may have them.
        constrained: Dofs that supports hold (local indices, owned and ghost).
        elastic: The body behind.

    Attributes:
        contact: What the scene says.
        sides: Which surface it acts on, and what stands opposite.
        trace: The contact points: coordinates, weights, normals.
        nodes: Nodes among them (local, owned and ghost), which receive its forces.
        owned_nodes: Which of these this rank owns.
        supports: What supports hold of it.
        kinematics: Jump, gap and slip against what stands opposite.
        axis: Unit vector into the body of `on`, along which normal forces are measured,
            (components,); None on surfaces that wrap around.
        moduli: Stiffnesses of the body, or of the two that touch.
        facet_size: Shortest edge of the cells at the contact (length).
        scales: What automatic parameters follow from.
        paths: What drives it at a pseudo-time.
        parameters: What the scene gives of the law across it, by its names.
        force: That drives the obstacle at present, None where none does (force).
        moment: That turns it at present, None where none does (force × length).
        last_step: What is kept of the last load step.
        normal: The law across it.
        friction: The law along it.
        normal_term: How solvers use the law across it.
        friction_term: How they use the law along it.
        forces: Of both, as solvers balance them.
        found: What acts at the points where an exact solver found it; None where laws say it.
        wear: What slip wears off.
        work: Of friction and of what goes back along it.
        own_arrays: What these keep of their own at the points, and results have.
    """

    def __init__(
        self,
        contact: Contact,
        key: str,
        sides: ContactSides,
        constrained: Integers,
        elastic: ElasticBody,
    ) -> None:
        self._key = key
        self.label = contact.label
        self.sides, self.trace, self.spaces = sides, sides.trace, sides.trace.spaces
        self.nodes = self.trace.nodes
        self.owned_nodes = self.trace.owned[: len(self.nodes)]
        named = law_of(contact)
        self.contact = contact
        self.kinematics = self._kinematics(key, named, elastic.is_linear)
        self.axis = self.sides.axis(self.kinematics.axis)
        self.follow_supports(constrained)
        self.scales = ContactScales(self.sides, elastic)
        self.moduli, self.facet_size = self.scales.moduli, self.scales.facet_size
        self.force = None if contact.obstacle is None else contact.obstacle.force
        if named.pushes_only:
            self._move_to_first_contact(key)
        self._take_values(contact)

    def serves(self, contact: Contact) -> bool:
        """Whether this surface can take the values of another contact, as nothing else differs.

        Args:
            contact: The other one.
        """
        known, obstacle, other = self.contact, self.contact.obstacle, contact.obstacle
        others = differing(known, contact)
        if "obstacle" in others:
            if obstacle is None or other is None or differing(obstacle, other) - _DRIVES:
                return False
            if (obstacle.force is None) != (other.force is None):
                return False
        alone = self.forces.by_points and self.friction.neighbours is None
        is_same = alone and not others - _VALUES and known.is_rough == contact.is_rough
        return is_same and self.kinematics.paired_at is None

    def begin_again(self, contact: Contact) -> None:
        """Be another contact of the scene that this one serves, before anything acts; collective.

        Args:
            contact: The other one.
        """
        by_points = self.forces.by_points
        self.kinematics.begin_again()
        self._take_values(contact)
        if by_points:
            self.forces.go_by_points()

    def _take_values(self, contact: Contact) -> None:
        """Take the laws of a contact, and what drives it; collective."""
        self.contact, key = contact, self._key
        named = law_of(contact)
        self.paths = ContactPaths(contact, key, named.sticks)
        self.force = None if contact.obstacle is None else contact.obstacle.force
        self.moment = None if contact.obstacle is None else contact.obstacle.moment
        site = LawSite(contact, key, self.kinematics, self.scales, self.paths)
        self._penalty_parameter = named.penalty_parameter(site)
        self.parameters = named.parameters(contact)
        self.normal: NormalLaw = acting_law(contact)(site)
        self.friction: FrictionLaw = friction_law(site, self.normal)
        self.normal_term = NormalTerm(self.normal)
        self.friction_term = FrictionTerm(self.friction)
        self.forces = ContactForces(self.trace, self.normal_term, self.friction_term)
        self.found: FoundTractions | None = None
        self._follow_given()
        before = self.kinematics.gap
        if self.is_one_sided:  # where they overlap at first, pressure pushes the overlap out
            before = np.maximum(before, 0.0)
        self.last_step = LastStep(self._at_rest(), before)
        self.wear: Unworn = wear_of(site, self.friction, self.last_step)
        self.work = ContactWork(self.trace, self.normal, self.friction, self.last_step)
        declared = (law.state for law in self.laws)
        self.own_arrays = of_one_contact(*declared, self.kinematics.state)

    def _kinematics(
        self, key: str, law: type[NormalLaw], has_small_strains: bool
    ) -> ContactKinematics:
        sides = self.sides
        if not has_small_strains:
            assert self.contact.obstacle is not None
            return CurrentObstacle(self.trace, self.contact.obstacle)
        if sides.opposite is not None and sides.pairing is not None:
            return BodyKinematics(self.trace, sides.opposite, sides.pairing, key)
        obstacle = (self.contact.obstacle or Obstacle()) if law.has_counterpart else None
        return ObstacleKinematics(self.trace, obstacle, f"{key}.obstacle")

    def _move_to_first_contact(self, key: str) -> None:
        """Leave out what no obstacle can press, and bring one that a force drives up to it."""
        self.kinematics.require_one_sided(key)
        self.kinematics.leave_out(self.supports.held_across)
        if self.force is not None:
            self.kinematics.move_to_first_contact()

    @property
    def friction_bound(self) -> Array:
        """Friction bound g = coefficient × pressure at the points (stress)."""
        return self.bound_at(self.pressure())

    def bound_at(self, pressure: Array) -> Array:
        """Friction bound under a pressure of its normal law, at the points (stress).

        A bound that is given is followed as time goes on.

        Args:
            pressure: At the points (stress).
        """
        if self.normal.pressure_is_known:
            return self.friction.bound
        return self.friction.bound_of(pressure)

    @property
    def penalty_parameter(self) -> float:
        """ε₁ as used (length/stress), 0 without a penalty."""
        if self.found is None:
            return self._penalty_parameter
        return self.found.penalty_parameter if self.has_penalty else 0.0

    @property
    def regularisation_parameter(self) -> float:
        """ε as used (length), 0 without friction, and where that is found without smoothing."""
        if self.found is not None and self.friction.regularisation.is_numerical:
            return self.found.regularisation_parameter
        return self.friction.regularisation.parameter

    @property
    def is_coulomb(self) -> bool:
        """Whether its friction depends on a pressure that is not known."""
        return self.friction.has_friction and not self.normal.pressure_is_known

    @property
    def checks(self) -> tuple[str, ...]:
        """Names of the checks that its laws claim."""
        return tuple(check for law in self.laws for check in law.checks)

    @property
    def laws(self) -> tuple[ContactLaw, ...]:
        """All that it keeps arrays of, each with a name of its own."""
        return (self.normal, self.friction, self.wear)

    def act_in_motion(self) -> None:
        """Have friction act as in steps of motion: twice in the balance, and all along a step."""
        self.forces.count_friction_twice()
        self.last_step.take_ends()

    def follow_supports(self, constrained: Integers) -> None:
        """Take what supports hold from other dofs; collective.

        Args:
            constrained: Dofs that supports hold (local indices, owned and ghost).
        """
        self._constrained = constrained
        self.supports = SurfaceSupports(self.trace, constrained)

    def set_time(self, time: float) -> None:
        """Bring the obstacle to where it stands, or to what drives it, at a pseudo-time."""
        self.normal.set_time(time)
        self.kinematics.overlap_by(self.paths.interference(time), self.wear.depth)
        self._follow_given()
        if self.contact.obstacle is not None:
            self._drive(time)
        self.normal.set_gap(self.kinematics.gap)

    def set_gap(self, gap: Array) -> None:
        """Take another gap than that of where the two sides stand, until this is found again.

        Args:
            gap: Of the undeformed body, at the points (length).
        """
        self.kinematics.set_gap(gap)
        self.normal.set_gap(gap)

    def _drive(self, time: float) -> None:
        kinematics = self.kinematics
        self.force = self.paths.force(time)
        if self.force is None:
            kinematics.drive(self.paths.indentation(time))
        self.moment = self.paths.moment(time)
        if self.moment is None:
            kinematics.turn(self.paths.angle(time))
        moved = self.paths.displacement(time)
        if moved is not None or kinematics.turning.axis.any():
            shift = kinematics.displacement if moved is None else moved
            angle = kinematics.angle if self.moment is None else 0.0
            kinematics.displace(shift, angle)
        elif self.force is None:
            kinematics.stand()

    def follow_speed(self, speed: Array) -> None:
        """Let friction go by how fast points slide; collective.

        Args:
            speed: At the begin or the end of a step of motion, (points,) (length/time).
        """
        self.friction.rule.follow_speed(speed)
        self._follow_given()

    def _follow_given(self) -> None:
        """Take the bound, and the ε that it needs, from a pressure that is given; collective."""
        if self.normal.pressure_is_known:
            friction, bound = self.friction, self.friction.bound_of(self.pressure())
            friction.set_bound(bound)
            if friction.regularisation.is_automatic:
                friction.regularisation.set(friction.regularisation.needed(bound))

    def touch(self) -> None:
        """Bring an obstacle that nothing presses on until it just touches; collective."""
        if self.normal.has_counterpart and self.normal.pressure_is_known:
            self.kinematics.touch()

    def relative_sliding(self) -> float:
        """Slip of two bodies since it was found what faces what, over the size of the contact.

        Collective; 0 against an obstacle.
        """
        return self.kinematics.relative_sliding(self.pressure() > 0)

    def update_pairing(self, displacement: Array | None) -> None:
        """Repeat the contact search between two bodies; collective.

        Args:
            displacement: Of a load step, at the body's nodes of this rank; None as meshed
                (length).
        """
        self.kinematics.update_pairing(displacement)
        self.normal.set_gap(self.kinematics.gap)
        slip = self.kinematics.tangential(self.kinematics.jump_at_points())
        self.friction.accept(slip)
        self.last_step.count_from(slip)
        left = self.last_step.open_after_pairing(self.state().gap)
        self.last_step.leave_open(float(self.trace.integral(left)))

    def measure(self, displacement: Array) -> None:
        """Measure gap, normals, slip and areas at a displacement, in finite strains; collective.

        What is kept along the surface is taken along with its tangents, and forces that were found
        stay the same.

        Args:
            displacement: At the body's nodes of this rank, (nodes, 2) (length).
        """
        kinematics, trace, last = self.kinematics, self.trace, self.last_step
        assert isinstance(kinematics, CurrentObstacle)
        normals, areas = trace.normals, trace.weights
        kinematics.measure(displacement, along(last.state.slip, normals))
        turn = partial(carried_along, before=normals, now=trace.normals)
        self.friction.reference = turn(self.friction.reference)
        last.carry(turn)
        self.follow_supports(self._constrained)
        kinematics.leave_out(self.supports.held_across)
        self.normal.set_gap(kinematics.gap)
        if self.found is not None:
            share = areas / trace.weights
            traction = turn(self.found.traction) * share[:, None]
            pressure = self.found.pressure * share
            self.take_found(replace(self.found, pressure=pressure, traction=traction))

    def stand_at(self, displacement: Array) -> None:
        """Measure where what is kept along the surface was known, after going back; collective.

        Args:
            displacement: That of the load step which is gone back to, as of ``measure``.
        """
        kinematics = self.kinematics
        assert isinstance(kinematics, CurrentObstacle)
        kinematics.measure(displacement, np.zeros(len(self.trace.weights)))
        self.measure(displacement)

    def accept(self) -> None:
        """A load step is done: slip counts from here where the law is incremental; collective."""
        state = self.state()
        self.wear.advance(state)  # before the step is the last one, from whose end it goes
        self.last_step.advance(state, self.kinematics.present_gap, self.work.in_step(state))
        self.normal.advance(state)
        self.friction.advance(state)
        self.friction.accept(state.slip)
        is_open = state.status == OPEN
        if self.kinematics.begin_slip_again(is_open):
            slip = np.where(is_open[:, None], 0.0, state.slip)
            self.friction.accept(slip)
            self.last_step.count_from(slip)

    @property
    def is_path_dependent(self) -> bool:
        """Whether what it does depends on the load steps before."""
        return self.friction.follows_path or self.wear.wears

    @property
    def on_body(self) -> Flags:
        """Flags of the body's nodes that are points of the contact, (nodes,); collective."""
        ones = self.trace.at_all_nodes(np.ones(len(self.nodes)))
        return self.trace.surface.on_body(ones) > 0

    @property
    def has_unknown_position(self) -> bool:
        """Whether the obstacle's position is an unknown: a force drives it, or it is glued on.

        An obstacle that no force drives, and that pushes only, is left out.
        """
        obstacle = self.contact.obstacle
        is_driven = obstacle is not None and obstacle.force is not None
        return is_driven and not self.normal.pressure_is_known

    @property
    def has_unknown_angle(self) -> bool:
        """Whether the obstacle's angle is an unknown, as a moment turns it."""
        return self.moment is not None and not self.normal.pressure_is_known

    @property
    def gives_way(self) -> bool:
        """Whether a force or a moment drives the obstacle, so that its place is found."""
        return self.has_unknown_position or self.has_unknown_angle

    @property
    def gap_follows_angle(self) -> bool:
        """Whether the gap follows an angle that is found, by a slope that its shape decides."""
        obstacle = self.contact.obstacle
        return self.has_unknown_angle and obstacle is not None and obstacle.has_form

    @property
    def known_motion(self) -> Array:
        """Motion of the obstacle besides what is found, (components + 1,) (length, radian)."""
        kinematics = self.kinematics
        found = kinematics.motion
        if self.has_unknown_position:
            found[:-1] = kinematics.displacement
        if self.has_unknown_angle:
            found[-1] = 0.0
        return found

    @property
    def can_shear(self) -> bool:
        """Whether it can exert a force along a flat surface."""
        return self.friction.carries_shear or self.normal.exerts_shear

    @property
    def has_penalty(self) -> bool:
        """Whether ε₁ is a numerical penalty, and not a physical compliance."""
        return self.normal.has_penalty

    @property
    def is_one_sided(self) -> bool:
        """Whether it pushes only: the body may leave it."""
        return self.normal.pushes_only

    def name_of(self, term: NormalTerm | FrictionTerm) -> str:
        """Name of an energy term in results: its model, and the contact that it acts at.

        Args:
            term: One of ``forces.terms``.
        """
        smoothed = (
            self.regularisation_parameter if term is self.friction_term else self.penalty_parameter
        )
        exact = term.law.exact_model
        return f"{exact} on {self.label}" if exact and not smoothed else term.name

    def find_forces(self, penalty: float = 0.0, regularisation: float = 0.0) -> None:
        """Have no forces until an exact solver has found them.

        Args:
            penalty: ε₁ that it is to find them with (length/stress).
            regularisation: ε likewise (length).
        """
        self.take_found(FoundTractions.none(self.trace.normals, penalty, regularisation))

    def take_found(self, found: FoundTractions | None) -> None:
        """Have forces that were found act from now on; None: those of the laws again.

        Args:
            found: At the points.
        """
        self.found = found
        if found is None:
            self.normal_term.follow_law()
            self.friction_term.follow_law()
            return
        self.friction_term.hold(found.traction)
        if self.normal.pressure_is_known:
            self.normal_term.follow_law()
        else:
            self.normal_term.hold(found.pressure)
            self.friction.set_bound(self.friction.bound_of(found.pressure))

    def pressure(self) -> Array:
        """Contact pressure at the points at the present jump (stress)."""
        if self.found is not None and not self.normal.pressure_is_known:
            return self.found.pressure
        return self.normal.pressure(self.kinematics.jump_at_points())

    def follow_pressure(self) -> None:
        """Let the friction bound follow the pressure, where the two are coupled."""
        if self.friction_term.follows_pressure:
            self.friction.set_bound(self.friction_term.bound_of(self.pressure()))

    def follow(self) -> None:
        """Move the friction tangent to the present jump."""
        slip = self.kinematics.tangential(self.kinematics.jump_at_points())
        self.friction_term.linearise_at(slip)

    def state(self) -> ContactState:
        """The state of the points at the present jump: pressure, friction, slip, status."""
        jump = self.kinematics.jump_at_points()
        slip = self.kinematics.tangential(jump)
        state = (
            self._state_by_laws(jump, slip) if self.found is None else self._found_state(jump, slip)
        )
        return replace(state, own=self._own(state)) if self.own_arrays else state

    def _state_by_laws(self, jump: Array, slip: Array) -> ContactState:
        pressure = self.normal.pressure(jump)
        bound = self.bound_at(pressure)
        closed = self.normal.is_closed(pressure)
        return ContactState(
            gap=0.0 - self.normal.depth(jump),
            contact_pressure=pressure,
            friction_traction=self.normal.traction(jump) + self.friction.traction(slip),
            slip=slip,
            status=self.friction.status(closed, self.friction.scaled_slip(slip), bound),
            penalty_energy=self.normal.stored(jump),
        )

    def _found_state(self, jump: Array, slip: Array) -> ContactState:
        assert self.found is not None
        closed, sticks = self.found.closed, self.found.sticks
        return ContactState(
            gap=self._gap_without_round_off(jump, closed),
            contact_pressure=self.pressure(),
            friction_traction=self.found.traction,
            slip=slip,
            status=np.where(closed, np.where(sticks, STICK, SLIP), OPEN),
            penalty_energy=0.5 * self.penalty_parameter * self.found.pressure**2,
        )

    def _gap_without_round_off(self, jump: Array, closed: Flags) -> Array:
        """Gaps at the points at a jump, of closed points 0 where they are nothing but round-off."""
        gap, kinematics = 0.0 - self.normal.depth(jump), self.kinematics
        lengths = np.linalg.norm(jump, axis=1) + np.linalg.norm(kinematics.motion_at_points, axis=1)
        lengths += np.where(kinematics.reached, np.abs(kinematics.gap), 0.0) + self.sides.facet_size
        return np.where(closed & (np.abs(gap) <= kinematics.gap_left * lengths), 0.0, gap)

    def _own(self, state: ContactState) -> dict[str, Array]:
        """The laws' own arrays at the end of the present step, by name."""
        every: dict[str, Array] = {}
        every |= self.kinematics.shown()
        for law in self.laws:
            every |= law.kept() | law.at_step_end(state) | law.shown(state)
        return {array.name: every[array.name] for array in self.own_arrays}

    def _at_rest(self) -> ContactState:
        """The state of the points as meshed, without loads: with friction, what touches sticks."""
        nothing, vectors = np.zeros(len(self.trace.weights)), np.zeros_like(self.trace.normals)
        touches, coefficient = self.normal.touches_at_rest(), self.friction.largest_coefficient
        status = self.friction.status(touches, vectors, coefficient)
        return ContactState(self.kinematics.gap, nothing, vectors, vectors, status, nothing)
