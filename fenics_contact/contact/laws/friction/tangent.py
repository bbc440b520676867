"""Tangents of friction at the points: the state they are taken at, and their numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.energies import coulomb_residual, primal_dual_residual
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.friction.metric import SlipMetric
from fenics_contact.contact.laws.point_values import PointDensity, point_density

# Of g / |u_T|: what tangents keep along the slip. A body of which all points slip, under loads just
# below those that friction can hold, would be moved so far by a Newton step that rounding ends it.
_LEFT_STIFF = 1e-10


class TangentState:
    """Slip u_T as friction feels it and direction q, |q| ≤ 1, at the points; forms follow.

    T. F. Chan, G. H. Golub, P. Mulet, SIAM J. Sci. Comput. 20 (1999) 1964-1977.

    Attributes:
        slip: The scaled one, (points, components) (length).
        direction: (1 − a trace) q, what forms have in place of q.
        length: max(|u_T|, ε), what forms divide by (length).

    Args:
        law: The friction law, which says how slip is felt, and ε.
    """

    def __init__(self, law: FrictionLaw) -> None:
        trace = law.site.trace
        self._law = law
        self.slip = np.zeros_like(trace.normals)
        self._dual = np.zeros_like(self.slip)
        self._left_stiff = _LEFT_STIFF
        self.direction = trace.function(self._dual)
        # Not 0 anywhere: it divides, also where the weight is 0.
        self.length = trace.function(np.ones(len(trace.weights)), empty=1.0)
        self.stick_all()

    @property
    def slip_and_direction(self) -> tuple[Array, Array]:
        """Slip and direction of the tangent, to be taken again; (points, components) each."""
        return self.slip, self._dual

    @property
    def direction_at_points(self) -> Array:
        """Values of ``direction`` at the points, (points, components)."""
        return (1 - self._left_stiff) * self._dual

    @property
    def length_at_points(self) -> Array:
        """max(|u_T|, ε) at the points (length)."""
        return np.maximum(lengths(self.slip), self._law.regularisation.parameter)

    def take(self, state: tuple[Array, Array]) -> None:
        """Be at a slip and a direction.

        Args:
            state: As ``slip_and_direction`` gives them.
        """
        self.slip, self._dual = state
        self.direction.set(self.direction_at_points)
        self.length.set(self.length_at_points)

    def stick_all(self) -> None:
        """Be at the adhesive start: u_T = 0 and no friction yet."""
        nothing = np.zeros_like(self.slip)
        self.take((nothing, nothing))

    def slip_all(self, slip: Array) -> None:
        """Be where all points have slipped.

        Args:
            slip: The effective one, nowhere 0, (points, components) (length).
        """
        scaled = self._law.rule.metric.at(slip)
        self.take((scaled, scaled / np.linalg.norm(scaled, axis=1)[:, None]))

    def follow(self, slip: Array) -> None:
        """Move to a new slip: q by its own linearised equation, |q| ≤ 1.

        Args:
            slip: Since the start, (points, components) (length).
        """
        scaled = self._law.scaled_slip(slip)
        size, directions = self._lengths_and_directions()
        lengthening = np.einsum("ij,ij->i", directions, scaled - self.slip)
        dual = (scaled - self._dual * lengthening[:, None]) / size[:, None]
        self.take((scaled, dual / np.maximum(lengths(dual), 1.0)[:, None]))

    def take_true(self, slip: Array) -> None:
        """Be at the law's own derivative, from now on with nothing left stiff.

        Args:
            slip: As of ``follow``.
        """
        self._left_stiff = 0.0
        scaled = self._law.scaled_slip(slip)
        size = np.maximum(lengths(scaled), self._law.regularisation.parameter)
        self.take((scaled, scaled / size[:, None]))

    def _lengths_and_directions(self) -> tuple[Array, Array]:
        """max(|u_T|, ε) and its gradient, u_T/|u_T| where slipping and 0 where sticking."""
        size, epsilon = lengths(self.slip), self._law.regularisation.parameter
        slips = size > epsilon
        directions = np.where(slips[:, None], self.slip / np.where(slips, size, 1.0)[:, None], 0.0)
        return np.maximum(size, epsilon), directions


def lengths(vectors: Array) -> Array:
    """Lengths of vectors, (points,); numpy's norm takes several times as long for them."""
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))


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
        """Derivative of the traction in the jump, (points, components, components)."""
        return self._density.curvatures("test", "jump", **self._values)

    def coupling(self, slope: Array) -> Array:
        """Tangent by a bound that follows the jump, (points, components, components).

        Args:
            slope: Derivative of the traction in the jump, (points, components) (stress/length).
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
