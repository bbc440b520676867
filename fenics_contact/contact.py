"""A contact surface: its kinematics (normal, slip), energies and compiled forms.

One object per ``[[contact]]``; the only place that knows what the body touches.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.errors import InputError
from fenics_contact.friction import (
    friction_energy,
    prescribed_pressure_energy,
    primal_dual_residual,
)
from fenics_contact.parallel import largest, smallest, total
from fenics_contact.scene import Contact, Value
from fenics_contact.spaces import Spaces
from fenics_contact.trace import Trace

Array = NDArray[np.float64]

OPEN, STICK, SLIP = "OPEN", "STICK", "SLIP"

# ε = this × g h / E, h the shortest edge at the contact: a stuck point creeps by less
# than ε, which changes the stress near it by about E ε / h, so the bias is of this order.
_REGULARISATION_SHARE = 1e-5


@dataclass(frozen=True, eq=False)
class FrictionForms:
    """The friction term of one contact.

    Attributes:
        energy: j_ε as a UFL form.
        residual: Its first derivative, compiled.
        tangent: The primal-dual tangent, compiled.
    """

    energy: Any
    residual: Any
    tangent: Any


class ContactSurface:
    """Contact with prescribed pressure: the paper's case (i).

    Attributes:
        trace: The contact points: coordinates, weights, normals.
        nodes: Nodes among them (local, owned and ghost), which receive its forces.
        owned_nodes: Which of these this rank owns.
        contact_pressure: Prescribed pressure at the points (stress).
        friction_bound: g = coefficient × pressure at the points (stress).
        regularisation_parameter: ε as used (length), 0 without friction.
        pressure_load: Compiled linear form of the pressure's work, or None.
        friction: The forms of j_ε, or None without friction.
    """

    def __init__(
        self,
        contact: Contact,
        key: str,
        spaces: Spaces,
        displacement: Any,
        reference_modulus: float,
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
        self.contact_pressure = self._given(contact.pressure, f"{key}.pressure")
        coefficient = self._given(contact.friction_coefficient, f"{key}.friction_coefficient")
        if contact.law == "none":
            coefficient = np.zeros_like(coefficient)
        self.friction_bound = coefficient * self.contact_pressure
        self.regularisation_parameter = self._regularisation(reference_modulus)
        self.pressure_load = self._pressure_form()
        self.friction = self._friction_forms(displacement)

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

    def held_axes(self, constrained: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Along which axes supports hold more than a tenth of the nodes; collective."""
        held = total(self.spaces.comm, self._held(constrained)[self.owned_nodes].sum(axis=0))
        return held > 0.1 * total(self.spaces.comm, self.owned_nodes.sum())

    def _pressure_form(self) -> Any:
        """The work f on Γ_C as a linear form: minus the derivative of ∫ p v_n."""
        spaces = self.spaces
        if largest(spaces.comm, self.contact_pressure) == 0:
            return None
        pressure = self.trace.coefficient(self.contact_pressure)
        test = ufl.TestFunction(spaces.displacement_space)
        work = -prescribed_pressure_energy(
            test, self.trace.normal, pressure, spaces.weight, self.trace.measure
        )
        return fem.form(work)

    def _friction_forms(self, displacement: Any) -> FrictionForms | None:
        spaces = self.spaces
        if self.regularisation_parameter == 0:
            return None
        bound = self.trace.coefficient(self.friction_bound)
        normal, measure = self.trace.normal, self.trace.measure
        epsilon = fem.Constant(spaces.body.mesh, self.regularisation_parameter)
        energy = friction_energy(displacement, normal, bound, epsilon, spaces.weight, measure)
        self._slip = np.zeros((len(self.trace.weights), spaces.components))
        self._dual = np.zeros_like(self._slip)
        self._direction = self.trace.function(self._dual)
        # Not 0 anywhere: it divides, also where the weight is 0.
        self._length = self.trace.function(np.ones(len(self._slip)), empty=1.0)
        modified = primal_dual_residual(
            displacement,
            ufl.TestFunction(spaces.displacement_space),
            normal,
            bound,
            epsilon,
            self._direction.ufl,
            self._length.ufl,
            spaces.weight,
            measure,
        )
        self.stick_all()
        return FrictionForms(
            energy,
            fem.form(ufl.derivative(energy, displacement)),
            fem.form(ufl.derivative(modified, displacement)),
        )

    def stick_all(self) -> None:
        """Set the tangent to the adhesive start: u_T = 0 and no friction yet."""
        self._slip = np.zeros_like(self._slip)
        self._dual = np.zeros_like(self._slip)
        self._set_tangent_state()

    def follow(self, displacement: Array) -> None:
        """Move the tangent to a new state: q by its own linearised equation, |q| ≤ 1.

        Args:
            displacement: Nodal displacements of this rank, shape (nodes, components).
        """
        slip = self.slip(displacement)
        lengths, directions = self._lengths_and_directions()
        lengthening = np.einsum("ij,ij->i", directions, slip - self._slip)
        dual = (slip - self._dual * lengthening[:, None]) / lengths[:, None]
        self._dual = dual / np.maximum(np.linalg.norm(dual, axis=1), 1.0)[:, None]
        self._slip = slip
        self._set_tangent_state()

    def _lengths_and_directions(self) -> tuple[Array, Array]:
        """max(|u_T|, ε) and its gradient, u_T/|u_T| where slipping and 0 where sticking."""
        size = np.linalg.norm(self._slip, axis=1)
        slips = size > self.regularisation_parameter
        directions = np.where(slips[:, None], self._slip / np.where(slips, size, 1.0)[:, None], 0.0)
        return np.maximum(size, self.regularisation_parameter), directions

    def _set_tangent_state(self) -> None:
        self._direction.set(self._dual)
        self._length.set(self._lengths_and_directions()[0])

    def slip(self, displacement: Array) -> Array:
        """u_T at the contact points, shape (points, components) (length).

        Args:
            displacement: Nodal displacements of this rank, shape (nodes, components).
        """
        return self.tangential(self.trace.at_points(displacement))

    def friction_traction(self, displacement: Array) -> Array:
        """−g φ_ε′(u_T) at the contact points (paper, (2.8)), (points, components) (stress)."""
        slip = self.slip(displacement)
        if self.friction is None:
            return np.zeros_like(slip)
        length = np.maximum(np.linalg.norm(slip, axis=1), self.regularisation_parameter)
        return -(self.friction_bound / length)[:, None] * slip + 0.0  # no −0

    def tangential(self, vectors: Array) -> Array:
        """Tangential part of vectors given at the contact points, or at their nodes."""
        normals = self.trace.normals[: len(vectors)]
        return vectors - np.einsum("ij,ij->i", vectors, normals)[:, None] * normals
