"""A pressure that a scene gives as a formula of the depth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np
import ufl
from dolfinx.fem import Form as CompiledForm
from ufl.core.expr import Expr

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.normal.energy_law import (
    given_parameters,
    parameters_at_points,
)
from fenics_contact.contact.laws.normal.law import Parameter
from fenics_contact.contact.laws.normal.spring import SpringLaw, depth_of
from fenics_contact.contact.laws.point_values import PointDensity, in_ufl, point_density
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws import law_tables

# Of ∫₀¹ f(s) ds with s = t⁴, so that roots and powers at s = 0 are as good as polynomials.
_ROOTS, _WEIGHTS = np.polynomial.legendre.leggauss(40)
_PLACES = (0.5 * (_ROOTS + 1)) ** 4
_SHARES = 0.5 * _WEIGHTS * 4 * (0.5 * (_ROOTS + 1)) ** 3


class FormulaLaw(SpringLaw):
    """p = the formula at a depth d > 0, and 0 where the body is off; ψ(d) = ∫₀ᵈ p.

    Forces and tangent are of p itself; the energy, which nothing but results asks for, is an
    integral by Gauss' rule: UFL does not integrate.
    """

    kind: ClassVar[str] = "formula"
    model: ClassVar[str] = "pressure by a formula"

    @property
    def _pressure(self) -> Callable[..., Expr]:
        given = _table(self.site.contact)
        return _pressure(given.pressure, tuple(given.parameters))

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """Parameters of the formula, from the scene's table."""
        return dict(given_parameters(contact))

    def fields(self) -> Mapping[str, Array]:
        """The parameters, the same at all points."""
        return parameters_at_points(self.site)

    def pressure_ufl(self, jump: Expr) -> Expr:
        """The formula at the depth of a jump (stress)."""
        depth = depth_of(jump, self.site.trace.normal, self._gap.ufl)
        return self._pressure(depth, **self._in_ufl) / self.penalty.softness_in_ufl

    @cached_property
    def residual(self) -> CompiledForm:
        """∫ p v_n of all v."""
        return form_cache.form(self._work)

    @cached_property
    def tangent(self) -> CompiledForm:
        """Derivative of ``residual`` in the jump."""
        return form_cache.form(ufl.derivative(self._work, self.site.kinematics.jump))

    @property
    def _work(self) -> Expr:
        trace, jump = self.site.trace, self.site.kinematics.jump
        test = ufl.TestFunction(jump.ufl_function_space())
        along = ufl.dot(test, trace.normal)
        return trace.weight * self.pressure_ufl(jump) * along * trace.measure

    @cached_property
    def _at_points(self) -> PointDensity:
        fields = dict.fromkeys(self._fields, 0)
        return _PointPressure(point_density(self._pressure, depth=0, **fields))


class _PointPressure(PointDensity):
    """A pressure at the points in the place of the energy density whose derivative it is.

    Args:
        pressure: Of the depth and the parameters.
    """

    def __init__(self, pressure: PointDensity) -> None:
        self._pressure = pressure

    def value(self, **values: Array | float) -> Array:
        """The integral of the pressure up to the depth (energy/area)."""
        return self._integral(lambda inside: self._pressure.value(**inside), values)

    def slope(self, of: str, **values: Array | float) -> Array:
        """In the depth the pressure; in a parameter the integral of its slope; none else."""
        jump = values.pop("jump")
        if of == "jump":
            return np.zeros_like(jump)
        if of == "depth":
            return self._pressure.value(**values)
        return self._integral(lambda inside: self._pressure.slope(of, **inside), values)

    def vanishes(self, *along: str) -> bool:
        """Whether the jump is among the variables: nothing follows it."""
        return "jump" in along

    def curvature(self, of: str, **values: Array | float) -> Array:
        """In the depth: the slope of the pressure."""
        return self.curvatures(of, "depth", **values)[:, 0, 0]

    def curvatures(self, of: str, then: str, **values: Array | float) -> Array:
        """In one variable and in the depth: the slope of the pressure in the one."""
        count, components = np.shape(values.pop("jump"))
        if "jump" in (of, then):
            sizes = [components if name == "jump" else 1 for name in (of, then)]
            return np.zeros((count, *sizes))
        other = of if then == "depth" else then
        return self._pressure.slope(other, **values)[:, None, None]

    @staticmethod
    def _integral(
        part: Callable[[Mapping[str, Array | float]], Array], values: Mapping[str, Array | float]
    ) -> Array:
        given = {name: value for name, value in values.items() if name != "jump"}
        depth = np.asarray(given["depth"])
        shares = (
            share * part({**given, "depth": place * depth})
            for place, share in zip(_PLACES, _SHARES, strict=True)
        )
        return np.asarray(depth * sum(shares, np.zeros_like(depth)))


@lru_cache
def _pressure(text: str, parameters: tuple[str, ...]) -> Callable[..., Expr]:
    """The pressure in UFL as a function of depth and parameters, the same one for the same text."""
    formula = in_ufl(text, ("d", *parameters))

    def pressure(depth: Expr, **fields: Expr) -> Expr:
        found = formula(d=depth, **fields)
        return ufl.conditional(ufl.gt(depth, 0), found, 0)

    return pressure


def _table(contact: Contact) -> law_tables.PressureFormula:
    law = contact.normal_law
    assert isinstance(law, law_tables.PressureFormula)
    return law
