"""The state that the primal-dual tangent of friction is at: a slip, and a direction of its own."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.surface.trace import Trace

# Of g / |u_T|: what tangents keep along the slip. A body of which all points slip, under loads just
# below those that friction can hold, would be moved so far by a Newton step that rounding ends it.
_LEFT_STIFF = 1e-10


class TangentState:
    """Slip u_T as friction feels it and direction q, |q| ≤ 1, at the points; forms follow.

    T. F. Chan, G. H. Golub, P. Mulet, SIAM J. Sci. Comput. 20 (1999) 1964-1977.

    Attributes:
        slip: As the law counts and feels it, (points, components) (length).
        direction: (1 − a trace) q, what forms have in place of q.
        length: max(|u_T|, ε), what forms divide by (length).

    Args:
        trace: The contact points.
    """

    def __init__(self, trace: Trace) -> None:
        self.slip = np.zeros_like(trace.normals)
        self._dual = np.zeros_like(self.slip)
        self._left_stiff = _LEFT_STIFF
        self.direction = trace.function(self._dual)
        # Not 0 anywhere: it divides, also where the weight is 0.
        self.length = trace.function(np.ones(len(trace.weights)), empty=1.0)

    @property
    def slip_and_direction(self) -> tuple[Array, Array]:
        """Both, to take again; (points, components) each."""
        return self.slip, self._dual

    @property
    def direction_at_points(self) -> Array:
        """What ``direction`` is at the points, (points, components)."""
        return (1 - self._left_stiff) * self._dual

    def length_at_points(self, epsilon: float) -> Array:
        """max(|u_T|, ε) at the points (length)."""
        return np.maximum(lengths(self.slip), epsilon)

    def take(self, state: tuple[Array, Array], epsilon: float) -> None:
        """Be at a slip and a direction.

        Args:
            state: Both, (points, components) each.
            epsilon: ε (length).
        """
        self.slip, self._dual = state
        self.direction.set(self.direction_at_points)
        self.length.set(self.length_at_points(epsilon))

    def follow(self, slip: Array, epsilon: float) -> None:
        """Move to a new slip: q by its own linearised equation, |q| ≤ 1.

        Args:
            slip: As the law counts and feels it, (points, components) (length).
            epsilon: ε (length).
        """
        size, directions = self._lengths_and_directions(epsilon)
        lengthening = np.einsum("ij,ij->i", directions, slip - self.slip)
        dual = (slip - self._dual * lengthening[:, None]) / size[:, None]
        self.take((slip, dual / np.maximum(lengths(dual), 1.0)[:, None]), epsilon)

    def take_true(self, slip: Array, epsilon: float) -> None:
        """Be at a slip with its own direction, from now on with nothing left stiff.

        Args:
            slip: As of ``follow``.
            epsilon: ε (length).
        """
        self._left_stiff = 0.0
        size = np.maximum(lengths(slip), epsilon)
        self.take((slip, slip / size[:, None]), epsilon)

    def _lengths_and_directions(self, epsilon: float) -> tuple[Array, Array]:
        """max(|u_T|, ε) and its gradient, u_T/|u_T| where slipping and 0 where sticking."""
        size = lengths(self.slip)
        slips = size > epsilon
        directions = np.where(slips[:, None], self.slip / np.where(slips, size, 1.0)[:, None], 0.0)
        return np.maximum(size, epsilon), directions


def lengths(vectors: Array) -> Array:
    """Of vectors, (points, components): what numpy's norm takes several times as long for."""
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))
