"""The laws along a contact that a scene names: static, incremental, frictionless and stick."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array, Flags, Words
from fenics_contact.contact.laws.energies import smoothed_norm
from fenics_contact.contact.laws.friction.law import FrictionGradient, FrictionLaw
from fenics_contact.contact.laws.friction.rule import FrictionRule
from fenics_contact.contact.laws.law import defined_in_same_class
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.point_values import PointDensity, point_density
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.state import OPEN, SLIP, STICK, ContactState
from fenics_contact.results.contact_points import PointArray
from fenics_contact.scene.values import Value

# Where the bound is not to be seen from the pressure, results have it at the points.
_WRITTEN_BOUND = PointArray("bound", "stress", column="friction_bound")


class RegularisedFriction(FrictionLaw):
    """j_ε (paper, (2.7)), bounded by a rule; which slip it acts on, classes derived from it say."""

    model: ClassVar[str] = "regularised friction"
    exact_model: ClassVar[str] = "friction"
    has_friction: ClassVar[bool] = True
    carries_shear: ClassVar[bool] = True
    checks: tuple[str, ...] = (
        "friction_cone",
        "friction_law",
        "outer_loop",
        "dissipation",
        "stick_creep",
    )

    def __init__(self, site: LawSite, normal: NormalLaw, rule: FrictionRule) -> None:
        super().__init__(site, normal, rule)
        if not rule.is_proportional:
            self.state = tuple(
                _WRITTEN_BOUND if array.name == "bound" else array for array in self.state
            )
        self.state = (*self.state, *rule.state)
        for array in rule.state:
            shape = self.reference.shape[: 1 + array.is_vector]
            setattr(self, array.name, np.zeros(shape))
        if not self.regularisation.is_numerical:
            self.name = f"friction with {rule.kind} on {site.contact.label}"
            self.checks = tuple(one for one in self.checks if one != "stick_creep")

    @property
    def has_vjp(self) -> bool:
        """Whether ``vjp`` is of its own traction, and its rule has one, too."""
        own = defined_in_same_class(self, "vjp", "traction")
        return own and super().has_vjp and self.rule.has_vjp

    @property
    def derived_state(self) -> set[str]:
        """Names of the arrays by which gradients go back to earlier steps, also of its rule."""
        return super().derived_state | {array.name for array in self.rule.state}

    @property
    def called(self) -> str:
        """The law, or what bounds it where that is not Coulomb's rule."""
        return super().called if self.rule.is_proportional else f"friction law '{self.rule.kind}'"

    def bound_of(self, pressure: Array) -> Array:
        """G that the rule gives at the points (stress)."""
        return self.factor * self.rule.at(pressure)

    def bound_slope(self, pressure: Array) -> Array:
        """Derivative of ``bound_of`` in the pressure at the points, (points,)."""
        return self.factor * self.rule.slope(pressure)

    @property
    def largest_coefficient(self) -> Array:
        """Largest ratio of the bound to a pressure, at the points."""
        return self.factor * self.rule.largest_coefficient

    def accept(self, slip: Array) -> None:
        """Count slip from the end of a load step, less what goes back, if incremental."""
        if self.follows_path:
            self.reference = slip - self.rule.carried_slip

    def recall(self, at_points: Mapping[str, Array]) -> None:
        """Take back the arrays of ``state``, and those of its rule."""
        super().recall(at_points)
        self._rule_takes_kept()

    def at_step_end(self, state: ContactState) -> dict[str, Array]:
        """The arrays that its rule keeps, as they are at the end of a load step.

        Args:
            state: What happens at the points then.
        """
        return self.rule.at_step_end(self.effective_slip(state.slip), state.status != OPEN)

    def shown(self, state: ContactState) -> dict[str, Array]:
        """The bound along the friction traction, where it is another one along each direction."""
        return {"bound": self.rule.metric.bound_along(self.bound, state.friction_traction)}

    def advance(self, state: ContactState) -> None:
        """Accept a load step: the rule takes the state at its end as the one to start from."""
        super().advance(state)
        self._rule_takes_kept()

    def _rule_takes_kept(self) -> None:
        self.rule.take({array.name: getattr(self, array.name) for array in self.rule.state})

    def effective_slip(self, slip: Array) -> Array:
        """The slip that friction acts on: since the start, or since the last accepted step."""
        return slip - self.reference

    def sliding(self, slip: Array) -> Array:
        """The effective slip, less what goes back."""
        effective = self.effective_slip(slip)
        return effective - self.rule.elastic(effective)

    def traction(self, slip: Array) -> Array:
        """−g φ_ε′ at the points for a slip since the start (paper, (2.8)) (stress)."""
        return 0.0 - self._at_points.slope("slip", **self._values(slip))

    def _values(self, slip: Array) -> dict[str, Array | float]:
        """Values of the variables of ``_at_points`` at a slip since the start."""
        epsilon, fields = self.regularisation.parameter, self.rule.metric.fields
        effective = self.effective_slip(slip)
        return {"slip": effective, "bound": self.bound, "epsilon": epsilon, **fields}

    def vjp(self, slip: Array, pressure: Array, of_traction: Array) -> FrictionGradient:
        """Vector-Jacobian product of the traction: the Hessian of g φ_ε, transposed.

        The bound g depends on the fields of the rule and on the pressure.
        """
        values = self._values(slip)

        def of(name: str) -> Array:
            found = self._at_points.curvatures("slip", name, **values)
            return np.asarray(0.0 - np.einsum("ijk,ij->ik", found, of_traction))

        of_slip, of_bound = of("slip"), of("bound")[:, 0]
        rule = self.rule.vjp(pressure, self.factor * of_bound)
        metric = self.rule.metric.fields
        fields = dict(rule.fields)
        for name, field in metric.items():
            fields[name] = fields.get(name, 0.0) + of(name).reshape(field.shape)
        return FrictionGradient(
            slip=of_slip,
            reference=0.0 - of_slip,
            pressure=rule.pressure,
            fields={**fields, "regularisation_parameter": of("epsilon")[:, 0]},
        )

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """Vector-Jacobian product of the state that the rule keeps at the end of a load step."""
        if not of_end:
            return super().vjp_state_update(slip, closed, of_end)
        return self.rule.vjp_state_update(self.effective_slip(slip), closed, of_end)

    def vjp_reference(self, of_reference: Array) -> tuple[Array, Mapping[str, Array]]:
        """Vector-Jacobian product of the reference slip: the slip at the end of the last load step.

        An elastic part of it, which goes back, is left out; it is 0 unless the law is incremental.
        """
        if not self.follows_path:
            return super().vjp_reference(of_reference)
        return of_reference, self.rule.vjp_carried_slip(0.0 - of_reference)

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of ε and of the fields of the rule in a value of the scene."""
        if key == "regularisation_parameter":
            return {key: np.ones_like(self.bound)}
        return self.rule.field_slopes(key, unit)

    def status(self, closed: Flags, slip: Array, bound: Array) -> Words:
        """STICK where |M u_T| ≤ ε and friction acts, SLIP beyond, OPEN without contact."""
        small = np.linalg.norm(slip, axis=1) <= self.regularisation.parameter
        return np.where(closed, np.where((bound > 0) & small, STICK, SLIP), OPEN)

    @cached_property
    def _at_points(self) -> PointDensity:
        metric, components = self.rule.metric, self.site.trace.surface.components
        return point_density(
            _density(metric.scaled), slip=components, bound=0, epsilon=0, **metric.sizes
        )


@lru_cache
def _density(scaled: Callable[..., Expr]) -> Callable[..., Expr]:
    """The density g φ_ε of a slip as friction feels it, in UFL (energy/area)."""

    def density(slip: Expr, bound: Expr, epsilon: Expr, **fields: Expr) -> Expr:
        return bound * smoothed_norm(scaled(slip, **fields), epsilon)

    return density


class Static(RegularisedFriction):
    """σ_T = −g φ_ε′(u_T) (paper, (1.6), (2.8)): what it dissipates is −σ_T · u_T."""

    kind: ClassVar[str] = "static"

    def work(self, given: Array, before: Array, traction: Array, slip: Array) -> Array:
        """−σ_T · u_T since the start, less what goes back."""
        return np.asarray(0.0 - np.einsum("ij,ij->i", traction, self.sliding(slip)))


class Incremental(RegularisedFriction):
    """σ_T = −g φ_ε′(Δu_T), Δu_T the slip of the present load step."""

    kind: ClassVar[str] = "incremental"
    follows_path: ClassVar[bool] = True

    def work(self, given: Array, before: Array, traction: Array, slip: Array) -> Array:
        """Return the work that friction has done along the path through the load steps.

        Of slip that goes back, the work less what it stores: that is 0 unless the pressure changes,
        and springs with it. When the pressure falls, a part of what they stored is lost.
        """
        if not self.stores_energy:
            return given
        now, then = self.rule.elastic(self.effective_slip(slip)), self.rule.carried_slip
        return np.asarray(given - 0.5 * np.sum(before * now - traction * then, axis=1))


class Frictionless(FrictionLaw):
    """σ_T = 0."""

    kind: ClassVar[str] = "none"

    def __init__(self, site: LawSite, normal: NormalLaw, rule: FrictionRule) -> None:
        super().__init__(site, normal, rule)
        # What bounds friction by 0 everywhere; Coulomb's coefficient of 0 means no friction.
        named = site.contact.friction_law
        self.left_out = "" if named is None or named.is_proportional else named.kind


class Stick(FrictionLaw):
    """u_T = 0, whatever the traction."""

    kind: ClassVar[str] = "stick"
    model: ClassVar[str] = "glue along the surface"
    carries_shear: ClassVar[bool] = True

    def status(self, closed: Flags, slip: Array, bound: Array) -> Words:
        """STICK where points are glued on, OPEN elsewhere."""
        return np.where(closed, STICK, OPEN)
