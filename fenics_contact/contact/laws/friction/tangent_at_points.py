"""Friction's tangents as numbers at the points, from the UFL that their forms are made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.energies import coulomb_residual, primal_dual_residual
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
        length: max(|u_T|, ε) (length).
    """

    jump: Array
    normal: Array
    bound: Array
    epsilon: float
    direction: Array
    length: Array

    @property
    def springs(self) -> Array:
        """Minus the traction that the form is of, (points, components) (stress)."""
        return self._density.slope("test", **self._values)

    @property
    def tangent(self) -> Array:
        """Its derivative in the jump, (points, components, components) (stress/length)."""
        return self._density.curvatures("test", "jump", **self._values)

    def coupling(self, slope: Array) -> Array:
        """What a bound that follows the jump adds, likewise.

        Args:
            slope: Its derivative in the jump, (points, components) (stress/length).
        """
        return self.along * slope[:, None, :]

    @property
    def along(self) -> Array:
        """Minus the traction for a unit of the bound, (points, components, 1)."""
        size = self.jump.shape[1]
        names = ("test", "normal", "direction")
        points = point_density(_coulomb, **dict.fromkeys(names, size), bound=0)
        return points.curvatures(
            "test", "bound", **{name: self._values[name] for name in (*names, "bound")}
        )

    @property
    def _density(self) -> PointDensity:
        vectors = dict.fromkeys(("jump", "test", "normal", "direction"), self.jump.shape[1])
        return point_density(_primal_dual, **vectors, bound=0, epsilon=0, length=0)

    @property
    def _values(self) -> dict[str, Array | float]:
        return {**vars(self), "test": np.zeros_like(self.jump)}


def _primal_dual(
    jump: Expr,
    test: Expr,
    normal: Expr,
    direction: Expr,
    bound: Expr,
    epsilon: Expr,
    length: Expr,
) -> Expr:
    """``primal_dual_residual`` at a point in UFL, over its area."""
    return primal_dual_residual(jump, test, normal, bound, epsilon, direction, length, 1.0, 1)


def _coulomb(test: Expr, normal: Expr, direction: Expr, bound: Expr) -> Expr:
    """``coulomb_residual`` at a point in UFL, over its area."""
    return coulomb_residual(test, normal, bound, direction, 1.0, 1)
