"""The discrete problem: one energy term for each thing the scene names, and no more.

I_ε(v) = ½ a(v, v) − f(v) + Σ j_ε(v) (paper, (2.1), (2.7)), with penalties where the contact
is not prescribed (4.1): every form comes from its energy by UFL's derivative, and is
compiled once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial

import numpy as np

from fenics_contact.body.description import BodyDescription, temperatures_at
from fenics_contact.body.probe_points import DisplacementPoints
from fenics_contact.body.supports import AppliedSupport, Supports
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.mesh.tagged_mesh import Body, Group
from fenics_contact.problem.conduction.conduction import Conduction
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.far_field import FarField
from fenics_contact.problem.inertia import AtRest, Inertia, with_time_step
from fenics_contact.problem.loads import given_loads
from fenics_contact.problem.loads.acting_load import LoadSite
from fenics_contact.problem.loads.disturbance import Disturbance, Drive
from fenics_contact.problem.loads.spring_feet import SpringFeet
from fenics_contact.problem.loads.temperatures import ThermalStrain
from fenics_contact.problem.massless import touching_nodes
from fenics_contact.problem.moving import MovingInertia
from fenics_contact.problem.scalar_kinds import Shortening, scalars_of
from fenics_contact.problem.scalar_unknown import BodyScalar, ScalarState
from fenics_contact.problem.support_moments import SupportMoments
from fenics_contact.problem.terms import SharedReactions, Term, terms_of
from fenics_contact.results.contact_points import of_several_contacts
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import differing

# Keys of a scene of which a problem that is there already takes the values.
_VALUES = {"title", "contact", "load"}


class Problem:
    """Spaces, supports, energies and compiled forms of a scene on a body.

    Args:
        scene: What is done to the body; the body is to be that of the scene.
        discrete: The body, for this problem alone until it is done with.
        timings: What the parts of it took, to add to.
        by_points: Work out forces of contacts and tangents point by point, where all their points
            are nodes: without the compiled forms, which a few points cost more than they are worth.

    Attributes:
        displacement: The unknown, a dolfinx function.
        supports: Supports and planes of symmetry.
        applied_supports: Those and the outer boundary of a half-space, for reactions.
        stabilisation: Those among them that hold what nothing resists, one a body.
        constrained: Dofs that these hold, sorted (local indices, owned and ghost).
        prescribed: Their present displacements, but for unknown resultants' part (length).
        contacts: In scene order.
        own_arrays: What their laws keep of their own at the points, and results have.
        unknowns: Scalars that are found together with the displacements, those of the body last.
        body_scalars: Those of the body.
        inertia: Masses, and what a step of motion begins from; of bodies at rest there are none.
        far_field: The outer boundary of a half-space, or None.
        points: Where the displacement is a quantity.
        conduction: Of heat, which finds the temperatures; None where the scene has no heat.
        loads: Those of the scene that are not zero.
        feet: Of the springs of elastic supports.
        load_site: The body that they act on.
        elastic: ½ a(·, ·): law, compiled forms, stress.
        given_load: Present nodal loads with the prescribed contact pressures and the forces of
            springs whose feet are moved, (nodes, components).
        load: What acts at the nodes in the balance to solve: the same, but in a step of motion.
        pressure_load: The part of it that is prescribed contact pressures.
        disturbance: Forces besides the scene's that grow with time, to see what they do, or None.
        scalar_disturbance: Right-hand sides of the equations of the body's scalars over pseudo-time
            besides the scene's, likewise, (body_scalars,) (force).
        drive: Forces besides the scene's while all that this says rests, or None.
    """

    def __init__(
        self,
        scene: Scene,
        discrete: DiscreteBody,
        timings: Timings | None = None,
        by_points: bool = False,
    ) -> None:
        timings = timings or Timings()
        discrete.require_fit(scene)
        by_points = by_points or not discrete.elastic.is_linear  # areas change, forms do not
        scene = self.scene = with_time_step(scene, discrete.elastic, discrete.spaces)
        self.discrete = discrete
        self.spaces, self.displacement = discrete.spaces, discrete.displacement
        self.elastic, self.constrained = discrete.elastic, discrete.constrained
        self.body = self.spaces.body
        self.comm = self.spaces.comm
        self.disturbance: Disturbance | None = None
        self.drive: Drive | None = None
        self._shares: list[float] | None = None  # of the loads, at the present time
        self.stabilisation: list[AppliedSupport] = []
        with timings.phase("compile"):
            self.supports = self._supports()
            self.applied_supports = list(self.supports.applied)
            self.contacts = [
                ContactSurface(contact, f"contact[{number}]", sides, self.constrained, self.elastic)
                for number, (contact, sides) in enumerate(
                    zip(scene.contact, discrete.sides, strict=True)
                )
            ]
            self._find_exact_forces()
            self.inertia: Inertia = AtRest(self.contacts, self.spaces)
            for contact in self.contacts if by_points else ():
                contact.forces.go_by_points()
            own_arrays = [array for contact in self.contacts for array in contact.own_arrays]
            self.own_arrays = of_several_contacts(own_arrays)
            self.far_field = self._place_far_field()
            self.unknowns = scalars_of(self)
            self.body_scalars = [one for one in self.unknowns if isinstance(one, BodyScalar)]
            self.scalar_disturbance = np.zeros(len(self.body_scalars))
            self._refuse_held_contacts()
            self.points = discrete.once(
                f"points {scene.point}", partial(DisplacementPoints, scene.point, self.spaces)
            )
            self.conduction: Conduction | None = None
            if scene.heat:
                self.conduction = Conduction(scene, self.spaces, self.contacts, discrete.cut)
                discrete.serve_many()  # a load step is solved for one temperature after the other
            self.load_site = LoadSite(discrete, scene.material)
            self._find_loads()
            self.feet = SpringFeet(self.elastic, scene, self.spaces)
            self.feet.require_agreement(self.supports, scene, self.spaces)
            if not by_points:
                for term in self.terms:
                    term.compiled()
        with timings.phase("assemble"):
            self._assemble_loads(by_points)
            self._pressures = self._assemble_pressures()
            self.inertia = self._place_masses()
            self.set_time(scene.load_steps.all_times[-1])
        if discrete.cut is not None:
            discrete.cut.require_held_alike(self.constrained, self.prescribed)

    @classmethod
    def on_mesh(cls, scene: Scene, body: Body, timings: Timings | None = None) -> Problem:
        """The problem of a scene on its mesh, with a body of its own; collective."""
        timings = timings or Timings()
        with timings.phase("compile"):
            discrete = DiscreteBody(BodyDescription.of(scene), body)
        # Of a motion there are many steps, each of little work: forms would cost more than that.
        return cls(scene, discrete, timings, by_points=scene.motion is not None)

    def begin_again(self, scene: Scene) -> bool:
        """Be the problem of another scene that differs in values, before anything acts; collective.

        Nothing is made anew but loads and the laws of contacts.

        Args:
            scene: Of the same body.

        Returns:
            Whether it is; False where more differs, so that a problem has to be made.

        Raises:
            InputError: The scene cannot have such a value; this one is no problem any more then.
        """
        serves = not (self.stabilisation or self.conduction) and not self.inertia.moves
        if not serves or differing(self.scene, scene) - _VALUES:
            return False
        pairs = list(zip(self.contacts, scene.contact, strict=False))
        if len(pairs) < len(scene.contact) or not all(one.serves(other) for one, other in pairs):
            return False
        loads_differ = self.scene.load != scene.load
        self.scene = scene
        for contact, other in pairs:
            contact.begin_again(other)
        self._find_exact_forces()
        for scalar in self.body_scalars:
            scalar.keep(None)
        self.reach(np.zeros(len(self.unknowns)))
        before, self._pressures = self._pressures, self._assemble_pressures()
        if before or self._pressures:
            self._shares = None
        if loads_differ:
            self._find_loads()
            self._assemble_loads(by_points=True)
        self.set_time(scene.load_steps.all_times[-1])
        return True

    def _find_exact_forces(self) -> None:
        """Have contacts of exact scenes exert nothing until their forces are found."""
        for contact in self.contacts if self.scene.is_exact else ():
            contact.find_forces(*contact.contact.exact_parameters)

    def _find_loads(self) -> None:
        """The loads of the scene; collective."""
        self.loads = given_loads(self.scene.load, self.load_site)
        for one in self.body_scalars:
            one.take_loads([(load.acting.acceleration_at, load.path) for load in self.loads])

    def _assemble_loads(self, by_points: bool) -> None:
        """Nodal forces of loads, with their paths; collective."""
        units = self.discrete.found.setdefault("loads", {}) if by_points else None
        self._loads = [
            (one.nodal() if units is None else one.nodal_of_units(units), load.path)
            for load in self.loads
            for one in (load.acting,)
        ]
        self._shares = None

    @cached_property
    def shared_reactions(self) -> SharedReactions:
        """The dofs that several supports hold; once all supports are there; collective."""
        return SharedReactions(self.applied_supports, self.spaces, self.elastic)

    @cached_property
    def support_moments(self) -> SupportMoments:
        """Points of the moments of reactions; once all supports are there; collective."""
        return SupportMoments(self.scene, self.applied_supports, self.discrete)

    @property
    def frictional(self) -> list[ContactSurface]:
        """The contacts that have a friction term."""
        return [contact for contact in self.contacts if contact.friction.has_friction]

    @property
    def coulomb(self) -> list[ContactSurface]:
        """The contacts whose friction depends on a pressure that is not known."""
        return [contact for contact in self.contacts if contact.is_coulomb]

    @property
    def free(self) -> Flags:
        """Whether each displacement component is held by no support, (nodes, components)."""
        free = np.ones(self.load.size, dtype=bool)
        free[self.constrained] = False
        return free.reshape(self.load.shape)

    @property
    def between_bodies(self) -> bool:
        """Whether some contact is between two deformable surfaces."""
        return any(contact.contact.against is not None for contact in self.contacts)

    @property
    def can_update_pairing(self) -> bool:
        """Whether what faces what may change: two bodies touch, and there are load steps."""
        return self.between_bodies and self.scene.load_steps.several

    @property
    def has_datum(self) -> bool:
        """Whether displacements have a datum: those of a half-plane grow without end."""
        return self.far_field is None or self.spaces.kinematics != "plane strain"

    def is_loaded(self, group: Group) -> bool:
        """Whether a load acts on some of the facets of a group."""
        loaded = [found for load in self.scene.load if (found := self.body.find(load.on))]
        loaded = [other for other in loaded if other.dimension == group.dimension]
        return any(set(group.tags) & set(other.tags) for other in loaded)

    def _supports(self) -> Supports:
        """Supports of the scene; of a body that is kept those of its last problem, if the same."""
        before = self.discrete.found.get("supports")
        found = None if before is None else before.again(self.scene)
        found = found or Supports(self.scene, self.spaces, self.discrete.held)
        if self.discrete.is_kept:
            self.discrete.found["supports"] = found.again(self.scene)
        return found

    def _place_masses(self) -> Inertia:
        """Masses where bodies move, at time 0; collective."""
        scene = self.scene
        if scene.motion is None:
            return self.inertia
        body = scene.material, self.elastic, self.spaces
        held = np.setdiff1d(self.constrained, self.coupled)
        self._require_apart_from_couplings()
        found = MovingInertia(scene.motion, *body, self.contacts, held, self.body_scalars)
        self._loads = [
            (found.masses.with_masses(nodal) if load.acting.is_of_volume else nodal, path)
            for load, (nodal, path) in zip(self.loads, self._loads, strict=True)
        ]
        self.set_time(0.0)
        found.begin(self.given_load)
        return found

    def _require_apart_from_couplings(self) -> None:
        """Refuse nodes of contacts that couplings move, where bodies move; collective.

        Such a node would hit with all that is coupled, and rebound in every step anew.

        Raises:
            InputError: On every rank.
        """
        faces = zip(self.scene.coupling, self.elastic.faces, strict=True)
        of_faces = [(coupling.label, face.nodes) for coupling, face in faces]
        for number, contact in enumerate(self.contacts if of_faces else ()):
            touching = touching_nodes(contact, self.spaces)
            for label, nodes in of_faces:
                if total(self.comm, int(touching[nodes].sum())):
                    raise InputError(
                        f"contact[{number}]: shares nodes with the coupling '{label}', which would "
                        "hit with all of its mass, and not by the elasticity behind; where bodies "
                        "move, leave a row of cells between both"
                    )

    @property
    def acting_loads(self) -> list[tuple[str, Array, float]]:
        """Name of each load, its nodal forces for a factor of 1, and its present factor."""
        rows = zip(self.loads, self._loads, self._load_shares, strict=True)
        return [(load.name, nodal, share) for load, (nodal, _), share in rows]

    def take_loads(self, other: Problem) -> None:
        """Have the loads of another problem of the same scene, node by node.

        Args:
            other: Of the same body, in which weights may act at other nodes.
        """
        self._loads, self._shares = other._loads, None

    def _place_far_field(self) -> FarField | None:
        """Hold the outer boundary of a half-space, by forces known or unknown."""
        if self.scene.half_space is None:
            return None
        if self.between_bodies:
            raise InputError(
                "half_space: the far field is that of forces of obstacles; leave it out where "
                "bodies touch each other (contact.against), and let the mesh reach farther"
            )
        far_field = FarField(self.scene, self.discrete, self.contacts)
        nothing = np.zeros(len(far_field.dofs))
        self.applied_supports.append(AppliedSupport(far_field.on, far_field.dofs, nothing))
        return far_field

    def stabilise(self, support: AppliedSupport) -> None:
        """Hold a body where nothing resists its motion; before anything is solved."""
        self.stabilisation.append(support)
        self.applied_supports.append(support)
        self.supports.add(support)
        self.constrained = np.union1d(self.constrained, support.dofs)
        for contact in self.contacts:
            contact.follow_supports(self.constrained)
        self.set_time(self.scene.load_steps.last)

    def reach(self, scalars: Array) -> None:
        """Take the values of the scalar unknowns that a load step ended with."""
        for unknown, value in zip(self.unknowns, scalars, strict=True):
            unknown.reach(float(value))

    def of_body_scalars(self, scalars: Array) -> Array:
        """The part of values of all scalar unknowns that is the body's, (body_scalars,)."""
        return scalars[len(scalars) - len(self.body_scalars) :]

    @cached_property
    def at_places(self) -> list[int]:
        """Numbers of the supports that hold points, or edges in space."""
        found = [self.body.find(support.on) for support in self.scene.support]
        return [number for number, group in enumerate(found) if group and group.places]

    @property
    def couplings(self) -> Integers:
        """Numbers of the applied supports that are couplings."""
        first, count = len(self.scene.support), len(self.scene.coupling)
        return np.arange(first, first + count)

    @property
    def coupled(self) -> Integers:
        """Dofs of faces that move as rigid bodies (local indices, owned and ghost)."""
        held = self.supports.held.by_couplings
        return np.concatenate([np.zeros(0, dtype=np.int64), *(one.dofs for one in held)])

    @property
    def is_sprung(self) -> bool:
        """Whether there are springs besides the body."""
        return bool(self.feet or self.scene.spring)

    def momentum_of_points(self, velocity: Array) -> Array:
        """What masses at points of couplings add to M v of nodal velocities; collective.

        Args:
            velocity: v, (nodes, components).
        """
        every = [one.momentum(velocity) for one in self.body_scalars]
        return np.asarray(sum((one for one in every if one is not None), np.zeros_like(velocity)))

    def forces_of_points(self, scalars: Sequence[ScalarState]) -> dict[int, Array]:
        """Forces of points on faces that they are coupled with and that stay elastic.

        Args:
            scalars: States of the body's scalars in an answer.

        Returns:
            By number of the applied support, (nodes, components) each (force).
        """
        found: dict[int, Array] = {}
        labels = [self.applied_supports[number].label for number in self.couplings]
        for one, state in zip(self.body_scalars, scalars, strict=True):
            spread = one.on_face(state.value)
            if spread is not None:
                label, force = spread
                number = int(self.couplings[labels.index(label)])
                found[number] = found.get(number, 0.0) + force
        return found

    def pull_of_joints(self, scalars: Sequence[ScalarState]) -> Array:
        """Forces by which springs between coupled faces pull at the body's scalars back (force).

        Args:
            scalars: States of these in an answer.

        Returns:
            (body_scalars,).
        """
        values = np.array([state.value for state in scalars], dtype=np.float64)
        return self.elastic.joints.pull(values)

    @property
    def stop_tangent(self) -> Array:
        """Second derivatives of the energy of stops in the body's scalars at present."""
        return self.elastic.joints.tangent_of_stops(self._scalar_values)

    @property
    def pull_of_stops(self) -> Array:
        """Forces by which stops push the body's scalars back at present (force)."""
        return self.elastic.joints.pull_of_stops(self._scalar_values)

    @property
    def _scalar_values(self) -> Array:
        """Present values of the body's scalars, (body_scalars,) (length)."""
        return np.array([one.value for one in self.body_scalars], dtype=np.float64)

    def moved_by_scalars(self, values: Array) -> Array | None:
        """Displacement of nodes that scalars of the body move, (nodes, components) (length).

        Args:
            values: Of the body's scalars, (body_scalars,) (length).

        Returns:
            0 at other nodes; None where scalars move none.
        """
        if not self.elastic.faces:
            return None
        found = np.zeros_like(self.load)
        for scalar, value in zip(self.body_scalars, values, strict=True):
            if scalar.moved is not None:
                found += value * scalar.moved
        return found

    def on_moved(self, nodal: Array) -> Array:
        """Work of nodal forces on a unit of each scalar by the nodes that it moves; collective.

        Args:
            nodal: (nodes, components) (force).

        Returns:
            (body_scalars,) (force).
        """
        own = slice(self.spaces.owned_nodes)
        moved = [one.moved for one in self.body_scalars]
        works = [0.0 if each is None else np.sum(each[own] * nodal[own]) for each in moved]
        return np.asarray(total(self.comm, np.array(works, dtype=np.float64)))

    def scalar_states(self, displacement: Array) -> tuple[ScalarState, ...]:
        """States of the body's scalars in an answer, with its displacement; collective."""
        mean_stress = self.present_mean_stress()
        return tuple(one.state(displacement, mean_stress) for one in self.body_scalars)

    def present_mean_stress(self) -> Array:
        """Mean stress that its function has, at the dofs of this rank; else empty (stress)."""
        mixed = self.elastic.mixed
        return np.zeros(0) if mixed is None else np.array(mixed.mean_stress.x.array)

    @property
    def applied(self) -> Array:
        """Sizes of the forces at the nodes that an imbalance is small against (force)."""
        others = self.inertia.applied(self.load - self.feet.load, self.given_load)
        return others + self.feet.applied

    @property
    def follows_temperature(self) -> bool:
        """Whether what bodies are changes with temperatures: expansions found, or moduli."""
        return self.conduction is not None or self.elastic.follows_temperature

    def follow_temperature(self, time: float) -> bool:
        """Take expansions and moduli at present temperatures; whether moduli change; collective.

        Args:
            time: Pseudo-time of those that are given.
        """
        rise = None if self.conduction is None else self.conduction.rise
        has_changed = self.elastic.take_moduli(rise, temperatures_at(self.scene, time))
        if rise is not None:
            self.elastic.follow_temperature(rise)
        parts = [one for one in self.body_scalars if isinstance(one, Shortening | ThermalStrain)]
        for part, forces in zip(parts, self.elastic.forces_of_parts, strict=True):
            part.follow_forces(forces)
        return has_changed

    def stick_all(self) -> None:
        """Take every contact point to stick, for a solve to begin with."""
        for contact in self.frictional:
            contact.friction_term.tangent_state.stick_all()

    def set_time(self, time: float) -> None:
        """Bring loads, supports and obstacles to a pseudo-time; collective."""
        drive, now = self.drive, time
        if self.conduction is not None:
            self.conduction.set_time(now)
        time = self.scene.path_time(now if drive is None else drive.rest)
        self._set_loads(time)
        for more in (drive, self.disturbance):
            if more is not None:
                self.given_load += more.at(now)
        for contact in self.contacts:
            contact.set_time(time)
        for scalar, besides in zip(self.body_scalars, self.scalar_disturbance, strict=True):
            scalar.set_time(time, float(besides))
        self.inertia.follow_points()
        self.load = self.inertia.effective_load(self.given_load)
        self.inertia.follow_velocities()
        for scalar in self.body_scalars:
            scalar.follow_loads(self.load)
        self.prescribed = self.supports.at(time)
        if self.far_field is not None:
            values = self.far_field.beyond.copy()
            for number, contact in enumerate(self.contacts):
                values += (contact.force or 0.0) * self.far_field.columns[number]
            order = np.argsort(np.concatenate([self.supports.dofs, self.far_field.dofs]))
            self.prescribed = np.concatenate([self.prescribed, values])[order]

    def _set_loads(self, time: float) -> None:
        """Loads at a pseudo-time: other arrays, but where all are what they were."""
        shares = [path(time) for _, path in (*self._pressures, *self._loads)]
        self._load_shares = shares[len(self._pressures) :]
        shares = [*shares, *(foot.path(time) for foot in self.feet)]
        if shares == self._shares and self.disturbance is None and self.drive is None:
            return
        self.pressure_load = np.zeros((len(self.spaces.coordinates), self.spaces.components))
        for array, path in self._pressures:
            self.pressure_load += array * path(time)
        self.given_load = self.pressure_load.copy()
        for array, path in self._loads:
            self.given_load += array * path(time)
        self.feet.set_time(time)
        self.given_load += self.feet.load
        self._shares = shares
        if self.disturbance is not None or self.drive is not None:
            self._shares = None

    def _refuse_held_contacts(self) -> None:
        """Friction on a surface that supports hold everywhere does nothing: surely a slip."""
        for number, contact in enumerate(self.contacts):
            if contact.contact.against is not None:
                continue  # what stands opposite may move
            free = contact.owned_nodes & contact.supports.movable
            if contact.friction.has_friction and self.comm.allreduce(int(free.sum())) == 0:
                raise InputError(
                    f"contact[{number}].on = '{contact.contact.on}': supports hold every point of "
                    "it along the surface, so nothing can slip"
                )

    @property
    def terms(self) -> list[Term]:
        """The energy terms modelled."""
        return terms_of(self.elastic, self.feet, self.loads, self.unknowns, self.contacts)

    def _assemble_pressures(self) -> list[tuple[Array, Callable[[float], float]]]:
        """Nodal forces of every contact pressure that is given, with their paths."""
        return [
            (contact.trace.surface.on_body(force), path)
            for contact in self.contacts
            for force, path in contact.forces.given()
        ]
