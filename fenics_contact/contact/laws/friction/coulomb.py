"""Bounds of friction: Coulomb's rule and its relatives, and those that users write."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from typing import ClassVar, Protocol, cast

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.friction.rule import FrictionRule
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.point_values import in_ufl
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.results.contact_points import PointArray
from fenics_contact.scene.laws.friction_laws import (
    ComplianceFriction,
    FormulaFriction,
    MicroSlipFriction,
    NonlocalFriction,
)
from fenics_contact.scene.values import Value


class Coulomb(FrictionRule):
    """g = μ p (paper, (1.6)); under a pressure that is given, the paper's case (i)."""

    kind: ClassVar[str] = "coulomb"
    is_proportional: ClassVar[bool] = True

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """Bound μ p (stress)."""
        return fields["coefficient"] * pressure

    @property
    def largest_coefficient(self) -> Array:
        """Coefficient μ, (points,)."""
        return self.coefficient


class MicroSlip(Coulomb):
    """t = μ p s_e/l, |s_e| ≤ l: the paper's φ_ε with a length l of the surfaces in place of ε.

    J. T. Oden, E. B. Pires, J. Appl. Mech. 50 (1983) 67-76. The slip is an elastic part s_e, which
    goes back, and what is beyond l, which does not. By the incremental law each load step goes on
    from the elastic part that the steps before have left. Points that open lose it.
    """

    kind: ClassVar[str] = "micro-slip"
    is_proportional: ClassVar[bool] = False
    state: ClassVar[tuple[PointArray, ...]] = (
        PointArray("elastic_slip", "length", is_vector=True),
    )

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        given = site.contact.friction_law
        assert isinstance(given, MicroSlipFriction)
        self.longest_elastic_slip = self._longest = given.elastic_slip
        self._carried = np.zeros_like(site.trace.normals)

    @property
    def is_linear(self) -> bool:
        """The bound is μ p."""
        return True

    @property
    def carried_slip(self) -> Array:
        """The elastic slip at the end of the load step before."""
        return self._carried

    def elastic(self, slip: Array) -> Array:
        """The elastic part of a slip: along it, and no longer than l."""
        size = np.linalg.norm(slip, axis=1)
        return np.asarray(slip * (self._longest / np.maximum(size, self._longest))[:, None])

    def at_step_end(self, slip: Array, closed: Flags) -> dict[str, Array]:
        """The elastic slip of points that touch."""
        return {"elastic_slip": np.where(closed[:, None], self.elastic(slip), 0.0)}

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """Transposed derivative of ``at_step_end``, in the slip and in its longest part l."""
        of_elastic = np.where(closed[:, None], of_end["elastic_slip"], 0.0)
        size = np.linalg.norm(slip, axis=1)
        slides = size > self._longest
        along = np.where(slides[:, None], slip / np.where(slides, size, 1.0)[:, None], 0.0)
        of_longest = np.einsum("ij,ij->i", of_elastic, along)
        of_slip = of_elastic - of_longest[:, None] * along
        of_slip *= (self._longest / np.maximum(size, self._longest))[:, None]
        return of_slip, {"regularisation_parameter": of_longest}

    def vjp_carried_slip(self, of_carried: Array) -> Mapping[str, Array]:
        """Gradient in the elastic slip, which is the carried slip itself."""
        return {"elastic_slip": of_carried}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of Coulomb's parameters, and of l, which stands in the place of ε."""
        if key == "friction_law.elastic_slip":
            return {"regularisation_parameter": np.ones_like(self.coefficient)}
        return super().field_slopes(key, unit)

    def take(self, kept: Mapping[str, Array]) -> None:
        """Go on from the elastic slip."""
        self._carried = kept["elastic_slip"]


