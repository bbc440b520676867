"""Laws that say their energy density, of the program and of users.

Forces on the body are minus its first derivative in the jump, a function of a space on the surface.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar, Protocol, cast

import numpy as np
import ufl
from dolfinx.fem import Form as CompiledForm
from ufl import Form
from ufl.core.expr import Expr

from fenics_contact.analytic.complex_step import slope
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.normal.law import Parameter
from fenics_contact.contact.laws.normal.spring import SpringLaw, depth_of
from fenics_contact.contact.laws.point_values import PointDensity, point_density
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.values import Value


class EnergyLaw(SpringLaw):
    """A law with an energy density ψ in UFL; forces and tangent are its gradient and Hessian."""

    @staticmethod
    @abstractmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """ψ in UFL (energy/area).

        Args:
            depth: w_n − s (length).
            jump: w, (components,) (length).
            fields: As ``fields`` names them.
        """

    @cached_property
    def energy(self) -> Form:
        """∫ ψ as a UFL form."""
        trace, jump = self.site.trace, self.site.kinematics.jump
        depth = depth_of(jump, trace.normal, self._gap.ufl)
        density = self.density(depth, jump, **self._in_ufl) / self.penalty.softness_in_ufl
        return trace.weight * density * trace.measure

    @cached_property
    def residual(self) -> CompiledForm:
        """First derivative of the energy in the jump."""
        return form_cache.form(ufl.derivative(self.energy, self.site.kinematics.jump))

    @cached_property
    def tangent(self) -> CompiledForm:
        """Second derivative of the energy in the jump."""
        jump = self.site.kinematics.jump
        return form_cache.form(ufl.derivative(ufl.derivative(self.energy, jump), jump))

    def pressure_ufl(self, jump: Expr) -> Expr:
        """∂ψ/∂d + ∂ψ/∂w · n, the pressure of a jump in UFL (stress)."""
        normal = self.site.trace.normal
        depth, moved = ufl.variable(depth_of(jump, normal, self._gap.ufl)), ufl.variable(jump)
        density = self.density(depth, moved, **self._in_ufl) / self.penalty.softness_in_ufl
        pressure = ufl.diff(density, depth)
        if self._at_points.vanishes("jump"):
            return pressure
        return pressure + ufl.dot(ufl.diff(density, moved), normal)

    @cached_property
    def _at_points(self) -> PointDensity:
        components = self.site.trace.surface.components
        fields = dict.fromkeys(self._fields, 0)
        return point_density(self.density, depth=0, jump=components, **fields)


class PenaltyLaw(EnergyLaw):
    """A law whose springs are a numerical penalty: their stiffness is 1/ε₁."""

    has_penalty: ClassVar[bool] = True
    checks: tuple[str, ...] = (*EnergyLaw.checks, "penetration", "penetration_depth")

    def __init__(self, site: LawSite) -> None:
        self._penalty = self.penalty_parameter(site)
        super().__init__(site)

    @classmethod
    def penalty_parameter(cls, site: LawSite) -> float:
        """The scene's ε₁, or the automatic one (length/stress)."""
        return site.scales.penalty_parameter(site.contact.penalty_parameter)

    def fields(self) -> Mapping[str, Array]:
        """Stiffness 1/ε₁ (stress/length)."""
        return {"stiffness": np.full(len(self.site.trace.weights), 1 / self._penalty)}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the stiffness in ε₁."""
        if key != "penalty_parameter":
            return {}
        stiffness = self._fields["stiffness"]
        return {"stiffness": self._penalty * slope(lambda e: 1 / e, self._penalty) * stiffness}


class _HasParameters(Protocol):
    parameters: Mapping[str, float]


class UserContactEnergy(EnergyLaw):
    """A law of your own: an energy density of depth and jump, with the scene's parameters.

    A class derived from it says ``density`` in UFL. Forces and tangents follow from it, and
    so do pressures, checks, error bars and sensitivities of quantities.

    Attributes:
        model: What it models, in words, for results.

    Args:
        site: Where it acts; the program makes it.

    >>> from fenics_contact.contact.laws.normal.spring import positive
    >>> class Springs(UserContactEnergy):
    ...     @staticmethod
    ...     def density(depth, jump, k):
    ...         return k * positive(depth) ** 2 / 2
    """

    model = "own law"

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """Parameters in the scene's table.

        Args:
            contact: Of the scene.

        Returns:
            Name → number, in the scene's units.
        """
        return dict(given_parameters(contact))

    def fields(self) -> Mapping[str, Array]:
        """The parameters, the same at all points."""
        return parameters_at_points(self.site)


def given_parameters(contact: Contact) -> Mapping[str, float]:
    """Parameters in the scene's table of a law across a contact, by name.

    Args:
        contact: Of the scene; its law has parameters.
    """
    return cast(_HasParameters, contact.normal_law).parameters


def parameters_at_points(site: LawSite) -> dict[str, Array]:
    """Parameters in the scene's table at all points of a contact, by name, (points,) each."""
    count = len(site.trace.weights)
    return {name: np.full(count, value) for name, value in given_parameters(site.contact).items()}
