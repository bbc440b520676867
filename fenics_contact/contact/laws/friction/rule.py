"""The base of rules of a friction bound: how large friction may be under a pressure.

The static and the incremental law hold one. A rule says its bound once, in UFL; the bound's numbers
at the points, its slopes and what it adds to tangents follow from that. Along which directions
of the surface it is that large, its ``metric`` says.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.friction.metric import SlipMetric
from fenics_contact.contact.laws.law import defined_in_same_class, keep_earlier_names, name_in_table
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.point_values import PointDensity, point_density
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.results.contact_points import PointArray
from fenics_contact.scene.values import Value

_EARLIER_NAMES = {
    "pulled_back": "vjp",
    "step_end_pulled_back": "vjp_state_update",
    "carried_pulled_back": "vjp_carried_slip",
    "averaged_back": "average_transposed",
}


# Pressures at points (stress) → bound of friction there (stress), and its slope.
BoundOfPressure = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True, eq=False)
class BoundGradient:
    """Gradient of a quantity in what a bound follows from, at the points.

    Attributes:
        pressure: In the contact pressure, (points,).
        fields: In each parameter of ``FrictionRule.bound`` by name, and in ``averaged``, the
            pressure that it follows, (points,) each.
    """

    pressure: Array
    fields: Mapping[str, Array]


class FrictionRule:
    """The bound g of friction as a function of the contact pressure.

    Attributes:
        kind: As a scene's ``friction_law`` names it.
        site: Where it acts.
        normal: The law across the contact.
        is_proportional: Whether the bound is one coefficient times the pressure.
        state: Arrays at the points that it keeps from load step to load step: the law along the
            contact, which holds the rule, keeps them for it.
        follows_speed: Whether it depends on how fast points slide.
        coefficient: The scene's friction coefficient at the points, (points,).
        neighbours: How it averages the pressure; None where each point goes by its own.
        longest_elastic_slip: The slip that goes back, at which the bound is reached, in place of
            the regularisation parameter; None where no slip does (length).
        metric: How it feels slip.
        bound: G in UFL (stress), a function of ``pressure`` (stress), and of what ``fields``,
            ``constants`` and ``changing`` name; mostly a static method.

    Args:
        site: Where it acts.
        normal: The law across the contact.

    Raises:
        InputError: A value of the scene is negative somewhere; on every rank.
    """

    kind: ClassVar[str]
    bound: Callable[..., Expr]
    is_proportional: ClassVar[bool] = False
    neighbours: SurfaceAverage | None = None
    longest_elastic_slip: float | None = None
    state: ClassVar[tuple[PointArray, ...]] = ()
    follows_speed: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        keep_earlier_names(cls, _EARLIER_NAMES)

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        self.site, self.normal = site, normal
        given = site.contact.friction_coefficient
        self.coefficient = site.given(given, "friction_coefficient")
        self.metric = SlipMetric()

    @cached_property
    def fields(self) -> Mapping[str, Array]:
        """Parameters of ``bound`` at the points, by name, each (points,)."""
        return {"coefficient": self.coefficient}

    @property
    def is_linear(self) -> bool:
        """Whether the bound grows in proportion with all pressures."""
        return self.is_proportional

    @property
    def constants(self) -> Mapping[str, float]:
        """Parameters of ``bound`` that are one number for all points, by name.

        Gradients in keys of the scene's table go by those that are named as they are.
        """
        return {}

    @property
    def changing(self) -> Mapping[str, Expr]:
        """Parameters that load steps change, arrays of ``state``, in UFL, by name."""
        return {}

    @property
    def has_vjp(self) -> bool:
        """Whether it says what the arrays that it keeps do to quantities of later load steps."""
        return defined_in_same_class(self, "at_step_end", "vjp_state_update")

    @property
    def carried_slip(self) -> Array | float:
        """The slip that steps before have left and that goes back (length)."""
        return 0.0

    def elastic(self, slip: Array) -> Array:
        """The part of a slip that goes back, (points, components) (length).

        Args:
            slip: That counts, likewise.
        """
        return np.zeros_like(slip)

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the bound's parameters at the points in a key of the contact; collective.

        Those of the friction coefficient, and of the constants that are named as keys of the
        scene's table. A rule with other numbers says theirs, and no more.

        Args:
            key: Such as ``friction_law.exponent``.
            unit: Derivative of what the scene gives under it, itself a value of a scene.

        Returns:
            Name as of ``BoundGradient.fields`` → (points,); nothing for other keys.
        """
        if key == "friction_coefficient":
            return {"coefficient": self.site.given(unit, key)}
        name = name_in_table(key, "friction_law")
        return {name: np.ones_like(self.coefficient)} if name in self.constants else {}

    def at_step_end(self, slip: Array, closed: Flags) -> dict[str, Array]:
        """The arrays of ``state`` at the end of a load step, by name.

        Args:
            slip: That counts, (points, components) (length).
            closed: Points in contact at its end.
        """
        return {}

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """From a quantity's gradient in the arrays at a step's end to those in what makes them.

        Args:
            slip: As of ``at_step_end``.
            closed: Likewise.
            of_end: Gradient of the quantity in what ``at_step_end`` returns, by name.

        Returns:
            Gradient in the slip, (points, components), and by name in the arrays at the begin
            and in parameters, as of ``BoundGradient.fields``.
        """
        return np.zeros_like(slip), {}

    def vjp_carried_slip(self, of_carried: Array) -> Mapping[str, Array]:
        """From a quantity's gradient in ``carried_slip`` to those in the arrays of ``state``.

        Args:
            of_carried: Gradient of the quantity, (points, components).
        """
        return {}

    def take(self, kept: Mapping[str, Array]) -> None:
        """Go by arrays of ``state`` from now on.

        Args:
            kept: By name, each (points,) or (points, components).
        """

    def follow_speed(self, speed: Array) -> None:
        """Go by it in a step of motion; of use to rules that follow speeds.

        Args:
            speed: Of sliding, (points,) (length/time).
        """

    @property
    @abstractmethod
    def largest_coefficient(self) -> Array:
        """Largest ratio of the bound to a pressure, over all pressures, (points,)."""

    def averaged(self, pressure: Array) -> Array:
        """The pressure that the bound follows at each point (stress); collective.

        Args:
            pressure: At the points (stress).
        """
        return pressure

    def average_transposed(self, of_averaged: Array) -> Array:
        """From a quantity's gradient in ``averaged`` to those in the pressure; collective.

        Args:
            of_averaged: At the points, (points,).
        """
        return of_averaged

    def at(self, pressure: Array) -> Array:
        """The bound at the points (stress); collective.

        Args:
            pressure: At the points (stress).
        """
        return self._at_points.value(pressure=self.averaged(pressure), **self._values)

    def slope(self, pressure: Array) -> Array:
        """Derivative of the bound in the pressure that it follows, at the points; collective.

        Args:
            pressure: At the points (stress).
        """
        return self._at_points.slope("pressure", pressure=self.averaged(pressure), **self._values)

    def of_points(self, gather: Callable[[Array], Array]) -> BoundOfPressure:
        """The present bound as a function of pressures at points of other ranks, too; collective.

        Of rules whose bound at a point depends on the pressure there alone.

        Args:
            gather: Gives values at all points from those at the points of this rank; collective.

        Returns:
            Takes pressures at all points (stress), gives the bound there (stress) and its slope.
        """
        values = {
            name: gather(value) if isinstance(value, np.ndarray) else value
            for name, value in self._values.items()
        }
        density = self._at_points

        def bound(pressure: Array) -> tuple[Array, Array]:
            given = {"pressure": pressure, **values}
            return density.value(**given), density.slope("pressure", **given)

        return bound

    def in_ufl(self, pressure: Expr) -> Expr:
        """The bound on the surface in UFL, for forms (stress).

        Args:
            pressure: Contact pressure on the surface (stress).
        """
        return self.bound(pressure, **self._fields_in_ufl())

    def vjp(self, pressure: Array, of_bound: Array) -> BoundGradient:
        """From a quantity's gradient in the bound to those in pressure and parameters.

        Collective.

        Args:
            pressure: At the points (stress).
            of_bound: Gradient of the quantity in the bound, (points,).
        """
        points, values = self._at_points, {"pressure": self.averaged(pressure), **self._values}
        of_averaged = points.slope("pressure", **values) * of_bound
        return BoundGradient(
            pressure=self.average_transposed(of_averaged),
            fields={"averaged": of_averaged}
            | {name: points.slope(name, **values) * of_bound for name in self._values},
        )

    def _fields_in_ufl(self) -> dict[str, Expr]:
        """Parameters of ``bound`` in UFL, for forms, by name; collective."""
        trace = self.site.trace
        mesh = trace.surface.mesh
        fields = {name: trace.coefficient(values) for name, values in self.fields.items()}
        numbers = {name: fem.Constant(mesh, value) for name, value in self.constants.items()}
        return {**fields, **numbers, **self.changing}

    @property
    def _values(self) -> Mapping[str, Array | float]:
        return {**self.fields, **self.constants}

    @cached_property
    def _at_points(self) -> PointDensity:
        return point_density(self.bound, pressure=0, **dict.fromkeys(self._values, 0))


keep_earlier_names(FrictionRule, _EARLIER_NAMES)
