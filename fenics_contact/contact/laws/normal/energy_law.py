"""Laws that say their energy density: forces on the body are minus its first derivative.

It is derived in the jump, a function of a space on the surface.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np
import ufl

from fenics_contact.analytic.complex_step import slope
from fenics_contact.body.forms import CompiledForm, Expr, Form
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.normal.spring import SpringLaw, depth_of
from fenics_contact.contact.laws.point_values import PointDensity, point_density
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.values import Value


class EnergyLaw(SpringLaw):
    """A law with an energy density ψ in UFL; forces and tangent are its derivatives."""

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
        """Its first derivative in the jump."""
        return form_cache.form(ufl.derivative(self.energy, self.site.kinematics.jump))

    @cached_property
    def tangent(self) -> CompiledForm:
        """Its second derivative."""
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
        """1/ε₁."""
        return {"stiffness": np.full(len(self.site.trace.weights), 1 / self._penalty)}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the stiffness in ε₁."""
        if key != "penalty_parameter":
            return {}
        stiffness = self._fields["stiffness"]
        return {"stiffness": self._penalty * slope(lambda e: 1 / e, self._penalty) * stiffness}
