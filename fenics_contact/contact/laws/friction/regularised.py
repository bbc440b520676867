"""Friction with a bound: j_ε of the jump, with its primal-dual tangent."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np

from fenics_contact.body.forms import CompiledForm, Expr, Form
from fenics_contact.common.arrays import Array, Flags, Words
from fenics_contact.common.parallel import largest
from fenics_contact.contact.laws.energies import smoothed_norm
from fenics_contact.contact.laws.friction.friction_forms import FrictionForms
from fenics_contact.contact.laws.friction.law import FrictionGradient, FrictionLaw
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.friction.tangent_at_points import PrimalDual
from fenics_contact.contact.laws.friction.tangent_state import TangentState
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.point_values import PointDensity, point_density
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.state import OPEN, SLIP, STICK, ContactState
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.results.point_arrays import PointArray
from fenics_contact.scene.values import Value

# Where the bound is not to be seen from the pressure, results have it at the points.
_WRITTEN_BOUND = PointArray("bound", "stress", column="friction_bound")


class RegularisedFriction(FrictionLaw):
    """j_ε (paper, (2.7)) with its primal-dual tangent, bounded by a rule."""

    follows_jump: ClassVar[bool] = True
    model: ClassVar[str] = "regularised friction"
    rubs: ClassVar[bool] = True
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
        self._held = np.zeros_like(self.reference)
        self._strength = 1.0
        self.stick_all()
        given = rule.longest_elastic_slip or site.contact.regularisation_parameter
        if given != "auto":
            self.set_scale(float(given))

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
    def energy(self) -> Form:
        """j_ε as a UFL form."""
        return self._forms.energy

    @property
    def residual(self) -> CompiledForm:
        """Its first derivative."""
        return self._forms.residual

    @property
    def tangent(self) -> CompiledForm:
        """The primal-dual tangent."""
        return self._forms.tangent

    @property
    def forms(self) -> tuple[CompiledForm, ...]:
        """The compiled forms that every solve needs."""
        return (self.residual, self.tangent)

    @property
    def tangents(self) -> tuple[CompiledForm, ...]:
        """Forms of the tangent in the present mode."""
        if self.mode == "coupled" and self.neighbours is None:
            return (self.tangent, self._forms.coupling)
        return (self.tangent,) if self.mode in ("law", "status", "coupled") else ()

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

    def regularise_less(self, left: float) -> None:
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

    def strengthen(self, factor: float) -> None:
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
            strongest = largest(self.site.trace.spaces.comm, self.to_be_resolved(self.bound))
            self.set_scale(self.site.scales.regularisation_parameter(strongest))

    def hold(self, traction: Array) -> None:
        """Set the tractions of the modes ``held`` and ``status``, (points, components)."""
        self._held = traction

    def _held_force(self) -> Array:
        """Of the tractions that are held, at all nodes of the surface; collective."""
        function, work = self._forms.tractions
        function.set(self._held)
        return self.site.trace.surface.assemble(work)

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        assemble = self.site.trace.surface.assemble
        if self.mode == "off":
            return super().force()
        if self.mode == "held":
            return self._held_force()
        if self.mode == "status":
            return self._held_force() - assemble(self._forms.springs)
        return -assemble(self.residual)

    def at_points(self) -> Array:
        """Traction on the body at the points, (points, components) (stress)."""
        kinematics = self.site.kinematics
        if self.mode == "off":
            return super().at_points()
        if self.mode == "held":
            return kinematics.tangential(self._held)
        if self.mode == "status":
            return kinematics.tangential(self._held) - self._primal_dual.springs
        return self.traction(kinematics.tangential(kinematics.jump_at_points()))

    def tangent_at_points(self) -> Array:
        """The primal-dual tangent in the present mode, (points, components, components)."""
        if self.mode not in ("law", "status", "coupled"):
            return super().tangent_at_points()
        state = self._primal_dual
        found = state.tangent
        if self.mode == "coupled" and self.neighbours is None:
            jump = self.site.kinematics.jump_at_points()
            steep = self.bound_slope(self.normal.pressure(jump))
            found += state.coupling(steep[:, None] * self.normal.pressure_slope(jump))
        return found

    @property
    def neighbours(self) -> SurfaceAverage | None:
        """Those whose pressures the bound averages."""
        return self.rule.neighbours

    def tangent_between_points(self) -> Array:
        """What a bound that follows the pressures of neighbours adds; collective."""
        neighbours = self.neighbours
        size = self.reference.shape[1]
        if neighbours is None or self.mode != "coupled":
            return np.zeros((0 if neighbours is None else len(neighbours.rows), size, size))
        jump = self.site.kinematics.jump_at_points()
        steep = self.bound_slope(self.normal.pressure(jump))
        slopes = neighbours.gathered(self.normal.pressure_slope(jump))
        along = self._primal_dual.along * steep[:, None, None]
        weighted = neighbours.weights[:, None] * slopes[neighbours.columns]
        return np.asarray(along[neighbours.rows] * weighted[:, None, :])

    @property
    def _primal_dual(self) -> PrimalDual:
        """Of the present state."""
        jump = self.site.kinematics.jump_at_points()
        return PrimalDual(
            jump=jump - self.reference,
            normal=self.site.trace.normals,
            bound=self.bound,
            epsilon=self.regularisation_parameter,
            direction=self._tangent_state.direction_at_points,
            length=self._tangent_state.length_at_points(self.regularisation_parameter),
            metric=self.rule.metric,
        )

    def stick_all(self) -> None:
        """Set the tangent to the adhesive start: u_T = 0 and no friction yet."""
        nothing = np.zeros_like(self.reference)
        self.take_tangent_state((nothing, nothing))

    def slip_all(self, slip: Array) -> None:
        """Set the tangent to points that have slipped.

        Args:
            slip: As the law counts it, nowhere 0, (points, components) (length).
        """
        felt = self.rule.metric.at(slip)
        self.take_tangent_state((felt, felt / np.linalg.norm(felt, axis=1)[:, None]))

    @property
    def tangent_state(self) -> tuple[Array, Array]:
        """Slip and direction that the tangent is at, to take again; (points, components) each."""
        return self._tangent_state.slip_and_direction

    def take_tangent_state(self, state: tuple[Array, Array]) -> None:
        """Set the tangent as it was after another solve."""
        self._tangent_state.take(state, self.regularisation_parameter)

    def follow(self, slip: Array) -> None:
        """Move the tangent to a new state: q by its own linearised equation, |q| ≤ 1.

        Args:
            slip: w_T since the start at the points, shape (points, components) (length).
        """
        if self.mode in ("law", "coupled"):
            self._tangent_state.follow(self.felt(slip), self.regularisation_parameter)

    def take_true_tangent(self, slip: Array) -> None:
        """Set the tangent to the law's own derivative, from now on with nothing left stiff."""
        self._tangent_state.take_true(self.felt(slip), self.regularisation_parameter)

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

    def recall(self, at_points: Mapping[str, Array]) -> None:
        """Follow the law as after a load step, whatever has been tried since.

        Args:
            at_points: As ``remember`` gave them, among others.
        """
        super().recall(at_points)
        self._rule_takes_kept()
        self.mode = "law"
        self.set_share(1.0)
        self.set_bound(self.bound)
        self._count_from(self.reference)

    def at_step_end(self, state: ContactState) -> dict[str, Array]:
        """What its rule keeps."""
        return self.rule.at_step_end(self.counted(state.slip), state.status != OPEN)

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

    def counted(self, slip: Array) -> Array:
        """The slip that the law sees: since the start, or since the last accepted step."""
        return slip - self.reference

    def sliding(self, slip: Array) -> Array:
        """The slip that counts, less what goes back."""
        counted = self.counted(slip)
        return counted - self.rule.elastic(counted)

    def stored(self, traction: Array, slip: Array) -> Array:
        """−½ σ_T · s_e of the elastic slip."""
        elastic = self.rule.elastic(self.counted(slip))
        return np.asarray(0.0 - 0.5 * np.einsum("ij,ij->i", traction, elastic))

    def set_status(self, sticks: Flags, directions: Array, bound: Array) -> None:
        """Springs g/ε on points that stick, friction against directions on those that slip."""
        self.mode = "status"
        self.set_bound(np.where(sticks, bound, 0.0))
        self.hold(self.pull(np.where(sticks, 0.0, bound), directions))
        self.stick_all()

    def glue(self, stiffness: float, points: Flags) -> None:
        """Springs along the surface at some points (stress/length), whatever the pressure."""
        bound = np.where(points, stiffness * self.regularisation_parameter, 0.0)
        self.set_status(np.ones(len(bound), dtype=bool), np.zeros_like(self.reference), bound)

    def traction(self, slip: Array) -> Array:
        """−g φ_ε′ at the points for a slip since the start (paper, (2.8)) (stress)."""
        return 0.0 - self._at_points.slope("slip", **self._values(slip))

    def _values(self, slip: Array) -> dict[str, Array | float]:
        """Of the variables of ``_at_points`` at a slip since the start."""
        epsilon, fields = self.regularisation_parameter, self.rule.metric.fields
        return {"slip": self.counted(slip), "bound": self.bound, "epsilon": epsilon, **fields}

    def pulled_back(self, slip: Array, pressure: Array, of_traction: Array) -> FrictionGradient:
        """By the second derivatives of g φ_ε; g follows the rule's fields and the pressure."""
        values = self._values(slip)

        def of(name: str) -> Array:
            found = self._at_points.curvatures("slip", name, **values)
            return np.asarray(0.0 - np.einsum("ijk,ij->ik", found, of_traction))

        of_slip, of_bound = of("slip"), of("bound")[:, 0]
        rule = self.rule.pulled_back(pressure, float(self._forms.share.value) * of_bound)
        metric = self.rule.metric.fields
        fields = {
            name: of_field + (of(name)[:, 0] if name in metric else 0.0)
            for name, of_field in rule.fields.items()
        }
        return FrictionGradient(
            slip=of_slip,
            reference=0.0 - of_slip,
            pressure=rule.pressure,
            fields={**fields, "regularisation_parameter": of("epsilon")[:, 0]},
        )

    def step_end_pulled_back(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """As its rule makes them."""
        if not of_end:
            return super().step_end_pulled_back(slip, closed, of_end)
        return self.rule.step_end_pulled_back(self.counted(slip), closed, of_end)

    def reference_pulled_back(self, of_reference: Array) -> tuple[Array, Mapping[str, Array]]:
        """The slip then, less what goes back, if the law is incremental."""
        if self._forms.accepted is None:
            return super().reference_pulled_back(of_reference)
        return of_reference, self.rule.carried_pulled_back(0.0 - of_reference)

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Of ε in itself, and of what its rule has."""
        if key == "regularisation_parameter":
            return {key: np.ones_like(self.bound)}
        return self.rule.field_slopes(key, unit)

    @cached_property
    def _at_points(self) -> PointDensity:
        metric, components = self.rule.metric, self.site.trace.surface.components
        return point_density(
            _density(metric.felt), slip=components, bound=0, epsilon=0, **metric.sizes
        )

    def status(self, closed: Flags, slip: Array, bound: Array) -> Words:
        """STICK where |M u_T| ≤ ε and friction acts, SLIP beyond, OPEN without contact."""
        small = np.linalg.norm(slip, axis=1) <= self.regularisation_parameter
        return np.where(closed, np.where((bound > 0) & small, STICK, SLIP), OPEN)

    def status_at_rest(self, closed: Flags) -> Words:
        """What touches sticks, if it is rough."""
        return np.where(closed, np.where(self.rule.largest_coefficient > 0, STICK, SLIP), OPEN)


@lru_cache
def _density(felt: Callable[..., Expr]) -> Callable[..., Expr]:
    """The density g φ_ε of a slip as friction feels it, in UFL (energy/area)."""

    def density(slip: Expr, bound: Expr, epsilon: Expr, **fields: Expr) -> Expr:
        return bound * smoothed_norm(felt(slip, **fields), epsilon)

    return density
