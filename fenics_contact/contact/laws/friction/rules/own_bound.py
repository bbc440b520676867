"""Bounds of friction that users write: as a class of a module of theirs, or as a formula."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from typing import ClassVar, Protocol, cast

import numpy as np
import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws import formulas
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.laws.friction_laws import FormulaFriction

# Pressures, whatever their unit, between which the ratio of bound and pressure is looked at.
_PRESSURES = np.logspace(-9, 9, 361)


class _HasParameters(Protocol):
    parameters: Mapping[str, float]


class UserFriction(FrictionRule):
    """A bound of your own, with the scene's parameters.

    A class derived from it says ``bound`` in UFL, of the pressure, of ``coefficient``, which is the
    scene's friction coefficient, and of its parameters. At the pressure 0 it is to be 0.

    Attributes:
        coefficient: The scene's friction coefficient at the points, (points,).

    Args:
        site: Where it acts; the program makes it.
        normal: The law across the contact.

    >>> class Saturated(UserFriction):
    ...     @staticmethod
    ...     def bound(pressure, coefficient, p0):
    ...         return coefficient * pressure / (1 + pressure / p0)
    """

    @property
    def constants(self) -> Mapping[str, float]:
        """The parameters of the scene's table."""
        return dict(cast(_HasParameters, self.site.contact.friction_law).parameters)

    @cached_property
    def largest_coefficient(self) -> Array:
        """Largest ratio of the bound to pressures from 1e-9 to 1e9, (points,)."""
        count = len(self.coefficient)
        ratios = [self.at(np.full(count, pressure)) / pressure for pressure in _PRESSURES]
        return np.asarray(np.nanmax(ratios, axis=0))


class FormulaBound(UserFriction):
    """A bound by a formula of the pressure p and of the friction coefficient, mu."""

    kind: ClassVar[str] = "formula"

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        law = site.contact.friction_law
        assert isinstance(law, FormulaFriction)
        self.bound = _bound_of(law.bound, tuple(law.parameters))


@lru_cache
def _bound_of(text: str, parameters: tuple[str, ...]) -> Callable[..., Expr]:
    """The formula as a function of pressure, coefficient and parameters."""
    formula = formulas.in_ufl(text, ("p", "mu", *parameters))

    def bound(pressure: Expr, coefficient: Expr, **fields: Expr) -> Expr:
        found = formula(p=pressure, mu=coefficient, **fields)
        return ufl.conditional(ufl.gt(pressure, 0), found, 0.0)

    return bound