class Nonlocal(Coulomb):
    """g = μ (w_ρ ∗ p), averaged over a radius ρ along the surface (``surface/averaging``).

    G. Duvaut, C. R. Acad. Sci. Paris A 290 (1980) 263-265; J. T. Oden, E. B. Pires, J. Appl. Mech.
    50 (1983) 67-76. Only where something stands opposite; also at open points within ρ of others
    that press.
    """

    kind: ClassVar[str] = "nonlocal"
    is_proportional: ClassVar[bool] = False

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        given = site.contact.friction_law
        assert isinstance(given, NonlocalFriction)
        self.neighbours: SurfaceAverage = SurfaceAverage(site.trace, given.averaging_radius)

    @property
    def is_linear(self) -> bool:
        """Whether the bound grows in proportion with all pressures: an average does."""
        return True

    def averaged(self, pressure: Array) -> Array:
        """The pressure w_ρ ∗ p."""
        self._follow_reach()
        return self.neighbours.apply(pressure)

    def average_transposed(self, of_averaged: Array) -> Array:
        """Gradient in the pressure at all points, by the transposed average."""
        self._follow_reach()
        return self.neighbours.transposed(of_averaged)

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """A larger radius changes the averaged pressure."""
        if key != "friction_law.averaging_radius":
            return super().field_slopes(key, unit)
        self._follow_reach()
        pressure = self.normal.pressure(self.site.kinematics.jump_at_points())
        return {"averaged": self.neighbours.radius_slope(pressure)}

    def _follow_reach(self) -> None:
        """Average over the points that have something opposite now: there may be others later."""
        everywhere = np.ones(len(self.coefficient), dtype=bool)
        is_given = self.normal.pressure_is_known
        self.neighbours.over(everywhere if is_given else self.site.kinematics.reached)


# Depths over the size of the surface, between which the ratio of bound and pressure is looked at.
_DEPTHS = np.array([1e-6, 1.0])


class Compliance(FrictionRule):
    """g = c_t ⟨d⟩^m_t at a depth d, which the pressure p = c ⟨d⟩^m says: d = (p/c)^(1/m).

    J. T. Oden, J. A. C. Martins, Models and computational methods for dynamic friction phenomena,
    Computer Methods in Applied Mechanics and Engineering 52 (1985) 527-634, Section 2. With
    m_t = m it is Coulomb's law, μ = c_t/c; else μ varies as p^(m_t/m − 1).
    """

    kind: ClassVar[str] = "compliance"
    is_proportional: ClassVar[bool] = False

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        self.coefficient = site.given(self._table.coefficient, "friction_law.coefficient")

    @cached_property
    def fields(self) -> Mapping[str, Array]:
        """c_t and c at the points, and the exponents."""
        stiffness, exponent = self.normal.power_of_depth
        return {"coefficient": self.coefficient, "stiffness": stiffness, "exponent": exponent}

    @property
    def constants(self) -> Mapping[str, float]:
        """Exponent m_t of the depth d in the bound on friction, c_t ⟨d⟩^m_t."""
        return {"own_exponent": self._table.exponent}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of its own numbers, and of those of the law across the contact."""
        own = {"friction_law.coefficient": "coefficient", "friction_law.exponent": "own_exponent"}
        if key in own:
            return {own[key]: self.site.given(unit, key)}
        across = self.normal.field_slopes(key, unit)
        names = zip(self.normal.names_of_power, ("stiffness", "exponent"), strict=False)
        return {mine: across[theirs] for theirs, mine in names if theirs in across}

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """Bound c_t (p/c)^(m_t/m) (stress)."""
        # Powers are kept away from 0, where their slopes are not numbers.
        pressed = ufl.conditional(ufl.gt(pressure, 0), pressure, 1.0)
        power = fields["own_exponent"] / fields["exponent"]
        found = fields["coefficient"] * (pressed / fields["stiffness"]) ** power
        return ufl.conditional(ufl.gt(pressure, 0), found, 0.0)

    @property
    def largest_coefficient(self) -> Array:
        """Largest ratio at depths between a millionth of the surface's size and the size."""
        stiffness, exponent = self.normal.power_of_depth
        depths = _DEPTHS[:, None] * self.site.trace.extent()
        powers = depths ** (self._table.exponent - exponent)
        rigid = np.where(stiffness > 0, stiffness, np.inf)
        return np.asarray(self.coefficient * powers.max(axis=0) / rigid)

    @property
    def _table(self) -> ComplianceFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, ComplianceFriction)
        return law


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
    formula = in_ufl(text, ("p", "mu", *parameters))

    def bound(pressure: Expr, coefficient: Expr, **fields: Expr) -> Expr:
        found = formula(p=pressure, mu=coefficient, **fields)
        return ufl.conditional(ufl.gt(pressure, 0), found, 0.0)

    return bound
