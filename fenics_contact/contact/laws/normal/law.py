"""The base of laws across a contact, and the softness of their penalty at present."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import Form as CompiledForm
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.law import ContactForce, ContactLaw, defined_in_same_class
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.values import PositionFunction, Profile, Value

# What a law says twice: by forms, and at the points.
_TOGETHER = (
    ("force", "at_points"),
    ("tangents", "tangent_at_points"),
    ("loads", "loads_at_points"),
)
# What the scene gives of a law: a number, a profile or a function, None of what it leaves out.
Parameter = float | Profile | PositionFunction | None
# A linear form of what is given, in full, and the share of it that acts at a pseudo-time.
GivenLoad = tuple[CompiledForm, Callable[[float], float]]


@dataclass(frozen=True, eq=False)
class NormalGradient:
    """Gradient of a quantity in what a law across a contact works on, at the points.

    Attributes:
        jump: In the jump, (points, components).
        gap: In the gap, (points,).
        fields: In each parameter of the law, by name, (points,).
    """

    jump: Array
    gap: Array
    fields: Mapping[str, Array]


class NormalLaw(ContactLaw, ContactForce):
    """The law across a contact; this one exerts nothing, and others say what they do instead.

    Attributes:
        sticks: Whether it holds what stands opposite along the surface as well: then the friction
            law is ``stick``.
        has_counterpart: Whether an obstacle or a body stands opposite.
        pressure_is_known: Whether its pressure is given, so that friction has a bound beforehand.
        pushes_only: Whether the body may leave it.
        has_penalty: Whether its stiffness stands for no give at all.
        names_of_power: Where its pressure is a power of the depth, its parameters as
            ``field_slopes`` names them: c, and m unless that never changes.
        penalty: How many times softer it is at present.

    Args:
        site: Where it acts.
    """

    sticks: ClassVar[bool] = False
    has_counterpart: ClassVar[bool] = True
    pressure_is_known: ClassVar[bool] = False
    pushes_only: ClassVar[bool] = False
    has_penalty: ClassVar[bool] = False
    names_of_power: ClassVar[tuple[str, ...]] = ()

    def __init__(self, site: LawSite) -> None:
        super().__init__(site)
        self.penalty = Penalty(site, self.has_penalty)

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """Parameters that the scene gives, by its names, for results."""
        return {}

    @classmethod
    def penalty_parameter(cls, site: LawSite) -> float:
        """ε₁ as used (length/stress), 0 without a penalty."""
        return 0.0

    @property
    def is_pointwise(self) -> bool:
        """Whether its numbers at the points are made along with its forms.

        Those of a law that has other forms than the one it derives from need not be its own.
        """
        return all(defined_in_same_class(self, one, other) for one, other in _TOGETHER)

    @property
    def has_vjp(self) -> bool:
        """Whether ``vjp`` is of its own numbers, and nothing else is kept between steps."""
        own = defined_in_same_class(self, "vjp", "at_points") and self.is_pointwise
        return super().has_vjp and (own or not self.follows_jump)

    @property
    def exerts_shear(self) -> bool:
        """Whether it exerts a traction along the surface as well."""
        return False

    @property
    def is_load(self) -> bool:
        """Whether it has ``loads``, without the cost of making their forms."""
        return bool(self.loads)

    @property
    def loads(self) -> list[GivenLoad]:
        """Linear forms of what is given, in full, with the share that acts at a pseudo-time."""
        return []

    @property
    def loads_at_points(self) -> list[tuple[Array, Callable[[float], float]]]:
        """Tractions that are given, at the points, with the share that acts at a pseudo-time."""
        return []

    def pressure_ufl(self, jump: Expr) -> Expr:
        """The part of the pressure that follows the jump, in UFL (stress)."""
        return ufl.as_ufl(0.0)

    def pressure_slope(self, jump: Array) -> Array:
        """Derivative of ``pressure_ufl`` in the jump, (points, components) (stress/length)."""
        return np.zeros_like(jump)

    @property
    def power_of_depth(self) -> tuple[Array, Array]:
        """C and m at the points of a law p = c ⟨d⟩^m of the depth d (stress/length^m, none)."""
        raise NotImplementedError(f"{self.kind} contact is no power of a depth")

    def set_time(self, time: float) -> None:
        """Bring what is given to a pseudo-time."""

    def set_gap(self, gap: Array) -> None:
        """Follow what stands opposite.

        Args:
            gap: At the points; infinite where nothing stands (length).
        """

    def depth(self, jump: Array) -> Array:
        """How deep the points are at a jump, −∞ where nothing stands (length)."""
        return self.site.kinematics.normal(jump) - self.site.kinematics.gap

    def pressure(self, jump: Array) -> Array:
        """Contact pressure at the points at a jump, > 0 in compression (stress)."""
        return np.zeros(len(jump))

    def stiffness(self, depth: Array) -> Array:
        """Derivative of the pressure in the depth, at a depth of the points (stress/length)."""
        return np.zeros(len(depth))

    def traction(self, jump: Array) -> Array:
        """Traction along the surface on the body at a jump, (points, components) (stress)."""
        return np.zeros_like(jump)

    def stored(self, jump: Array) -> Array:
        """Energy at the points at a jump (energy/area)."""
        return np.zeros(len(jump))

    def vjp(self, jump: Array, of_slopes: Array, of_energy: Array) -> NormalGradient:
        """Vector-Jacobian product: gradient of a quantity in jump, gap and parameters.

        Args:
            jump: At the points, (points, components) (length).
            of_slopes: Gradient of the quantity in minus the traction on the body, likewise.
            of_energy: In the energy at the points, (points,).
        """
        return NormalGradient(np.zeros_like(jump), np.zeros(len(jump)), {})

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the parameters at the points in a key of the contact; none of others.

        Args:
            key: Such as ``foundation_stiffness``.
            unit: Derivative of what the scene gives under it, itself a value of a scene.

        Returns:
            Name of the parameter → (points,).
        """
        return {}

    def can_press(self) -> Flags:
        """Points at which it presses once they come deep enough."""
        return np.zeros(len(self.site.trace.weights), dtype=bool)

    def acts(self, pressure: Array) -> Flags:
        """Points whose forces depend on the jump, at a pressure of its own (stress)."""
        return np.zeros(len(pressure), dtype=bool)

    def is_closed(self, pressure: Array) -> Flags:
        """Points in contact at a pressure of its own (stress)."""
        return pressure > 0

    def touches_at_rest(self) -> Flags:
        """Points in contact before there are any loads."""
        return self.site.kinematics.gap <= 1e-12 * self.site.trace.extent()


class Penalty:
    """How many times softer the springs of a law are than their own penalty makes them.

    Solvers take softer ones on the way to an answer, and stiffer ones tell its error. A law without
    a penalty has springs that are meant, which stay as they are.

    Attributes:
        exists: Whether the law's stiffness is a penalty.
        softness: By which factor its stiffness is divided at present.

    Args:
        site: Where the law acts.
        exists: Whether the law's stiffness is a penalty.
    """

    def __init__(self, site: LawSite, exists: bool) -> None:
        self.exists, self.softness = exists, 1.0
        self._mesh = site.trace.surface.mesh

    @cached_property
    def softness_in_ufl(self) -> fem.Constant:
        """``softness`` for forms, made when a form or a softer penalty needs it first."""
        return fem.Constant(self._mesh, float(self.softness))

    def soften(self, factor: float) -> None:
        """Divide the stiffness by a factor, from now on, if it is a penalty.

        Args:
            factor: Over the law's own stiffness; 1 is that itself.
        """
        if self.exists:
            self.softness = self.softness_in_ufl.value = factor
