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

from fenics_contact import compat
from fenics_contact.errors import InputError
from fenics_contact.friction import (
    friction_energy,
    prescribed_pressure_energy,
    primal_dual_residual,
)
from fenics_contact.parallel import largest, smallest, total
from fenics_contact.scene import Contact, Value
from fenics_contact.spaces import Spaces

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
        nodes: Contact points of this rank (owned and ghost) with a weight > 0.
        weights: Area that each stands for, shape (points,).
        normals: Outward unit normals, single-valued at shared nodes, (points, components).
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
        self.measure = spaces.contact_boundary(self.group)
        self._find_points(key)
        self.contact_pressure = self._given(contact.pressure, f"{key}.pressure")
        coefficient = self._given(contact.friction_coefficient, f"{key}.friction_coefficient")
        if contact.law == "none":
            coefficient = np.zeros_like(coefficient)
        self.friction_bound = coefficient * self.contact_pressure
        self.regularisation_parameter = self._regularisation(reference_modulus)
        self.pressure_load = self._pressure_form()
        self.friction = self._friction_forms(displacement)

    def _find_points(self, key: str) -> None:
        """Nodes, weights and averaged normals, from integrals of the shape functions."""
        spaces = self.spaces
        nodes = spaces.nodes(self.group)
        test = ufl.TestFunction(spaces.displacement_space)
        normal = ufl.FacetNormal(spaces.body.mesh)
        ones = ufl.as_vector([1.0] * spaces.components)
        area = fem.form(spaces.weight * ufl.dot(ones, test) * self.measure)
        weights = spaces.assemble(area)[nodes, 0]
        averaged = spaces.assemble(fem.form(ufl.dot(normal, test) * self.measure))
        heaviest = largest(spaces.comm, weights)
        if heaviest <= 0:
            raise InputError(
                f"{key}.on = '{self.contact.on}': no facet of it is on the boundary of the body"
            )
        # A point on the axis of revolution stands for no area.
        counted = weights > 1e-12 * heaviest
        self.nodes = nodes[counted]
        self.weights = weights[counted]
        lengths = np.linalg.norm(averaged, axis=1)
        units = averaged / np.where(lengths > 0, lengths, 1.0)[:, None]
        self.normal = spaces.vector_function("normal", units[nodes], nodes)
        self.normals = units[self.nodes]
        self.owned = spaces.is_owned(self.nodes)

    def _given(self, value: Value, key: str) -> NDArray[np.float64]:
        values = self.spaces.evaluate(value, self.nodes, key)
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
        return _REGULARISATION_SHARE * strongest * self._smallest_edge() / reference_modulus

    def _smallest_edge(self) -> float:
        """Shortest edge of the cells at the contact (length): flat ones are stiff."""
        topology = self.spaces.body.mesh.topology
        topology.create_entities(1)
        topology.create_connectivity(topology.dim, 1)
        topology.create_connectivity(1, topology.dim)  # which `h` asks for
        entities = compat.boundary_entities(topology, self.spaces.body.entities(self.group))
        cells = np.unique(np.asarray(entities).reshape(-1, 2)[:, 0])
        links = topology.connectivity(topology.dim, 1)
        edges = [np.zeros(0, dtype=np.int32), *(links.links(cell) for cell in cells)]
        lengths = self.spaces.body.mesh.h(1, np.unique(np.concatenate(edges)))
        return smallest(self.spaces.comm, lengths)

    def relative_facet_size(self) -> float:
        """Largest facet over the extent of the contact surface; collective."""
        spaces = self.spaces
        mesh = spaces.body.mesh
        facets = spaces.body.entities(self.group)
        points = spaces.coordinates[spaces.nodes(self.group)].T
        extent = [largest(spaces.comm, axis) - smallest(spaces.comm, axis) for axis in points]
        size = largest(spaces.comm, mesh.h(mesh.topology.dim - 1, facets))
        return size / float(np.linalg.norm(extent))

    def _held(self, constrained: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Which components of the points a support holds, shape (points, components)."""
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
            Components along which no support acts, shape (points, components); and the
            points that can move along such a one. A support at an angle to the surface
            counts for all of a point, since its reaction has a part in every direction.
        """
        held = self._held(constrained)
        tangential = 1 - self.normals**2 > 1e-9
        held_tangentially = held & tangential
        oblique = (held_tangentially & (self.normals**2 > 1e-9)).any(axis=1)
        movable = held_tangentially.sum(axis=1) < self.spaces.components - 1
        return ~held_tangentially, movable & ~oblique

    def held_axes(self, constrained: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Along which axes supports hold more than a tenth of the surface; collective."""
        held = self.integral(self._held(constrained).astype(np.float64))
        return held > 0.1 * self.integral(np.ones(len(self.nodes)))

    def _pressure_form(self) -> Any:
        """The work f on Γ_C as a linear form: minus the derivative of ∫ p v_n."""
        spaces = self.spaces
        if largest(spaces.comm, self.contact_pressure) == 0:
            return None
        pressure = spaces.coefficient(self.contact_pressure, self.nodes)
        test = ufl.TestFunction(spaces.displacement_space)
        work = -prescribed_pressure_energy(test, self.normal, pressure, spaces.weight, self.measure)
        return fem.form(work)

    def _friction_forms(self, displacement: Any) -> FrictionForms | None:
        spaces = self.spaces
        if self.regularisation_parameter == 0:
            return None
        bound = spaces.coefficient(self.friction_bound, self.nodes)
        epsilon = fem.Constant(spaces.body.mesh, self.regularisation_parameter)
        energy = friction_energy(
            displacement, self.normal, bound, epsilon, spaces.weight, self.measure
        )
        self._direction = fem.Function(spaces.displacement_space)
        self._length = spaces.nodal_function("length", np.zeros(0), self.nodes[:0], empty=1.0)
        modified = primal_dual_residual(
            displacement,
            ufl.TestFunction(spaces.displacement_space),
            self.normal,
            bound,
            epsilon,
            self._direction,
            self._length,
            spaces.weight,
            self.measure,
        )
        self.stick_all()
        return FrictionForms(
            energy,
            fem.form(ufl.derivative(energy, displacement)),
            fem.form(ufl.derivative(modified, displacement)),
        )

    def stick_all(self) -> None:
        """Set the tangent to the adhesive start: u_T = 0 and no friction yet."""
        self._slip = np.zeros((len(self.nodes), self.spaces.components))
        self._dual = np.zeros_like(self._slip)
        self._set_tangent_state()

    def follow(self, displacement: NDArray[np.float64]) -> None:
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

    def _lengths_and_directions(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """max(|u_T|, ε) and its gradient, u_T/|u_T| where slipping and 0 where sticking."""
        size = np.linalg.norm(self._slip, axis=1)
        slips = size > self.regularisation_parameter
        directions = np.where(slips[:, None], self._slip / np.where(slips, size, 1.0)[:, None], 0.0)
        return np.maximum(size, self.regularisation_parameter), directions

    def _set_tangent_state(self) -> None:
        components = self.spaces.components
        self._direction.x.array.reshape(-1, components)[self.nodes] = self._dual
        self.spaces.set_nodal(self._length, self._lengths_and_directions()[0], self.nodes)

    def slip(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """u_T at the contact points, shape (points, components) (length).

        Args:
            displacement: Nodal displacements of this rank, shape (nodes, components).
        """
        return self.tangential(displacement[self.nodes])

    def tangential(self, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Tangential part of vectors given at the contact points."""
        normal_part = np.einsum("ij,ij->i", vectors, self.normals)
        return vectors - normal_part[:, None] * self.normals

    def integral(self, values: NDArray[np.float64]) -> Any:
        """∫ of values at the points, first axis (points), by the contact's own rule."""
        weighted = np.tensordot(self.weights[self.owned], values[self.owned], axes=(0, 0))
        return total(self.spaces.comm, weighted)
