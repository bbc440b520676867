"""Units in which all contact points have a compliance near 1, and friction is isotropic.

With r = T r̂ the problem is v̂ = Ŵ r̂ + q̂, Ŵ = Tᵀ W T, q̂ = Tᵀ q and v̂ = Tᵀ v. T multiplies the rows
of a point by one number, which leaves Coulomb's law as it is, and those along it by the metric M of
friction, which turns orthotropic friction into isotropic friction: M⁻¹ r_t = −g (M v_t)/|M v_t|.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array

# Of the largest compliance of a point: rows with less are of directions in which supports hold one.
_HELD = 1e-15


@dataclass(eq=False)
class Scaling:
    """Ŵ and T, with what solves have found out about Ŵ.

    Attributes:
        compliance: Ŵ, (rows, rows).
        size: Number that multiplies each row, (rows,).
        metric: M at the points, (points, along, along); None for the unit matrix.
        points: Number of points.
        dimension: Rows of a point.
        is_singular: Whether points in contact had a singular compliance in an earlier solve; the
            next one is then prepared for it.
    """

    compliance: Array
    size: Array
    metric: Array | None
    points: int
    dimension: int
    is_singular: bool = False

    @property
    def of_points(self) -> Array:
        """Number that multiplies the rows of each point, (points,)."""
        return self.size[: self.points * self.dimension : self.dimension]

    def forces(self, scaled: Array) -> Array:
        """Forces r = T r̂, (rows,)."""
        return self.size * self._by_metric(scaled)

    def transposed(self, values: Array) -> Array:
        """Gaps v̂ = Tᵀ v from gaps v, (rows,)."""
        return self._by_metric(self.size * values)

    def scaled_forces(self, forces: Array) -> Array:
        """Return r̂ = T⁻¹ r, (rows,)."""
        return self._by_metric(forces / self.size, inverse=True)

    def _by_metric(self, values: Array, inverse: bool = False) -> Array:
        if self.metric is None:
            return values
        found = values.copy()
        along = found[: self.points * self.dimension].reshape(self.points, self.dimension)[:, 1:]
        if inverse:
            along[:] = np.linalg.solve(self.metric, along[..., None])[..., 0]
        else:
            along[:] = np.einsum("pij,pj->pi", self.metric, along)
        return found


def scaled(
    compliance: Array,
    points: int,
    dimension: int,
    series: Array | None = None,
    metric: Array | None = None,
) -> Scaling:
    """Find T and Ŵ.

    Args:
        compliance: W, (rows, rows).
        points: Number of points.
        dimension: Rows of a point.
        series: Compliance of a layer at each point, (points,), or None.
        metric: M at the points, (points, along, along), or None.
    """
    size, found = np.ones(len(compliance)), compliance.copy()
    count = points * dimension
    diagonal = np.einsum("ii->i", found)
    if series is not None:
        diagonal[:count:dimension] += series
    if metric is not None:
        found = _on_both_sides(found, metric, points, dimension)
        diagonal = np.einsum("ii->i", found)
    of_points = diagonal[:count].reshape(points, dimension)
    # A stiffness that is not positive, as of bodies in compression, leaves compliances below 0.
    sizes = np.abs(of_points)
    trace = sizes.sum(axis=1)
    # Rows of directions in which a point is held are 0: their slip is 0 whatever the force. With
    # a compliance of their own, which nothing else sees, the force there is 0, too.
    held = sizes <= _HELD * trace.max()
    free = dimension - held.sum(axis=1)
    typical = float(trace.max()) / dimension or 1.0
    mean = np.where(free > 0, trace / np.maximum(free, 1), typical)
    of_points[held] = np.broadcast_to(mean[:, None], held.shape)[held]
    size[:count] = np.repeat(1 / np.sqrt(mean), dimension)
    if len(size) > count:
        largest = np.abs(found[count:] * size).max(axis=1)
        size[count:] = 1 / np.where(largest > 0, largest, 1.0)
    found *= size[:, None]
    found *= size
    return Scaling(found, size, metric, points, dimension)


def _on_both_sides(compliance: Array, metric: Array, points: int, dimension: int) -> Array:
    """Mᵀ W M of the rows along the contact."""
    count = points * dimension
    blocks = np.zeros((points, dimension, dimension))
    blocks[:, 0, 0] = 1.0
    blocks[:, 1:, 1:] = metric
    found = compliance.copy()
    rows = found[:count].reshape(points, dimension, -1)
    found[:count] = np.einsum("pji,pjk->pik", blocks, rows).reshape(count, -1)
    columns = found[:, :count].reshape(-1, points, dimension)
    found[:, :count] = np.einsum("kpi,pij->kpj", columns, blocks).reshape(-1, count)
    return found
