"""Derivatives of an answer: by adjoints, and in a direction.

Small changes leave the statuses of points as they are, except at points just at an edge: between
open and closed, or between sticking and slipping. With such points the derivative in one direction
differs from that in the opposite one. ``toward`` says which direction is meant; without it, the
statuses are those of the answer.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.solve.exact.active_system import friction_rows, linearised
from fenics_contact.solve.exact.answer import ExactAnswer
from fenics_contact.solve.exact.natural_map import PointState
from fenics_contact.solve.exact.singular import added_compliance

# Of the largest force: nearer, a point is at the edge between two statuses.
_EDGE = 1e-9
# Statuses of points at an edge are repeated until they agree with the direction, at most so often.
_MOST_ROUNDS = 30
# Of the refinement where W is singular.
_ROUNDS_OF_SINGULAR = 8


@dataclass(frozen=True, eq=False)
class ExactGradient:
    """Gradient of a quantity in what a local problem is given.

    Attributes:
        free: In q, (rows,). That in W_ij is ``free[i] * forces[j]``.
        bound: In a number added to the bound of friction at each point, (points,).
        given_force: In the forces across that are given, (points,); 0 at other points.
        elastic_slip: In ε at each point, (points,).
    """

    free: Array
    bound: Array
    given_force: Array
    elastic_slip: Array


def points_at_edges(answer: ExactAnswer) -> Flags:
    """Points that are just between two statuses, (points,).

    Their derivatives differ between a change and the opposite one.
    """
    equations, state = answer.equations, answer.state
    near = _EDGE * equations.scale(state)
    opens = equations.unilateral & (np.abs(state.across) <= near)
    limit = state.bound + equations.elastic
    slips = state.closed & equations.rubs & (np.abs(state.length - limit) <= near)
    return opens | slips


class Linearisation:
    """The equations of an answer's points, linearised with their statuses.

    Attributes:
        at_edges: Number of points just at an edge.

    Args:
        answer: Converged.
        toward: Change of q, (rows,) (length), by which points at an edge have their status: that of
            answers on that side. Without it their statuses are those of the answer.

    Raises:
        ValueError: The linearised equations are singular: the answer ends there.
    """

    def __init__(self, answer: ExactAnswer, toward: Array | None = None) -> None:
        self._answer, self._equations = answer, answer.equations
        self._edges = points_at_edges(answer)
        self.at_edges = int(np.count_nonzero(self._edges))
        self._take(answer.state)
        if toward is not None and self.at_edges:
            self._decide(answer.problem.scaling.transposed(toward))

    def along(self, change: Array) -> Array:
        """Derivative of the forces in a direction, (rows,) (force).

        Args:
            change: Of q, (rows,) (length).
        """
        scaling = self._answer.problem.scaling
        return scaling.forces(self._forces(scaling.transposed(change)))

    def gradient(self, of_forces: Array, of_gaps: Array | None = None) -> ExactGradient:
        """Gradient of a quantity in what the problem is given, by one transposed solve.

        Args:
            of_forces: Derivative of the quantity in the forces r, (rows,).
            of_gaps: In the gaps v that are left, (rows,); none if None.
        """
        problem, equations = self._answer.problem, self._equations
        scaling, state, friction = problem.scaling, self._state, self._system.friction
        direct = np.zeros_like(of_forces) if of_gaps is None else of_gaps
        of_scaled = scaling.transposed(of_forces + problem.compliance.T @ direct)
        multiplier = np.zeros(len(of_forces))
        multiplier[self._system.rows] = self._solve(of_scaled[self._system.rows], True)
        # A change of q̂ changes the right-hand side by −1 times itself, in rows of friction by −D.
        of_free = -multiplier
        rows = self._friction_rows
        at_points = multiplier[rows]
        of_free[rows] = -np.einsum("kij,ki->kj", friction.turning, at_points)
        in_bound = np.zeros(equations.points)
        in_elastic = np.zeros(equations.points)
        numbers = friction.points
        slips = ~state.sticks[numbers]
        pulled = np.einsum("ki,ki->k", at_points, state.along[numbers])
        limit = state.bound[numbers] + equations.elastic[numbers]
        over = np.where(
            slips, state.length[numbers], limit**2 / np.maximum(equations.elastic[numbers], 1e-300)
        )
        in_bound[numbers] = pulled / over
        in_elastic[numbers] = np.where(slips, 0.0, -state.bound[numbers] * pulled / limit**2)
        in_elastic += self._of_first_elastic_slip(of_free)
        size = scaling.of_points
        across = equations.compliance[:, : equations.count : equations.dimension]
        given = across.T @ of_free + of_scaled[: equations.count : equations.dimension]
        given = np.where(equations.given, (given + state.slope * in_bound) / size, 0.0)
        return ExactGradient(
            free=direct + scaling.forces(of_free),
            bound=in_bound / size,
            given_force=given,
            elastic_slip=in_elastic * size,
        )

    def _of_first_elastic_slip(self, of_free: Array) -> Array:
        """Gradient in ε of points that stick at ε = 0, where v_t = −ε r_t/g; scaled, (points,)."""
        equations, state = self._equations, self._state
        acts = state.closed & state.sticks & (equations.elastic == 0) & (state.bound > 0)
        shape = equations.points, equations.dimension
        of_slip = of_free[: equations.count].reshape(shape)[:, 1:]
        work = np.einsum("ij,ij->i", of_slip, state.along)
        return np.where(acts, work / np.where(acts, state.bound, 1.0), 0.0)

    def _take(self, state: PointState) -> None:
        """Linearise at statuses."""
        equations = self._equations
        self._is_singular = self._answer.problem.scaling.is_singular
        if self._is_singular:
            added = added_compliance(equations)
            self._added = added
            equations = equations.with_compliance(
                equations.compliance + np.diag(added), equations.free
            )
        found = linearised(equations, state.closed, friction_rows(equations, state))
        if found is None:
            raise ValueError("the linearised equations of the contact points are singular")
        self._state, self._system = state, found

    @property
    def _friction_rows(self) -> Integers:
        first = self._system.friction.points * self._equations.dimension
        return first[:, None] + np.arange(1, self._equations.dimension)

    def _forces(self, change: Array) -> Array:
        """Derivative of the scaled forces in a change of q̂."""
        system, right = self._system, -change
        rows = self._friction_rows
        right[rows] = -np.einsum("kij,kj->ki", system.friction.turning, change[rows])
        found = np.zeros_like(change)
        found[system.rows] = self._solve(right[system.rows], False)
        return found

    def _solve(self, right: Array, transposed: bool) -> Array:
        """Solve for the active rows; where W is singular, without the compliance that was added."""
        system = self._system
        found = system.solve(right, transposed)
        if self._is_singular:
            for _ in range(_ROUNDS_OF_SINGULAR):
                found = system.solve(right + self._by_added(found, transposed), transposed)
        return found

    def _by_added(self, values: Array, transposed: bool) -> Array:
        """The part of the matrix that comes from the added compliance, times values."""
        whole = np.zeros(len(self._added))
        whole[self._system.rows] = values
        rows = self._friction_rows
        way = "kji,kj->ki" if transposed else "kij,kj->ki"
        whole[rows] = np.einsum(way, self._system.friction.turning, whole[rows])
        return np.asarray((self._added * whole)[self._system.rows])

    def _decide(self, change: Array) -> None:
        """Give points at edges the statuses that they have after a small change of q̂."""
        for _ in range(_MOST_ROUNDS):
            before, forces = self._state, self._forces(change)
            trial = forces - self._equations.compliance @ forces - change
            chosen = self._after(trial[: self._equations.count])
            same = (chosen.closed == before.closed) & (chosen.sticks == before.sticks)
            if same.all():
                return
            self._take(chosen)

    def _after(self, change: Array) -> PointState:
        """The answer's state with statuses after a small change of z."""
        equations, state = self._equations, self._answer.state
        moved = change.reshape(equations.points, equations.dimension)
        near = _EDGE * equations.scale(state)
        opens = self._edges & equations.unilateral & (np.abs(state.across) <= near)
        closed = np.where(opens, moved[:, 0] > 0, state.closed)
        direction = state.along / np.where(state.length > 0, state.length, 1.0)[:, None]
        longer = np.einsum("ij,ij->i", direction, moved[:, 1:])
        longer = np.where(state.length > near, longer, np.linalg.norm(moved[:, 1:], axis=1))
        sticks = np.where(self._edges, longer <= state.slope * moved[:, 0], state.sticks)
        # A point that touches with a force and is at an edge all the same is at that of slip; one
        # without a force, which slips by more than nothing, goes on slipping.
        sticks &= closed & equations.rubs & (state.length <= state.bound + equations.elastic + near)
        return replace(state, closed=closed, sticks=sticks)
