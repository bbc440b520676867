"""Friction's tangents as numbers at the points, from the UFL that their forms are made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.energies import coulomb_residual, primal_dual_residual
from fenics_contact.contact.laws.friction.rules.metric import SlipMetric
from fenics_contact.contact.laws.point_values import PointDensity, point_density


@dataclass(frozen=True)
class PrimalDual:
    """The primal-dual tangent at the points in one state.

    Attributes:
        jump: That counts, (points, components) (length).
        normal: Unit normals, likewise.
        bound: g (stress).
        epsilon: ε (length).
        direction: q, (points, components).
        length: max(|u_T|, ε), as friction feels it (length).
        metric: How friction feels slip.
    """

    jump: Array
    normal: Array
    bound: Array
    epsilon: float
    direction: Array
    length: Array
    metric: SlipMetric

    @property
    def springs(self) -> Array:
        """Minus the traction that the form is of, (points, components) (stress)."""
        return self._density.slope("test", **self._values)

    @property
    def tangent(self) -> Array:
        """Its derivative in the jump, (points, components, components) (stress/length)."""
        return self._density.curvatures("test", "jump", **self._values)

    def coupling(self, slope: Array) -> Array:
        """Tangent by a bound that follows the jump, (points, components, components).

        Args:
            slope: Its derivative in the jump, (points, components) (stress/length).
        """
        return self.along * slope[:, None, :]

    @property
    def along(self) -> Array:
        """Minus the traction for a unit of the bound, (points, components, 1)."""
        size, metric = self.jump.shape[1], self.metric
        names = ("test", "normal", "direction")
        sizes = dict.fromkeys(names, size) | metric.sizes
        points = point_density(_coulomb(metric.scaled), **sizes, bound=0)
        values = {name: self._values[name] for name in (*sizes, "bound")}
        return points.curvatures("test", "bound", **values)

    @property
    def _density(self) -> PointDensity:
        vectors = dict.fromkeys(("jump", "test", "normal", "direction"), self.jump.shape[1])
        sizes = vectors | self.metric.sizes
        return point_density(
            _primal_dual(self.metric.scaled), **sizes, bound=0, epsilon=0, length=0
        )

    @property
    def _values(self) -> dict[str, Array | float]:
        own = {name: value for name, value in vars(self).items() if name != "metric"}
        return {**own, "test": np.zeros_like(self.jump), **self.metric.fields}


@lru_cache
def _primal_dual(scaled: Callable[..., Expr]) -> Callable[..., Expr]:
    """``primal_dual_residual`` at a point in UFL, over its area."""

    def density(
        jump: Expr,
        test: Expr,
        normal: Expr,
        direction: Expr,
        bound: Expr,
        epsilon: Expr,
        length: Expr,
        **fields: Expr,
    ) -> Expr:
        return primal_dual_residual(
            *(jump, test, normal, bound, epsilon, direction, length, 1.0, 1),
            lambda vector: scaled(vector, **fields),
        )

    return density


@lru_cache
def _coulomb(scaled: Callable[..., Expr]) -> Callable[..., Expr]:
    """``coulomb_residual`` at a point in UFL, over its area."""

    def density(test: Expr, normal: Expr, direction: Expr, bound: Expr, **fields: Expr) -> Expr:
        return coulomb_residual(
            *(test, normal, bound, direction, 1.0, 1), lambda vector: scaled(vector, **fields)
        )

    return density
