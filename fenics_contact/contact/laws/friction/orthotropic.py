"""Friction that differs along two axes of the surface: rolled, ground or lined surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.analytic.complex_step import slope
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest
from fenics_contact.contact.laws.friction.metric import OwnMetric
from fenics_contact.contact.laws.friction.rule import FrictionRule
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.laws.friction_laws import OrthotropicFriction
from fenics_contact.scene.values import AXES, Value

# Sine of the least angle between the direction and the normal: nearer, its part along the surface
# is that of round-off in the normals.
_LEAST_ALONG = 1e-6
# Sine of an angle to the mirror image that is round-off.
_ASKEW = 1e-6


class EllipticMetric(OwnMetric):
    """M = diag(μ₁, μ₂)/max(μ₁, μ₂) along the axes: 1 where both are the same."""

    @staticmethod
    def scaled(vector: Expr, **fields: Expr) -> Expr:
        """M s = m₂ s + (m₁ − m₂)(e·s) e."""
        along, across, axis = fields["along"], fields["across"], fields["axis"]
        larger = _larger(along, across)
        part = ufl.dot(axis, vector)
        return (across * vector + (along - across) * part * axis) / larger


class Orthotropic(FrictionRule):
    """The ellipse (t₁/(μ₁p))² + (t₂/(μ₂p))² ≤ 1, sliding by the rule associated to it.

    A slip along v is opposed by p (μ₁² v₁, μ₂² v₂)/√(μ₁² v₁² + μ₂² v₂²), which dissipates
    p √(μ₁² v₁² + μ₂² v₂²): the most that a traction of the ellipse can (J. J. Moreau, C. R. Acad.
    Sci. Paris A 271 (1970) 608-611; R. Michałowski, Z. Mróz, Archives of Mechanics 30 (1978)
    259-276). The bound g is that along the rougher axis; the other is in ``metric``.
    """

    kind: ClassVar[str] = "orthotropic"

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        self._along, self._across = (
            site.given(value, f"friction_law.{name}", may_vanish=False)
            for name, value in (("along", self._table.along), ("across", self._table.across))
        )
        self.coefficient = np.maximum(self._along, self._across)
        axes = self._axes(f"{site.key}.friction_law.direction")
        self.metric = EllipticMetric({**self.fields, "axis": axes}, axes)

    def _axes(self, key: str) -> Array:
        """Unit vectors of the direction along the surface at the points; collective."""
        trace, given = self.site.trace, np.array(self._table.direction)
        along = self._along_surface(given)
        sizes = np.linalg.norm(along, axis=1)
        said = f"{key} = {list(self._table.direction)}"
        if smallest(trace.spaces.comm, sizes) < _LEAST_ALONG:
            raise InputError(
                f"{said} is along the normal of the surface at a point, so that it gives no axis "
                "there; give another direction, or a contact of its own for that part of the "
                "surface"
            )
        axes = np.asarray(along / sizes[:, None])
        for plane in trace.symmetry.axes:
            mirrored = self._along_surface(np.where(np.arange(3) == plane, -given, given))
            askew = np.linalg.norm(np.cross(mirrored / sizes[:, None], axes), axis=1)
            if largest(trace.spaces.comm, askew) > _ASKEW:
                raise InputError(
                    f"{said}: friction along and across it is not the same behind the plane of "
                    f"symmetry across {AXES[plane]}; give a direction along or across that plane, "
                    "or model the whole body"
                )
        return axes

    def _along_surface(self, vector: Array) -> Array:
        """The part along the surface of a vector's direction, (points, components)."""
        unit = np.broadcast_to(vector / np.linalg.norm(vector), self._shape)
        return self.site.kinematics.tangential(unit)

    @cached_property
    def fields(self) -> Mapping[str, Array]:
        """μ₁ and μ₂ at the points."""
        return {"along": self._along, "across": self._across}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of both coefficients, and of the axis along the surface."""
        name, *axis = key.removeprefix("friction_law.").split(".")
        if name == "direction":
            return {"axis": self._axis_slopes(int(axis[0]))}
        return {name: self.site.given(unit, key)} if name in self.fields else {}

    def _axis_slopes(self, axis: int) -> Array:
        """Slopes of the unit vectors in a component of the direction, by a complex step."""
        given = np.array(self._table.direction, dtype=complex)

        def unit_vectors(value: complex) -> Array:
            given[axis] = value
            along = self.site.kinematics.tangential(np.broadcast_to(given, self._shape))
            return np.asarray(along / np.sqrt((along**2).sum(axis=1))[:, None])

        return slope(unit_vectors, self._table.direction[axis])

    @property
    def is_linear(self) -> bool:
        """Each coefficient times the pressure is."""
        return True

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """max(μ₁, μ₂) p."""
        return _larger(fields["along"], fields["across"]) * pressure

    @property
    def largest_coefficient(self) -> Array:
        """Larger coefficient, max(μ₁, μ₂)."""
        return self.coefficient

    @property
    def _shape(self) -> tuple[int, int]:
        """Shape of vectors at the points."""
        points, components = self.site.trace.normals.shape
        return points, components

    @property
    def _table(self) -> OrthotropicFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, OrthotropicFriction)
        return law


def _larger(along: Expr, across: Expr) -> Expr:
    return ufl.max_value(along, across)
