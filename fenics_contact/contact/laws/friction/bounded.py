"""Friction with a bound: the bound at the points, what slip counts, and the ε that is used."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Words
from fenics_contact.common.parallel import largest
from fenics_contact.contact.laws.friction.friction_forms import FrictionForms
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.friction.tangent_state import TangentState
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.state import OPEN, SLIP, STICK, ContactState
from fenics_contact.results.point_arrays import PointArray
from fenics_contact.scene.values import Value

# Where the bound is not to be seen from the pressure, results have it at the points.
_WRITTEN_BOUND = PointArray("bound", "stress", column="friction_bound")


class BoundedFriction(FrictionLaw):
    """Friction up to a bound by a rule; how it comes to it is up to those that derive from it."""

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
        self._tangent_state = TangentState(site.trace)
        self._forms = FrictionForms(rule, self._tangent_state, self.follows_path)
        if not self.has_regularisation:
            self.name = f"friction with {rule.kind} on {site.contact.label}"
            self.checks = tuple(one for one in self.checks if one != "stick_creep")
        self._chosen, self._left, self._used = 1.0, 1.0, 1.0
        self._strength = 1.0

    @property
    def has_derivatives(self) -> bool:
        """Whether its rule has derivatives, too."""
        return super().has_derivatives and self.rule.has_derivatives

    @property
    def derived_state(self) -> set[str]:
        """That of its rule, too."""
        return super().derived_state | {array.name for array in self.rule.state}

    @property
    def has_regularisation(self) -> bool:
        """Unless its rule has a length of its own."""
        return self.rule.longest_elastic_slip is None

    @property
    def stores_energy(self) -> bool:
        """Where its rule lets slip go back."""
        return self.rule.longest_elastic_slip is not None

    @property
    def finds_scale(self) -> bool:
        """Whether ε follows the pressures that are found; a length of the surfaces never does."""
        return super().finds_scale and self.has_regularisation

    @property
    def called(self) -> str:
        """The law, or what bounds it where that is not Coulomb's rule."""
        return super().called if self.rule.is_proportional else f"friction law '{self.rule.kind}'"

    @property
    def regularisation_parameter(self) -> float:
        """ε as used (length)."""
        return self._used

    @property
    def chosen_parameter(self) -> float:
        """The ε that was set, of which a part may be used (length)."""
        return self._chosen

    def set_scale(self, epsilon: float) -> None:
        """Use an ε from now on, unless it is 0: under no pressure it does not matter (length)."""
        if epsilon > 0:
            self._choose(epsilon)
            self.is_scaled = True

    def _choose(self, epsilon: float) -> None:
        self._chosen = epsilon
        self._used = epsilon * self._left
        self._forms.epsilon.value = self._used

    def scale_regularisation(self, left: float) -> None:
        """Use this part of every ε that is set, from now on, unless it is the surfaces' own."""
        self._left = left if self.has_regularisation else 1.0
        self._choose(self._chosen)

    def set_bound(self, bound: Array) -> None:
        """Set g at the points (stress)."""
        self.bound = bound
        self._forms.bound.set(bound)

    def set_share(self, share: float) -> None:
        """Use this share of the coefficient, from below or above 1, on the way to all of it."""
        self._forms.share.value = share * self._strength

    def scale_coefficient(self, factor: float) -> None:
        """Use so many times the friction coefficient, from now on, also on the way to all of it."""
        self._strength = factor
        self.set_share(1.0)

    def bound_of(self, pressure: Array) -> Array:
        """G that the rule gives at the points (stress)."""
        return float(self._forms.share.value) * self.rule.at(pressure)

    def bound_slope(self, pressure: Array) -> Array:
        """Derivative of ``bound_of`` in the pressure at the points, (points,)."""
        return float(self._forms.share.value) * self.rule.slope(pressure)

    @property
    def largest_coefficient(self) -> Array:
        """Largest ratio of the bound to a pressure, at the points."""
        return float(self._forms.share.value) * self.rule.largest_coefficient

    def present_bound(self, pressure: Array) -> Array:
        """The bound at a pressure of its normal law; a given one is followed as time goes on."""
        return self.bound if self.normal.pressure_is_known else self.bound_of(pressure)

    def follow_given(self, pressure: Array) -> None:
        """Take the bound, and the ε that it needs, from a pressure that is given (stress)."""
        self.set_bound(self.bound_of(pressure))
        if self.has_regularisation and self.site.contact.regularisation_parameter == "auto":
            strongest = largest(
                self.site.trace.spaces.comm, self.bound_for_regularisation(self.bound)
            )
            self.set_scale(self.site.scales.regularisation_parameter(strongest))

    def accept(self, slip: Array) -> None:
        """A load step is done: from now on slip counts from here, if the law is incremental."""
        self._count_from(slip - self.rule.carried_slip)

    def _count_from(self, reference: Array) -> None:
        if self._forms.accepted is not None:
            self.reference = reference
            self._forms.accepted.set(reference)

    def recall_scale(self, epsilon: float, is_scaled: bool) -> None:
        """Use an ε that was used before."""
        self._choose(epsilon)
        self.is_scaled = is_scaled

    def at_step_end(self, state: ContactState) -> dict[str, Array]:
        """What its rule keeps."""
        return self.rule.at_step_end(self.effective_slip(state.slip), state.status != OPEN)

    def shown(self, state: ContactState) -> dict[str, Array]:
        """The bound along the friction traction, where it is another one along each direction."""
        return {"bound": self.rule.metric.bound_along(self.bound, state.friction_traction)}

    def advance(self, state: ContactState) -> None:
        """A load step is done: its rule goes by what it keeps from now on.

        Args:
            state: As of ``at_step_end``.
        """
        super().advance(state)
        self._rule_takes_kept()

    def _rule_takes_kept(self) -> None:
        self.rule.take({array.name: getattr(self, array.name) for array in self.rule.state})

    def effective_slip(self, slip: Array) -> Array:
        """The slip that the law sees: since the start, or since the last accepted step."""
        return slip - self.reference

    def sliding(self, slip: Array) -> Array:
        """The slip that counts, less what goes back."""
        counted = self.effective_slip(slip)
        return counted - self.rule.elastic(counted)

    def stored(self, traction: Array, slip: Array) -> Array:
        """−½ σ_T · s_e of the elastic slip."""
        elastic = self.rule.elastic(self.effective_slip(slip))
        return np.asarray(0.0 - 0.5 * np.einsum("ij,ij->i", traction, elastic))

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """As its rule makes them."""
        if not of_end:
            return super().vjp_state_update(slip, closed, of_end)
        return self.rule.vjp_state_update(self.effective_slip(slip), closed, of_end)

    def vjp_reference(self, of_reference: Array) -> tuple[Array, Mapping[str, Array]]:
        """The slip then, less what goes back, if the law is incremental."""
        if self._forms.accepted is None:
            return super().vjp_reference(of_reference)
        return of_reference, self.rule.vjp_carried_slip(0.0 - of_reference)

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Of ε in itself, and of what its rule has."""
        if key == "regularisation_parameter":
            return {key: np.ones_like(self.bound)}
        return self.rule.field_slopes(key, unit)

    def status(self, closed: Flags, slip: Array, bound: Array) -> Words:
        """STICK where |M u_T| ≤ ε and friction acts, SLIP beyond, OPEN without contact."""
        small = np.linalg.norm(slip, axis=1) <= self.regularisation_parameter
        return np.where(closed, np.where((bound > 0) & small, STICK, SLIP), OPEN)

    def status_at_rest(self, closed: Flags) -> Words:
        """What touches sticks, if it is rough."""
        return np.where(closed, np.where(self.rule.largest_coefficient > 0, STICK, SLIP), OPEN)
