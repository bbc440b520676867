"""Friction with a bound as a part of the energy: j_ε of the jump, with its primal-dual tangent."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np

from fenics_contact.body.forms import CompiledForm, Expr, Form
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.energies import smoothed_norm
from fenics_contact.contact.laws.friction.bounded import BoundedFriction
from fenics_contact.contact.laws.friction.gradient import FrictionGradient
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.friction.tangent_at_points import PrimalDual
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.point_values import PointDensity, point_density
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.surface.averaging import SurfaceAverage


class RegularisedFriction(BoundedFriction):
    """j_ε (paper, (2.7)) with its primal-dual tangent, bounded by a rule."""

    follows_jump: ClassVar[bool] = True
    model: ClassVar[str] = "regularised friction"

    def __init__(self, site: LawSite, normal: NormalLaw, rule: FrictionRule) -> None:
        super().__init__(site, normal, rule)
        self._held = np.zeros_like(self.reference)
        self.stick_all()
        given = rule.longest_elastic_slip or site.contact.regularisation_parameter
        if given != "auto":
            self.set_scale(float(given))

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
            self._tangent_state.follow(self.scaled_slip(slip), self.regularisation_parameter)

    def take_true_tangent(self, slip: Array) -> None:
        """Set the tangent to the law's own derivative, from now on with nothing left stiff."""
        self._tangent_state.take_true(self.scaled_slip(slip), self.regularisation_parameter)

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

    def set_status(self, sticks: Flags, directions: Array, bound: Array) -> None:
        """Springs g/ε on points that stick, friction against directions on those that slip."""
        self.mode = "status"
        self.set_bound(np.where(sticks, bound, 0.0))
        self.hold(self.traction_from_bound(np.where(sticks, 0.0, bound), directions))
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
        return {
            "slip": self.effective_slip(slip),
            "bound": self.bound,
            "epsilon": epsilon,
            **fields,
        }

    def vjp(self, slip: Array, pressure: Array, of_traction: Array) -> FrictionGradient:
        """By the second derivatives of g φ_ε; g follows the rule's fields and the pressure."""
        values = self._values(slip)

        def of(name: str) -> Array:
            found = self._at_points.curvatures("slip", name, **values)
            return np.asarray(0.0 - np.einsum("ijk,ij->ik", found, of_traction))

        of_slip, of_bound = of("slip"), of("bound")[:, 0]
        rule = self.rule.vjp(pressure, float(self._forms.share.value) * of_bound)
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

    @cached_property
    def _at_points(self) -> PointDensity:
        metric, components = self.rule.metric, self.site.trace.surface.components
        return point_density(
            _density(metric.felt), slip=components, bound=0, epsilon=0, **metric.sizes
        )


@lru_cache
def _density(felt: Callable[..., Expr]) -> Callable[..., Expr]:
    """The density g φ_ε of a slip as friction feels it, in UFL (energy/area)."""

    def density(slip: Expr, bound: Expr, epsilon: Expr, **fields: Expr) -> Expr:
        return bound * smoothed_norm(felt(slip, **fields), epsilon)

    return density
