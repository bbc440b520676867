"""A contact surface: its kinematics, energy terms and what happens on it.

One object per ``[[contact]]``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import ufl
from numpy.typing import NDArray

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.supports import Supports
from fenics_contact.common import form_cache
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest
from fenics_contact.contact.contact_history import ContactHistory
from fenics_contact.contact.driving import ContactPaths
from fenics_contact.contact.kinematics.against_body import BodyKinematics
from fenics_contact.contact.kinematics.against_obstacle import ObstacleKinematics
from fenics_contact.contact.kinematics.jump import ContactKinematics
from fenics_contact.contact.laws.friction_term import FrictionTerm
from fenics_contact.contact.laws.normal_contact import prescribed_pressure_energy
from fenics_contact.contact.laws.normal_term import NormalTerm
from fenics_contact.contact.parameters import ContactScales
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.contact.state import OPEN, SLIP, STICK, ContactState
from fenics_contact.contact.surface.supports import SurfaceSupports
from fenics_contact.scene.contact import Contact, Obstacle
from fenics_contact.scene.values import Value

Array = NDArray[np.float64]

_NAMES = {
    "unilateral": "unilateral contact (penalty)",
    "winkler": "Winkler foundation",
    "bonded": "bonded contact (penalty)",
}


class ContactSurface:
    """Contact of a boundary with a rigid obstacle, or with a prescribed pressure.

    Attributes:
        contact: What the scene says.
        sides: Which surface it acts on, and what stands opposite.
        trace: The contact points: coordinates, weights, normals.
        nodes: Nodes among them (local, owned and ghost), which receive its forces.
        owned_nodes: Which of these this rank owns.
        supports: What supports hold of it.
        kinematics: Jump, gap and slip against the obstacle.
        axis: Unit vector into the body of `on`, along which normal forces are measured,
            (components,); None on surfaces that wrap around.
        moduli: Stiffnesses of the body, or of the two that touch.
        facet_size: Shortest edge of the cells at the contact (length).
        scales: What automatic parameters follow from.
        penalty_parameter: ε₁ as used (length/stress), 0 without a penalty.
        pressure_load: Compiled linear form of a prescribed pressure's work on the surface, or None.
        paths: What drives it at a pseudo-time.
        force: That drives the obstacle at present, None where none does (force).
        history: What it keeps of its last load step.
        is_scaled: Whether ε is known: the scene gives it, or a pressure was found for it.
        normal: Penalty, foundation or glue; None where prescribed, or driven by no force.
        friction: The term of j_ε, or None without friction.
    """

    def __init__(
        self,
        contact: Contact,
        key: str,
        spaces: Spaces,
        supports: Supports,
        constrained: NDArray[np.int64],
        elastic: ElasticBody,
        masters: Sequence[str] = (),
    ) -> None:
        self.contact = contact
        self.label = contact.label
        self.spaces = spaces
        self.sides = ContactSides(contact, key, spaces, supports.flat_sides, masters)
        self.trace = self.sides.trace
        self.nodes = self.trace.nodes
        self.owned_nodes = self.trace.owned[: len(self.nodes)]
        self.kinematics = self._kinematics(key, constrained)
        self.axis = self.sides.axis(self.kinematics.axis)
        self.supports = SurfaceSupports(self.trace, constrained)
        self.scales = ContactScales(self.sides, elastic)
        self.moduli, self.facet_size = self.scales.moduli, self.scales.facet_size
        self._full_pressure = self._given(contact.pressure or 0.0, f"{key}.pressure")
        self._given_pressure = self._full_pressure
        self.paths = ContactPaths(contact, key)
        if contact.kind in ("unilateral", "winkler"):
            self.kinematics.require_one_sided(key)
            self._bring_up()
        self.force = None if contact.obstacle is None else contact.obstacle.force
        self.penalty_parameter = self.scales.penalty_parameter(contact)
        self.normal = self._normal_term(f"{key}.foundation_stiffness")
        coefficient = self._given(contact.friction_coefficient, f"{key}.friction_coefficient")
        if contact.law == "none" or (contact.kind != "prescribed" and self.normal is None):
            coefficient = np.zeros_like(coefficient)
        self.pressure_load = self._pressure_form()
        self.is_scaled = False
        self.friction = self._friction_term(coefficient)
        self._set_regularisation()
        before = self.kinematics.gap
        if self.is_one_sided:  # where they overlap at first, pressure pushes the overlap out
            before = np.maximum(before, 0.0)
        self.history = ContactHistory(self._at_rest(coefficient), before)

    def _kinematics(self, key: str, constrained: NDArray[np.int64]) -> ContactKinematics:
        if self.sides.opposite is not None:
            return BodyKinematics(self.trace, self.sides.opposite, constrained, key)
        described = self.contact.obstacle or Obstacle()
        prescribed = self.contact.kind == "prescribed"
        return ObstacleKinematics(self.trace, None if prescribed else described, f"{key}.obstacle")

    def _bring_up(self) -> None:
        """Leave out what no obstacle can press, and bring one that a force drives up to it."""
        kinematics, obstacle = self.kinematics, self.contact.obstacle
        if not isinstance(kinematics, ObstacleKinematics):
            return
        kinematics.leave_out(self.supports.held_across)
        if obstacle is not None and obstacle.force is not None:
            kinematics.bring_up()

    def _friction_term(self, coefficient: Array) -> FrictionTerm | None:
        comm = self.spaces.comm
        bound = coefficient * (self._given_pressure if self.normal is None else 1.0)
        if largest(comm, bound) == 0:
            return None
        term = FrictionTerm(
            f"regularised friction on {self.label}",
            self.trace,
            self.kinematics.jump,
            coefficient,
            self.normal,
            incremental=self.contact.law == "incremental",
        )
        if self.normal is None:
            term.set_bound(bound)
        return term

    @property
    def friction_bound(self) -> Array:
        """Friction bound g = coefficient × pressure at the points (stress)."""
        if self.friction is None:
            return np.zeros(len(self.trace.weights))
        if self.normal is None:
            return self.friction.bound
        return self.friction.bound_of(self.pressure())

    @property
    def regularisation_parameter(self) -> float:
        """ε as used (length), 0 without friction."""
        return 0.0 if self.friction is None else self.friction.regularisation_parameter

    @property
    def is_coulomb(self) -> bool:
        """Whether its friction depends on a pressure that is not known."""
        return self.friction is not None and self.normal is not None

    def _set_regularisation(self) -> None:
        """Set ε where the scene gives it, or a pressure; collective."""
        given, epsilon = self.contact.regularisation_parameter, 0.0
        if self.friction is None:
            return
        if given != "auto":
            epsilon = float(given)
        elif self.normal is None:
            strongest = largest(self.spaces.comm, self.friction.bound)
            epsilon = self.scales.regularisation_parameter(strongest)
        if epsilon > 0:  # under no pressure it does not matter
            self.friction.regularisation_parameter = epsilon
            self.is_scaled = True

    @property
    def finds_scale(self) -> bool:
        """Whether ε follows the pressures that are found."""
        return self.is_coulomb and self.contact.regularisation_parameter == "auto"

    @property
    def terms(self) -> list[NormalTerm | FrictionTerm]:
        """Its energy terms."""
        return [term for term in (self.normal, self.friction) if term is not None]

    def set_time(self, time: float) -> None:
        """Bring the obstacle to where it stands, or to what drives it, at a pseudo-time."""
        if self.contact.kind == "prescribed":
            self._press(self.paths.pressure_factor(time))
        kinematics = self.kinematics
        if self.contact.obstacle is None or not isinstance(kinematics, ObstacleKinematics):
            return
        self.force = self.paths.force(time)
        if self.force is None:
            kinematics.indentation = self.paths.indentation(time)
        moved = self.paths.displacement(time)
        if moved is not None:
            kinematics.displace(moved)
        elif self.force is None:
            kinematics.stand()
        if self.normal is not None:
            self.normal.set_gap(kinematics.gap)

    def _press(self, factor: float) -> None:
        """Scale the given pressure, and the friction that it bounds."""
        self._given_pressure = factor * self._full_pressure
        if self.friction is not None:
            self.friction.set_bound(self.friction.bound_of(self._given_pressure))
            self._set_regularisation()

    def touch(self) -> None:
        """Bring an obstacle that nothing presses on until it just touches; collective."""
        if self.force == 0 and self.normal is None:
            assert isinstance(self.kinematics, ObstacleKinematics)
            self.kinematics.touch()

    def slid_share(self) -> float:
        """Slip of two bodies since it was found what faces what, over the size of the contact.

        Collective.
        """
        if not isinstance(self.kinematics, BodyKinematics) or self.normal is None:
            return 0.0
        return self.kinematics.slid_share(self.pressure() > 0)

    def pair_anew(self, displacement: Array | None) -> None:
        """Find anew which points of two bodies face each other; collective.

        Args:
            displacement: Of a load step, at the body's nodes of this rank; None as meshed
                (length).
        """
        assert isinstance(self.kinematics, BodyKinematics) and self.normal is not None
        self.kinematics.pair_anew(displacement)
        self.normal.set_gap(self.kinematics.gap)
        if self.friction is not None:
            slip = self.kinematics.tangential(self.kinematics.jump_at_points())
            self.friction.accept(slip)
        left = self.history.measured_anew(self.state().gap)
        self.history.left_open += float(self.trace.integral(left))

    def accept(self) -> None:
        """A load step is done: slip counts from here where the law is incremental; collective."""
        state = self.state()
        self.history.advance(state, self.kinematics.gap, self._work_in_step(state))
        if self.friction is not None:
            self.friction.accept(state.slip)

    def _work_in_step(self, state: ContactState) -> float:
        """Dissipated in the present step; with the static law, since the start; collective."""
        if self.friction is None:
            return 0.0
        slip = self.friction.counted(state.slip)
        if self.contact.law == "incremental":
            return float(self.trace.integral(self.history.dissipation(state, slip)))
        return -float(self.trace.integral(np.einsum("ij,ij->i", state.friction_traction, slip)))

    def friction_work(self, state: ContactState) -> float:
        """Dissipated since the start: in all steps, or by the static law; collective.

        Args:
            state: At the end of the present step, before it is accepted.
        """
        before = self.history.dissipated if self.contact.law == "incremental" else 0.0
        return before + self._work_in_step(state)

    def open_work(self, state: ContactState) -> float:
        """Work that the present step leaves open, where points touched or slipped anew; collective.

        Args:
            state: At its end, before it is accepted.
        """
        left = np.zeros(len(state.gap))
        if self.is_one_sided:
            left += self.history.open_pressing(state)
        if self.friction is not None:
            left += self.history.open_friction(state, self.friction.counted(state.slip))
        return float(self.trace.integral(left))

    @property
    def on_body(self) -> NDArray[np.bool_]:
        """Which of the body's nodes are points of it; collective."""
        ones = self.trace.at_all_nodes(np.ones(len(self.nodes)))
        return self.trace.surface.on_body(ones) > 0

    @property
    def floats(self) -> bool:
        """Whether the obstacle's position is an unknown: a force drives it, or it is glued on.

        An obstacle that no force drives, and that pushes only, is left out.
        """
        obstacle = self.contact.obstacle
        if obstacle is None or obstacle.force is None:
            return False
        return obstacle.force > 0 or self.contact.kind == "bonded"

    @property
    def can_shear(self) -> bool:
        """Whether it can exert a force along a flat surface."""
        return self.friction is not None or self.contact.kind == "bonded"

    @property
    def has_penalty(self) -> bool:
        """Whether ε₁ stands for no give at all; a foundation's stiffness is what it is."""
        return self.normal is not None and self.contact.kind != "winkler"

    @property
    def is_one_sided(self) -> bool:
        """Whether it pushes only: the body may leave it."""
        return self.normal is not None and self.contact.kind != "bonded"

    @property
    def law(self) -> str:
        """Friction law, as results name it."""
        if self.contact.kind == "bonded":
            return "stick"
        return self.contact.law if self.friction is not None else "none"

    def _normal_term(self, key: str) -> NormalTerm | None:
        kind = self.contact.kind
        if kind == "prescribed" or (self.force is not None and not self.floats):
            return None
        if kind == "winkler":
            stiffness = self._given(self.contact.foundation_stiffness or 0.0, key)
        else:
            stiffness = np.full(len(self.trace.weights), 1 / self.penalty_parameter)
        if kind == "bonded":
            stiffness = np.where(self.kinematics.reached, stiffness, 0.0)
        name = f"{_NAMES[kind]} on {self.label}"
        return NormalTerm(
            name, self.trace, self.kinematics.jump, self.kinematics.gap, stiffness, kind == "bonded"
        )

    def _given(self, value: Value, key: str) -> Array:
        values = self.spaces.evaluate_at(value, self.trace.coordinates.T, key)
        lowest = smallest(self.spaces.comm, values)
        if lowest < 0:
            raise InputError(f"{key}: its smallest value is {lowest:g}, but it must be ≥ 0")
        return values

    def _pressure_form(self) -> Any:
        """The work f on Γ_C as a linear form: minus the derivative of ∫ p v_n."""
        if largest(self.spaces.comm, self._given_pressure) == 0:
            return None
        pressure = self.trace.coefficient(self._given_pressure)
        test = ufl.TestFunction(self.trace.surface.space)
        work = -prescribed_pressure_energy(
            test, self.trace.normal, pressure, self.trace.weight, self.trace.measure
        )
        return form_cache.form(work)

    def pressure(self) -> Array:
        """Contact pressure at the points at the present jump (stress)."""
        if self.normal is None:
            return self._given_pressure
        jump = self.kinematics.jump_at_points()
        return self.normal.pressure(self.kinematics.normal(jump) - self.kinematics.gap)

    def follow_pressure(self) -> None:
        """Let the friction bound follow the pressure, where the two are coupled."""
        if self.friction is not None and self.friction.mode == "coupled":
            self.friction.set_bound(self.friction.bound_of(self.pressure()))

    def follow(self) -> None:
        """Move the friction tangent to the present jump."""
        if self.friction is not None:
            self.friction.follow(self.kinematics.tangential(self.kinematics.jump_at_points()))

    def state(self) -> ContactState:
        """What happens at the points at the present jump."""
        jump = self.kinematics.jump_at_points()
        slip = self.kinematics.tangential(jump)
        bonded = self.contact.kind == "bonded"
        gap = np.where(self.kinematics.reached, 0.0, np.inf) if bonded else self.kinematics.gap
        depth = self.kinematics.normal(jump) - gap
        if self.contact.kind == "prescribed":
            depth = np.zeros_like(gap)
        pressure, energy = self._given_pressure, np.zeros_like(gap)
        traction = np.zeros_like(slip)
        if self.normal is not None:
            pressure = self.normal.pressure(depth)
            energy = self.normal.energy_density(jump, depth)
            if bonded:
                traction = -self.normal.stiffness[:, None] * slip + 0.0
        if self.friction is not None:
            traction = self.friction.traction(slip)
        counted = slip if self.friction is None else self.friction.counted(slip)
        status = self._status(pressure, counted)
        return ContactState(0.0 - depth, pressure, traction, slip, status, energy)

    def _at_rest(self, coefficient: Array) -> ContactState:
        """Of the body as it is meshed, without any load: what touches sticks, if it is rough."""
        gap, nothing = self.kinematics.gap, np.zeros(len(coefficient))
        closed = gap <= 1e-12 * self.trace.extent()
        if self.contact.kind == "prescribed":
            closed = self._given_pressure > 0
        touching = np.where(coefficient > 0, STICK, SLIP)
        if self.contact.kind == "bonded":
            closed, touching = self.kinematics.reached, np.full(len(gap), STICK)
        status = np.where(closed, touching, OPEN)
        vectors = np.zeros_like(self.trace.normals)
        return ContactState(gap, nothing, vectors, vectors, status, nothing)

    def _status(self, pressure: Array, slip: Array) -> NDArray[np.str_]:
        """STICK where |u_T| ≤ ε and friction acts, SLIP beyond, OPEN without pressure."""
        if self.contact.kind == "bonded":
            return np.where(self.kinematics.reached, STICK, OPEN)
        small = np.linalg.norm(slip, axis=1) <= self.regularisation_parameter
        sticks = (self.friction_bound > 0) & small
        return np.where(pressure > 0, np.where(sticks, STICK, SLIP), OPEN)
