"""Laws whose forces follow the jump: the displacement relative to what stands opposite.

What such a law says is its energy density ψ (``energy_law``), or its pressure alone
(``formula_law``).
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import ufl
from dolfinx.fem import Form as CompiledForm
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.law import name_in_table
from fenics_contact.contact.laws.normal.law import NormalGradient, NormalLaw
from fenics_contact.contact.laws.point_values import PointDensity
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.values import Value


def depth_of(jump: Expr, normal: Expr, gap: Expr) -> Expr:
    """w_n − s: how deep a point is in what stands opposite (length)."""
    return ufl.dot(jump, normal) - gap


def positive(depth: Expr) -> Expr:
    """⟨d⟩ = max(d, 0): the penetration of a depth (length)."""
    return ufl.conditional(ufl.gt(depth, 0), depth, 0)


@dataclass(frozen=True, eq=False)
class _AtJump:
    """Slopes and curvatures of a density at one jump, each found when it is asked for first.

    Attributes:
        points: The density.
        values: Of its variables, the jump among them.
        gap: At which depths were taken (length).
        normals: Unit normals, (points, components).
        softness: What it is divided by.
    """

    points: PointDensity
    values: dict[str, Array]
    gap: Array
    normals: Array
    softness: float

    def is_of(self, jump: Array, gap: Array, softness: float) -> bool:
        """Whether they are those of a jump; gaps that change are other arrays."""
        same = self.softness == softness and self.gap is gap
        return same and (self.values["jump"] is jump or np.array_equal(self.values["jump"], jump))

    @cached_property
    def slopes(self) -> Array:
        """In the jump, (points, components) (stress)."""
        found = self.points.slope("depth", **self.values)[:, None] * self.normals
        if not self.points.vanishes("jump"):
            found += self.points.slope("jump", **self.values)
        return found / self.softness

    @cached_property
    def pressure(self) -> Array:
        """The part of these across the surface, (points,) (stress)."""
        return np.asarray(np.einsum("ij,ij->i", self.slopes, self.normals))

    @cached_property
    def across(self) -> Array:
        """Second ones in the depth, (points,) (stress/length)."""
        return self.points.curvature("depth", **self.values) / self.softness

    @cached_property
    def mixed(self) -> Array | None:
        """Mixed second derivative in depth and jump, (points, components) (stress/length), or None.

        As where pressure follows the depth alone.
        """
        if self.points.vanishes("depth", "jump"):
            return None
        return self.points.curvatures("depth", "jump", **self.values)[:, 0] / self.softness

    @cached_property
    def pressure_slope(self) -> Array:
        """Derivative of the pressure in the jump, (points, components) (stress/length)."""
        if self.points.vanishes("jump"):
            return self.across[:, None] * self.normals
        return np.asarray(np.einsum("ij,ijk->ik", self.normals, self.tangent))

    @cached_property
    def tangent(self) -> Array:
        """All of them in the jump, (points, components, components) (stress/length)."""
        points, normals = self.points, self.normals
        found = self.across[:, None, None] * normals[:, :, None] * normals[:, None, :]
        if self.mixed is not None:
            product = normals[:, :, None] * self.mixed[:, None, :]
            found += product + product.swapaxes(1, 2)
        if not points.vanishes("jump", "jump"):
            found += points.curvatures("jump", "jump", **self.values) / self.softness
        return found


class SpringLaw(NormalLaw):
    """A law whose forces are minus the gradient of an energy density ψ of depth and jump.

    Be that known in UFL or not: numbers at the points, forms and tangents are all that is asked.
    """

    follows_jump: ClassVar[bool] = True
    pushes_only: ClassVar[bool] = True
    checks: tuple[str, ...] = (
        "contact_law",
        "complementarity",
        "tension",
        "pressure_recovery",
    )

    def __init__(self, site: LawSite) -> None:
        super().__init__(site)
        trace, kinematics = site.trace, site.kinematics
        self._fields = dict(self.fields())
        self._known: _AtJump | None = None
        # Where no obstacle stands, a gap that nothing closes.
        self._far = 1e3 * trace.extent()
        self._gap = trace.function(np.zeros(len(trace.weights)))
        self.set_gap(kinematics.gap)

    @cached_property
    def _in_ufl(self) -> dict[str, Expr]:
        """The density's parameters; collective when first asked for."""
        trace = self.site.trace
        return {name: trace.coefficient(found) for name, found in self._fields.items()}

    @property
    @abstractmethod
    def residual(self) -> CompiledForm:
        """The virtual work of its forces, with the sign of an energy's derivative."""

    @property
    @abstractmethod
    def tangent(self) -> CompiledForm:
        """Derivative of ``residual`` in the jump."""

    @property
    def exerts_shear(self) -> bool:
        """Whether ψ depends on the jump besides the depth."""
        return not self._at_points.vanishes("jump")

    @abstractmethod
    def fields(self) -> Mapping[str, Array]:
        """Parameters of the density at the points, by name, each (points,)."""

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the parameters that are named as keys of the scene's ``normal_law``."""
        name = name_in_table(key, "normal_law")
        return {name: self.site.given(unit, key)} if name in self._fields else {}

    @property
    def forms(self) -> tuple[CompiledForm, ...]:
        """All compiled forms."""
        return (self.residual, self.tangent)

    @property
    def tangents(self) -> tuple[CompiledForm, ...]:
        """Forms of the tangent."""
        return (self.tangent,)

    @abstractmethod
    def pressure_ufl(self, jump: Expr) -> Expr:
        """The pressure of a jump in UFL: ψ's slope across the surface (stress)."""

    def set_gap(self, gap: Array) -> None:
        """Follow an obstacle that moves along the surface."""
        self._gap.set(np.where(np.isfinite(gap), gap, self._far))

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        return -self.site.trace.surface.assemble(self.residual)

    @property
    @abstractmethod
    def _at_points(self) -> PointDensity:
        """ψ as numbers at the points, with its slopes and curvatures."""

    def _values(self, jump: Array) -> dict[str, Array]:
        """Values of the density's variables; the depth is 0 where nothing stands opposite."""
        return self._at_depth(self.depth(jump)) | {"jump": jump}

    def _at_depth(self, depth: Array) -> dict[str, Array]:
        jump = np.zeros_like(self.site.trace.normals)
        return {"depth": np.where(np.isfinite(depth), depth, 0.0), "jump": jump, **self._fields}

    def _slopes(self, jump: Array) -> Array:
        """Minus the traction on the body, (points, components) (stress)."""
        return self._at(jump).slopes

    def _at(self, jump: Array) -> _AtJump:
        """The density's slopes and curvatures at a jump, kept as long as the jump is the same."""
        known, gap, softness = self._known, self.site.kinematics.gap, self.penalty.softness
        if known is None or not known.is_of(jump, gap, softness):
            normals = self.site.trace.normals
            kept = jump.copy() if jump.flags.writeable else jump
            known = _AtJump(self._at_points, self._values(kept), gap, normals, softness)
            self._known = known
        return known

    def pressure(self, jump: Array) -> Array:
        """Contact pressure at the points at a jump, > 0 in compression (stress)."""
        return self._at(jump).pressure

    def at_points(self) -> Array:
        """Traction on the body at the points, (points, components) (stress)."""
        return -self._slopes(self.site.kinematics.jump_at_points())

    def tangent_at_points(self) -> Array:
        """Second derivative of ψ in the jump, (points, components, components)."""
        return self._at(self.site.kinematics.jump_at_points()).tangent

    def pressure_slope(self, jump: Array) -> Array:
        """Derivative of ``pressure_ufl`` in the jump, (points, components) (stress/length)."""
        return self._at(jump).pressure_slope

    def stiffness(self, depth: Array) -> Array:
        """Derivative of the pressure in the depth, at a depth of the points (stress/length)."""
        found = self._at_points.curvature("depth", **self._at_depth(depth))
        return found / self.penalty.softness

    def traction(self, jump: Array) -> Array:
        """Traction along the surface on the body at a jump, (points, components) (stress)."""
        return 0.0 - self.site.kinematics.tangential(self._slopes(jump))

    def stored(self, jump: Array) -> Array:
        """ψ at the points at a jump (energy/area)."""
        return self._at_points.value(**self._values(jump)) / self.penalty.softness

    def vjp(self, jump: Array, of_slopes: Array, of_energy: Array) -> NormalGradient:
        """Vector-Jacobian product, from the curvatures of the energy ψ."""
        acts, values = self.acts(self.pressure(jump)), self._values(jump)
        factor = np.where(acts, 1 / self.penalty.softness, 0.0)
        across = factor * self.site.kinematics.normal(of_slopes)
        along, energy = factor[:, None] * of_slopes, factor * of_energy

        def of(name: str) -> Array:
            points = self._at_points
            found = points.curvatures(name, "depth", **values)[:, :, 0] * across[:, None]
            found = found + np.einsum(
                "ijk,ik->ij", points.curvatures(name, "jump", **values), along
            )
            slopes = points.slope(name, **values).reshape(found.shape)
            return np.where(acts[:, None], found + slopes * energy[:, None], 0.0)

        depth = of("depth")
        return NormalGradient(
            jump=depth * self.site.trace.normals + of("jump"),
            gap=0.0 - depth[:, 0],
            fields={name: of(name)[:, 0] for name in self._fields},
        )

    def can_press(self) -> Flags:
        """Points before which something stands, and where it is stiff."""
        trace = self.site.trace
        depth = np.full(len(trace.weights), trace.extent())
        deep = self._at_points.slope("depth", **self._at_depth(depth))
        return self.site.kinematics.reached & (deep > 0)

    def acts(self, pressure: Array) -> Flags:
        """Points that press; all of them where the law pulls as well, (points,)."""
        return np.asarray((pressure > 0) | (not self.pushes_only))
