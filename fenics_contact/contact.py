"""A contact surface: its kinematics, energy terms and what happens on it.

One object per ``[[contact]]``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.contact_kinematics import ContactKinematics
from fenics_contact.contact_terms import FrictionTerm, NormalTerm
from fenics_contact.errors import InputError
from fenics_contact.normal_contact import prescribed_pressure_energy
from fenics_contact.parallel import largest, smallest, total
from fenics_contact.scene_contact import Contact, Obstacle
from fenics_contact.scene_values import Value
from fenics_contact.spaces import Spaces
from fenics_contact.trace import Trace

Array = NDArray[np.float64]

OPEN, STICK, SLIP = "OPEN", "STICK", "SLIP"

# ε = this × g h / E, h the shortest edge at the contact: a stuck point creeps by less
# than ε, which changes the stress near it by about E ε / h, so the bias is of this order.
_REGULARISATION_SHARE = 1e-5
# ε₁ = this × h / E: a pressure p then sinks in by this share of the elastic displacement
# p h / E of one cell, so its bias stays below .1 % down to contacts of a single cell.
_PENALTY_SHARE = 1e-4

_NAMES = {
    "unilateral": "unilateral contact (penalty)",
    "winkler": "Winkler foundation",
    "bonded": "bonded contact (penalty)",
}


@dataclass(frozen=True, eq=False)
class ContactState:
    """What happens at the contact points of this rank, one row a point.

    Attributes:
        gap: Along the normal, > 0 open, infinite where no obstacle stands (length).
        contact_pressure: On the body, ≥ 0; < 0 in tension where bonded (stress).
        friction_traction: Tangential traction on the body, (points, components) (stress).
        slip: Tangential displacement relative to the obstacle, (points, components) (length).
        status: OPEN, STICK or SLIP.
        penalty_energy: Of penalty or foundation (energy/area).
    """

    gap: Array
    contact_pressure: Array
    friction_traction: Array
    slip: Array
    status: NDArray[np.str_]
    penalty_energy: Array


class ContactSurface:
    """Contact of a boundary with a rigid obstacle, or with a prescribed pressure.

    Attributes:
        contact: What the scene says.
        trace: The contact points: coordinates, weights, normals.
        nodes: Nodes among them (local, owned and ghost), which receive its forces.
        owned_nodes: Which of these this rank owns.
        kinematics: Jump, gap and slip against the obstacle.
        plane_strain_modulus: E/(1 − ν²) of the body, about (stress).
        friction_bound: g = coefficient × pressure at the points (stress).
        regularisation_parameter: ε as used (length), 0 without friction.
        penalty_parameter: ε₁ as used (length/stress), 0 without a penalty.
        pressure_load: Compiled linear form of a prescribed pressure's work, or None.
        normal: Penalty, foundation or glue; None where prescribed, or driven by no force.
        friction: The term of j_ε, or None without friction.
    """

    def __init__(
        self,
        contact: Contact,
        key: str,
        spaces: Spaces,
        reference_modulus: float,
        plane_strain_modulus: float,
    ) -> None:
        self.contact = contact
        self.label = contact.label
        self.spaces = spaces
        self.group = spaces.body.boundary(contact.on, f"{key}.on")
        self.trace = Trace(spaces, self.group)
        self.nodes = self.trace.nodes
        self.owned_nodes = spaces.is_owned(self.nodes)
        if largest(spaces.comm, self.trace.weights) <= 0:
            raise InputError(
                f"{key}.on = '{contact.on}': no facet of it is on the boundary of the body"
            )
        self.plane_strain_modulus = plane_strain_modulus
        self._given_pressure = self._given(contact.pressure or 0.0, f"{key}.pressure")
        described = contact.obstacle or Obstacle()
        self.kinematics = ContactKinematics(
            self.trace, None if contact.kind == "prescribed" else described, f"{key}.obstacle"
        )
        self.penalty_parameter = self._penalty(reference_modulus)
        self.normal = self._normal_term(f"{key}.foundation_stiffness")
        coefficient = self._given(contact.friction_coefficient, f"{key}.friction_coefficient")
        if contact.law == "none":
            coefficient = np.zeros_like(coefficient)
        self.friction_bound = coefficient * self._given_pressure
        self.regularisation_parameter = self._regularisation(reference_modulus)
        self.pressure_load = self._pressure_form()
        self.friction = None
        if self.regularisation_parameter > 0:
            self.friction = FrictionTerm(
                f"regularised friction on {self.label}",
                self.trace,
                self.kinematics.jump,
                self.friction_bound,
                self.regularisation_parameter,
            )

    @property
    def terms(self) -> list[NormalTerm | FrictionTerm]:
        """Its energy terms."""
        return [term for term in (self.normal, self.friction) if term is not None]

    @property
    def force(self) -> float | None:
        """The force that drives the obstacle, if one does."""
        obstacle = self.contact.obstacle
        return None if obstacle is None else obstacle.force

    @property
    def floats(self) -> bool:
        """Whether the obstacle's position is an unknown: a force > 0 drives it."""
        return bool(self.force)

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

    def _penalty(self, reference_modulus: float) -> float:
        """The scene's ε₁, or one whose bias in force and peak pressure is below .1 %."""
        if self.contact.kind not in ("unilateral", "bonded"):
            return 0.0
        if self.contact.penalty_parameter != "auto":
            return float(self.contact.penalty_parameter)
        return _PENALTY_SHARE * self.trace.smallest_edge() / reference_modulus

    def _normal_term(self, key: str) -> NormalTerm | None:
        kind = self.contact.kind
        if kind == "prescribed" or self.force == 0:
            return None
        if kind == "winkler":
            stiffness = self._given(self.contact.foundation_stiffness or 0.0, key)
        else:
            stiffness = np.full(len(self.trace.weights), 1 / self.penalty_parameter)
        stiffness = np.where(self.kinematics.reached, stiffness, 0.0)
        name = f"{_NAMES[kind]} on {self.label}"
        return NormalTerm(name, self.trace, self.kinematics.jump, self.kinematics.gap, stiffness)

    def _given(self, value: Value, key: str) -> Array:
        values = self.spaces.evaluate_at(value, self.trace.coordinates.T, key)
        lowest = smallest(self.spaces.comm, values)
        if lowest < 0:
            raise InputError(f"{key}: its smallest value is {lowest:g}, but it must be ≥ 0")
        return values

    def _regularisation(self, reference_modulus: float) -> float:
        """The scene's ε, or one whose bias in force and peak traction is below .1 %."""
        strongest = largest(self.spaces.comm, self.friction_bound)
        if strongest == 0:
            return 0.0
        if self.contact.regularisation_parameter != "auto":
            return float(self.contact.regularisation_parameter)
        return _REGULARISATION_SHARE * strongest * self.trace.smallest_edge() / reference_modulus

    def _pressure_form(self) -> Any:
        """The work f on Γ_C as a linear form: minus the derivative of ∫ p v_n."""
        spaces = self.spaces
        if largest(spaces.comm, self._given_pressure) == 0:
            return None
        pressure = self.trace.coefficient(self._given_pressure)
        test = ufl.TestFunction(spaces.displacement_space)
        work = -prescribed_pressure_energy(
            test, self.trace.normal, pressure, self.trace.weight, self.trace.measure
        )
        return fem.form(work)

    def _held(self, constrained: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Which components of the nodes a support holds, shape (nodes, components)."""
        components = self.spaces.components
        held = np.zeros(len(self.spaces.coordinates) * components, dtype=bool)
        held[constrained] = True
        return held.reshape(-1, components)[self.nodes]

    def free_along_surface(
        self, constrained: NDArray[np.int64]
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Where nothing but friction acts along the surface.

        Args:
            constrained: Local indices of the dofs that supports prescribe.

        Returns:
            Components along which no support acts, shape (nodes, components); and the
            nodes that can move along such a one. A support at an angle to the surface
            counts for all of a node, since its reaction has a part in every direction.
        """
        held = self._held(constrained)
        squares = self.trace.normals[: len(self.nodes)] ** 2
        held_tangentially = held & (1 - squares > 1e-9)
        oblique = (held_tangentially & (squares > 1e-9)).any(axis=1)
        movable = held_tangentially.sum(axis=1) < self.spaces.components - 1
        return ~held_tangentially, movable & ~oblique

    def free_across_surface(self, constrained: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Nodes on which no support acts along the surface's normal, (nodes,)."""
        squares = self.trace.normals[: len(self.nodes)] ** 2
        return ~(self._held(constrained) & (squares > 1e-9)).any(axis=1)

    def held_axes(self, constrained: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Along which axes supports hold more than a tenth of the nodes; collective."""
        held = total(self.spaces.comm, self._held(constrained)[self.owned_nodes].sum(axis=0))
        return held > 0.1 * total(self.spaces.comm, self.owned_nodes.sum())

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
        status = self._status(pressure, slip)
        return ContactState(0.0 - depth, pressure, traction, slip, status, energy)

    def _status(self, pressure: Array, slip: Array) -> NDArray[np.str_]:
        """STICK where |u_T| ≤ ε and friction acts, SLIP beyond, OPEN without pressure."""
        if self.contact.kind == "bonded":
            return np.where(self.kinematics.reached, STICK, OPEN)
        small = np.linalg.norm(slip, axis=1) <= self.regularisation_parameter
        sticks = (self.friction_bound > 0) & small
        return np.where(pressure > 0, np.where(sticks, STICK, SLIP), OPEN)
