"""A contact surface: its kinematics (jump, gap, slip) and its energy terms.

One object per ``[[contact]]``; the only place that knows what the body touches.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.contact_terms import FrictionTerm, NormalTerm
from fenics_contact.errors import FenicsContactError, InputError
from fenics_contact.normal_contact import prescribed_pressure_energy
from fenics_contact.obstacle import RigidObstacle
from fenics_contact.parallel import gather_rows, largest, raise_together, smallest, total
from fenics_contact.scene import Contact, Obstacle, Value
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
        direction: Unit vector along which the obstacle is driven, (components,).
        gap: Undeformed gap to the obstacle before it is driven, at the points (length).
        indentation: How far the obstacle is driven at present (length).
        plane_strain_modulus: E/(1 − ν²) of the body, about (stress).
        no_datum: Whether that number depends on an arbitrary datum, and is not reported.
        jump: Displacement relative to the obstacle, a dolfinx function that the terms see.
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
        self.no_datum = False
        self.plane_strain_modulus = plane_strain_modulus
        self._given_pressure = self._given(contact.pressure or 0.0, f"{key}.pressure")
        self._set_obstacle(f"{key}.obstacle")
        self.jump = fem.Function(spaces.displacement_space)
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
                self.jump,
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
    def reached_nodes(self) -> NDArray[np.bool_]:
        """Which of the nodes have the obstacle before them."""
        return np.isfinite(self.gap[: len(self.nodes)])

    @property
    def reported_indentation(self) -> float | None:
        """How far the obstacle went in; None where there is none, or no datum for it."""
        if self.contact.obstacle is None or self.no_datum:
            return None
        return self.indentation

    @property
    def law(self) -> str:
        """Friction law, as results name it."""
        if self.contact.kind == "bonded":
            return "stick"
        return self.contact.law if self.friction is not None else "none"

    def _set_obstacle(self, key: str) -> None:
        """Direction, gap and position of the obstacle, which exists unless prescribed."""
        contact, trace = self.contact, self.trace
        normals = gather_rows(self.spaces.comm, trace.normals[trace.owned])
        self.indentation = 0.0
        self.direction = np.zeros(self.spaces.components)
        self.gap = np.zeros(len(trace.weights))
        if contact.kind == "prescribed":
            return
        described = contact.obstacle or Obstacle()
        obstacle = RigidObstacle(described, self.spaces.kinematics, normals, key)
        self._obstacle = obstacle
        self.direction = obstacle.direction
        error: FenicsContactError | None = None
        try:
            self.gap = obstacle.gap(trace.coordinates, trace.normals, self.spaces.position)
        except InputError as caught:
            error = caught
        raise_together(self.spaces.comm, error)
        self.indentation = described.indentation or 0.0
        reached = np.isfinite(self.gap) & (trace.normals @ self.direction < 0)
        if total(self.spaces.comm, reached.sum()) == 0:
            raise InputError(
                f"{key}: no point of '{contact.on}' lies in its way; see its position, normal and "
                "direction"
            )

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
            stiffness = np.full(len(self.gap), 1 / self.penalty_parameter)
        stiffness = np.where(np.isfinite(self.gap), stiffness, 0.0)
        name = f"{_NAMES[kind]} on {self.label}"
        return NormalTerm(name, self.trace, self.jump, self.gap, stiffness)

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

    def move(self, displacement: Array, indentation: float | None = None) -> None:
        """Set the jump: displacement of the body minus motion of the obstacle.

        Args:
            displacement: Nodal displacements of this rank, shape (nodes, components).
            indentation: How far the obstacle is driven; by default as before (length).
        """
        if indentation is not None:
            self.indentation = indentation
        jump = displacement - self.indentation * self.direction
        self.jump.x.array[:] = jump.reshape(-1)

    def _jump_at_points(self) -> Array:
        jump = self.jump.x.array.reshape(-1, self.spaces.components)
        return self.trace.at_points(jump)

    def follow(self) -> None:
        """Move the friction tangent to the present jump."""
        if self.friction is not None:
            self.friction.follow(self.tangential(self._jump_at_points()))

    def state(self) -> ContactState:
        """What happens at the points at the present jump."""
        jump = self._jump_at_points()
        slip = self.tangential(jump)
        depth = np.einsum("ij,ij->i", jump, self.trace.normals) - self.gap
        kind = self.contact.kind
        pressure, gap = self._given_pressure, -depth
        traction, energy = np.zeros_like(slip), np.zeros_like(pressure)
        if kind == "prescribed":
            gap = np.zeros_like(pressure)
        if kind == "bonded":
            depth = np.einsum("ij,ij->i", jump, self.trace.normals)
            gap = np.where(np.isfinite(self.gap), -depth, np.inf)
        if self.normal is not None:
            pressure = self.normal.pressure(depth)
            energy = self.normal.energy_density(jump, depth)
        if kind == "bonded" and self.normal is not None:
            traction = -self.normal.stiffness[:, None] * slip + 0.0
        if self.friction is not None:
            traction = self.friction.traction(slip)
        status = self._status(pressure, slip)
        return ContactState(gap, pressure, traction, slip, status, energy)

    def _status(self, pressure: Array, slip: Array) -> NDArray[np.str_]:
        """STICK where |u_T| ≤ ε and friction acts, SLIP beyond, OPEN without pressure."""
        if self.contact.kind == "bonded":
            return np.where(np.isfinite(self.gap), STICK, OPEN)
        small = np.linalg.norm(slip, axis=1) <= self.regularisation_parameter
        sticks = (self.friction_bound > 0) & small
        return np.where(pressure > 0, np.where(sticks, STICK, SLIP), OPEN)

    def touch(self) -> None:
        """Drive an obstacle without force until it just touches the body; collective."""
        facing = -self.trace.normals @ self.direction
        reached = np.isfinite(self.gap) & (facing > 0)
        normal_jump = np.einsum("ij,ij->i", self._jump_at_points(), self.trace.normals)
        distance = (self.gap - normal_jump)[reached] / facing[reached]
        nearest = smallest(self.spaces.comm, distance)
        displacement = self.jump.x.array.reshape(-1, self.spaces.components)
        displacement = displacement + self.indentation * self.direction
        self.move(displacement, self.indentation + nearest)

    def end_of_obstacle(self, reached: int, beyond: Array) -> float:
        """How far the obstacle goes, from a point that it reaches to one beyond it (0 … 1).

        Args:
            reached: Number of the point.
            beyond: Coordinates of the other, (3,) (length).
        """
        start, normal = self.trace.coordinates[reached], self.trace.normals[reached]
        low, high = 0.0, 1.0
        for _ in range(40):
            middle = 0.5 * (low + high)
            point = start + middle * (beyond - start)
            gap = self._obstacle.gap(point[None], normal[None], self.spaces.position)
            low, high = (middle, high) if np.isfinite(gap[0]) else (low, middle)
        return low

    def tangential(self, vectors: Array) -> Array:
        """Tangential part of vectors given at the contact points, or at their nodes."""
        normals = self.trace.normals[: len(vectors)]
        return vectors - np.einsum("ij,ij->i", vectors, normals)[:, None] * normals
