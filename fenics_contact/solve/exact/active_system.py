"""The equations of the points in contact, linearised: one dense matrix for each Newton step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dgecon, dgetrf, dgetrs

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.solve.exact.natural_map import NaturalMap, PointState

# Reciprocal condition number below which a matrix counts as singular.
SINGULAR = 1e-13


@dataclass(frozen=True, eq=False)
class FrictionRows:
    """Linearised friction at some points: (1 − D) r_t + D (Ŵ r + q̂)_t − c r_n = e.

    Attributes:
        points: Their numbers, (k,).
        turning: D, (k, along, along).
        by_force: c, (k, along).
        right: e, (k, along).
    """

    points: Integers
    turning: Array
    by_force: Array
    right: Array


@dataclass(frozen=True, eq=False)
class ActiveSystem:
    """Matrix of the rows in contact, factorised.

    Attributes:
        rows: Their numbers, (active,).
        friction: Rows in which the gap is not simply 0.
        right: Right-hand side of a Newton step, (active,).
        factors: LU of the transposed matrix, and its pivots.
    """

    rows: Integers
    friction: FrictionRows
    right: Array
    factors: tuple[Array, Integers]

    def solve(self, right: Array, transposed: bool = False) -> Array:
        """Solve for the active rows.

        Args:
            right: (active,) or (active, several).
            transposed: Solve with the transposed matrix.
        """
        if len(self.rows) == 0:
            return right
        return np.asarray(dgetrs(*self.factors, right, trans=0 if transposed else 1)[0])


def friction_rows(equations: NaturalMap, state: PointState) -> FrictionRows:
    """Linearise friction where points slip, and where they stick with an elastic slip."""
    rubs = state.closed & equations.rubs
    slipping = _slipping_rows(equations, state, np.flatnonzero(rubs & ~state.sticks))
    if not equations.has_elastic_slip:
        return slipping
    numbers = np.flatnonzero(rubs & state.sticks & (equations.elastic > 0))
    elastic = _elastic_rows(equations, state, numbers)
    parts = zip(vars(slipping).values(), vars(elastic).values(), strict=True)
    return FrictionRows(*(np.concatenate(pair) for pair in parts))


def _slipping_rows(equations: NaturalMap, state: PointState, numbers: Integers) -> FrictionRows:
    """r_t = g z_t/|z_t|."""
    bound, length = state.bound[numbers], state.length[numbers, None]
    direction = state.along[numbers] / length
    size = direction.shape[1]
    turning = np.zeros((len(numbers), size, size))
    if size > 1:  # in the plane a direction does not turn
        turning -= direction[:, :, None] * direction[:, None, :]
        turning += np.eye(size)
        turning *= (bound[:, None] / length)[:, :, None]
    slope = _slopes(equations, state, numbers)
    right = (bound - slope * state.force[numbers])[:, None] * direction
    return FrictionRows(numbers, turning, slope[:, None] * direction, right)


def _elastic_rows(equations: NaturalMap, state: PointState, numbers: Integers) -> FrictionRows:
    """r_t = g/(g + ε) z_t, which grows with g by ε/(g + ε)² z_t."""
    elastic, along = equations.elastic[numbers], state.along[numbers]
    limit = state.bound[numbers] + elastic
    share = state.bound[numbers] / limit
    by_force = (elastic / limit**2 * _slopes(equations, state, numbers))[:, None] * along
    turning = share[:, None, None] * np.eye(along.shape[1])
    return FrictionRows(numbers, turning, by_force, -by_force * state.force[numbers, None])


def _slopes(equations: NaturalMap, state: PointState, numbers: Integers) -> Array:
    """Slopes of bounds in forces that are unknown."""
    return np.where(equations.given[numbers], 0.0, state.slope[numbers])


def adhesive_rows(equations: NaturalMap) -> FrictionRows:
    """No friction rows: all that touches sticks."""
    size = equations.dimension - 1
    nothing = np.zeros((0, size))
    return FrictionRows(np.zeros(0, dtype=np.int64), np.zeros((0, size, size)), nothing, nothing)


def linearised(equations: NaturalMap, closed: Flags, friction: FrictionRows) -> ActiveSystem | None:
    """Linearise the equations of the points in contact, and factorise their matrix.

    Args:
        equations: Of the problem.
        closed: Points in contact, (points,).
        friction: Linearised friction at some of them.

    Returns:
        The system; None where its matrix is singular.
    """
    is_active = np.ones(len(equations.free), dtype=bool)
    is_active[: equations.count] = (equations.active & closed[:, None]).ravel()
    rows = np.flatnonzero(is_active)
    right = -equations.free[rows]
    if len(rows) == 0:
        return ActiveSystem(rows, friction, right, (np.zeros((0, 0)), rows))
    matrix = equations.compliance.take(rows, axis=0).take(rows, axis=1)
    if len(friction.points):
        _put_friction(equations, friction, is_active, matrix, right)
    size = np.abs(matrix).sum(axis=1).max()
    # Of the transposed matrix, whose rows lie one behind the other, as LAPACK wants columns.
    factor, pivots, failed = dgetrf(matrix.T, overwrite_a=1)
    if failed or dgecon(factor, size)[0] < SINGULAR:
        return None
    return ActiveSystem(rows, friction, right, (factor, pivots))


def _put_friction(
    equations: NaturalMap, friction: FrictionRows, is_active: Flags, matrix: Array, right: Array
) -> None:
    """Put rows of friction in place of rows in which the slip is 0."""
    dimension, turning = equations.dimension, friction.turning
    place = np.cumsum(is_active) - 1
    first = friction.points * dimension
    along_rows = first[:, None] + np.arange(1, dimension)
    along, across = place[along_rows], place[first]
    block = np.zeros((*along.shape, len(right)))
    if turning.any():  # never in the plane, but of points that stick elastically
        block = np.einsum("kij,kjm->kim", turning, matrix[along])
    numbers = np.arange(len(along))
    for i in range(dimension - 1):
        for j in range(dimension - 1):
            block[numbers, i, along[:, j]] += float(i == j) - turning[:, i, j]
    unknown = is_active[first]  # the force across, where it is not given
    block[numbers[unknown], :, across[unknown]] -= friction.by_force[unknown]
    matrix[along] = block
    right[along] = friction.right - np.einsum("kij,kj->ki", turning, equations.free[along_rows])
