"""The laws of the points as one equation each, r = Π(r − v), and their statuses.

P. Alart and A. Curnier, A mixed formulation for frictional contact problems prone to Newton like
solution methods, Computer Methods in Applied Mechanics and Engineering 92 (1991) 353-375. In the
units of ``scaling`` the factor before v is 1. With z = r − v,

    r_n = max(z_n, 0),    r_t = g z_t / max(|z_t|, g + ε),

where ε is the slip up to which friction is elastic, mostly 0. Points stick where |z_t| ≤ g + ε.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.solve.exact.local_problem import LocalProblem


@dataclass(frozen=True, eq=False)
class PointState:
    """State of the points under given forces: gaps, statuses, violation of the laws; scaled units.

    Attributes:
        forces: r, (rows,).
        gaps: v, (rows,).
        across: z_n, (points,).
        along: z_t, (points, along).
        length: |z_t|, (points,).
        force: max(z_n, 0), or the force that is given, (points,).
        bound: g, (points,).
        slope: Its derivative in the force, (points,).
        closed: Points in contact.
        sticks: Those with friction that do not slip.
        residual: r − Π(r − v), (rows,); v in rows of scalars.
    """

    forces: Array
    gaps: Array
    across: Array
    along: Array
    length: Array
    force: Array
    bound: Array
    slope: Array
    closed: Flags
    sticks: Flags
    residual: Array

    @property
    def error(self) -> float:
        """Largest entry of the residual."""
        return float(np.abs(self.residual).max())


class NaturalMap:
    """The equations of a problem, in scaled units.

    Forces that are given act in ``free``, and are 0 in the arrays of forces.

    Attributes:
        compliance: Ŵ, (rows, rows).
        free: q̂, with what given forces add, (rows,).
        points: Number of points.
        dimension: Rows of a point.
        count: Number of rows of points.
        active: Rows whose force is unknown where the point touches, (points, dimension).
        elastic: ε, (points,).
        has_elastic_slip: Whether any ε is larger than 0.
        unilateral: Points that may open, (points,).
        rubs: Points with a bound of friction, (points,).
        bonded: Points that do not slip while they touch, (points,).
        given: Points whose force across is given, (points,).
        given_force: That force, 0 elsewhere, (points,).

    Args:
        problem: As it is given.
    """

    def __init__(self, problem: LocalProblem) -> None:
        self.problem, scaling, laws = problem, problem.scaling, problem.laws
        self._laws, self._size, self._factor = laws, scaling.of_points, 1.0
        self.points, self.dimension = scaling.points, scaling.dimension
        self.count = self.points * self.dimension
        self.compliance = scaling.compliance
        self.free = scaling.transposed(problem.free)
        self.unilateral, self.rubs, self.bonded = laws.unilateral, laws.rubs, laws.bonded_along
        self.given_force = laws.forces / self._size
        self.given = laws.given
        self._largest_given = np.abs(self.given_force).max()
        if laws.given.any():
            across = self.compliance[:, : self.count : self.dimension]
            self.free = self.free + across @ self.given_force
        self.elastic = laws.elastic * self._size
        self.has_elastic_slip = bool(self.elastic.any())
        self.active = np.empty((self.points, self.dimension), dtype=bool)
        self.active[:, 0] = ~laws.given
        self.active[:, 1:] = (self.rubs | self.bonded)[:, None]
        self._is_plain = bool(self.unilateral.all() and self.rubs.all())

    def scale(self, state: PointState) -> float:
        """Largest force at the points, those that are given among them; in scaled units."""
        return float(max(np.abs(state.forces[: self.count]).max(), self._largest_given))

    def whole(self, forces: Array) -> Array:
        """Forces with those that are given, (rows,), in scaled units."""
        found = forces.copy()
        found[: self.count : self.dimension] += self.given_force
        return found

    def with_compliance(self, compliance: Array, free: Array) -> NaturalMap:
        """Return the same laws with another Ŵ and q̂, for a problem that is solved on the way.

        Args:
            compliance: Ŵ, (rows, rows).
            free: q̂ with what given forces add, (rows,).
        """
        found = copy(self)
        found.compliance, found.free = compliance, free
        return found

    def bounds(self, force: Array) -> tuple[Array, Array]:
        """Bounds of friction and their slopes at forces ≥ 0, (points,) each, in scaled units."""
        bound, slope = self._laws.bounds(force * self._size)
        return self._factor * bound / self._size, self._factor * slope

    def with_bounds_times(self, factor: float) -> NaturalMap:
        """Return the same equations with other bounds of friction, on the way to an answer.

        Args:
            factor: By which the bounds are multiplied.
        """
        found = copy(self)
        found._factor = factor
        return found

    def at(self, forces: Array) -> PointState:
        """State of the points under given forces.

        Args:
            forces: r̂ without those that are given, (rows,).
        """
        gaps = self.compliance @ forces + self.free
        shape = (self.points, self.dimension)
        rows, left = forces[: self.count].reshape(shape), gaps[: self.count].reshape(shape)
        trial = rows - left
        across, along = trial[:, 0], trial[:, 1:]
        length = np.sqrt(np.einsum("ij,ij->i", along, along))
        closed = ~self.unilateral | (across > 0)
        force = np.maximum(across, 0.0)
        if not self._is_plain:
            force = np.where(self.unilateral, force, np.maximum(rows[:, 0] + self.given_force, 0))
        bound, slope = self.bounds(force)
        bound = np.where(closed, bound, 0.0)
        limit = bound + self.elastic
        sticks = closed & self.rubs & (length <= limit)
        share = bound / np.maximum(np.maximum(length, limit), 1e-300)
        residual = gaps.copy()
        found = residual[: self.count].reshape(shape)
        found[:, 0] = rows[:, 0] - force
        found[:, 1:] = rows[:, 1:] - share[:, None] * along
        if not self._is_plain:
            self._other_laws(found, rows, left, closed)
        return PointState(
            *(forces, gaps, across, along, length, force, bound, slope, closed, sticks, residual)
        )

    def _other_laws(self, found: Array, rows: Array, left: Array, closed: Flags) -> None:
        """Residuals of points that are bonded, do not rub, or whose force is given."""
        found[:, 0] = np.where(self.unilateral, found[:, 0], np.where(self.given, 0.0, left[:, 0]))
        bonded = (closed & self.bonded)[:, None]
        other = np.where(bonded, left[:, 1:], rows[:, 1:])
        found[:, 1:] = np.where(self.rubs[:, None], found[:, 1:], other)
