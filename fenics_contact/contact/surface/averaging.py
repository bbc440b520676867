"""Averages of a field on a contact surface around each of its points: w_ρ ∗ p.

The kernel is k(d) = exp(−1 / (1 − (d/ρ)²)) for d < ρ and 0 beyond (G. Duvaut, C. R. Acad. Sci.
Paris A 290 (1980) 263-265; J. T. Oden and E. B. Pires, J. Appl. Mech. 50 (1983) 67-76, use such a
one). The distance d is

- in the plane, the length along the connected line of contact;
- in 3D the straight one. Of a curved surface that is the chord; points are not averaged whose
  normals are at a right angle or more, as those on the other side of a thin body, or that the
  surface does not connect;
- in axisymmetric models likewise, and the kernel is integrated around the axis.

Planes of symmetry that the surface ends in have mirror images behind them. At edges the kernel is
scaled: the weight between two points is s(x) k(d) s(y) with the one function s > 0 for which the
average of 1 is 1 everywhere. As that is symmetric, the average also keeps the integral of p: no
force is lost at edges. Away from edges s is constant.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, diags, identity
from scipy.sparse.linalg import spsolve

from fenics_contact.analytic.complex_step import slope
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.contact.surface.mirrored_places import MirroredPlaces
from fenics_contact.contact.surface.trace import Trace

# Pairs of places, by rows and columns, and the kernel's values there at a radius.
_Kernel = tuple[tuple[Integers, Integers], Callable[[complex], Array]]
# Of the average of 1.
_EXACT = 1e-13
# Gauss points of the kernel around the axis, where it is not 0.
_AROUND = 32


class SurfaceAverage:
    """W of the contact points of one surface; all calls but ``pairs`` are collective.

    Attributes:
        radius: ρ (length).
        rows: Numbers of this rank's points, of every pair that may be averaged with each other.
        columns: Likewise the places of the others among those of all ranks.

    Args:
        trace: The contact points.
        radius: ρ > 0.
    """

    def __init__(self, trace: Trace, radius: float) -> None:
        self.radius = radius
        self._trace = trace
        self._places = MirroredPlaces(trace, radius)
        if trace.spaces.kinematics == "axisymmetric":
            self._pairs, self._values_of = _around_axis(self._places, radius)
        elif trace.spaces.components == 2:
            self._pairs, self._values_of = _along_line(self._places, radius)
        else:
            self._pairs, self._values_of = _straight(self._places, radius)
        self._kernel = whole = self._matrix(self._values_of(radius))
        own = whole[self._places.mine].tocoo()
        self.rows, self.columns = own.row.astype(np.int64), own.col.astype(np.int64)
        self._values = own.data
        self._counted: Array | None = None

    def _matrix(self, values: Array) -> csr_matrix:
        """Values of the pairs between all places."""
        count = len(self._places.coordinates)
        return csr_matrix(coo_matrix((values, self._pairs), shape=(count, count)))

    def over(self, counted: Flags) -> None:
        """Average over some of the points only, and only there, from now on.

        Args:
            counted: Which points of this rank, (points,).
        """
        areas = np.where(counted, self._trace.weights, 0.0)
        gathered = self._places.gathered(areas)
        if self._counted is not None and np.array_equal(self._counted, gathered):
            return
        self._counted = gathered
        self._scale = _scale(self._kernel, gathered)

    def apply(self, values: Array) -> Array:
        """The average around each point of this rank, (points,)."""
        return self._scaled(self._areas * self._scale * self._places.gathered(values))

    def transposed(self, values: Array) -> Array:
        """Wᵀ times values at the points, each of which counts once; (points,)."""
        found = self._areas[self.places] * self._scaled(self._scale * self._places.gathered(values))
        return np.asarray(found)

    def radius_slope(self, values: Array) -> Array:
        """Derivative of the average in the radius, (points,).

        The kernel K has no kink anywhere, so that pairs come into reach without a jump. As
        s_i Σ_j K_ij A_j s_j = 1 for any radius, (1 + W) of ds/s is −s_i Σ_j dK_ij A_j s_j.
        """
        areas = self._areas
        kernel_slope = self._matrix(slope(self._values_of, self.radius))
        counts = areas > 0
        inside = self.matrix[counts][:, counts]
        left = -self._scale * (kernel_slope @ (areas * self._scale))
        of_scale = np.zeros(len(areas))
        of_scale[counts] = spsolve((identity(int(counts.sum())) + inside).tocsc(), left[counts])
        loads = areas * self._scale * self._places.gathered(values)
        found = of_scale * self._scale * (self._kernel @ loads)
        found += self._scale * (kernel_slope @ loads + self._kernel @ (of_scale * loads))
        return np.asarray(found[self.places])

    @property
    def weights(self) -> Array:
        """W of ``rows`` and ``columns``, (pairs,)."""
        column = self._areas * self._scale
        return np.asarray(self._scale[self.places][self.rows] * self._values * column[self.columns])

    def gathered(self, values: Array) -> Array:
        """Values at the points of all ranks, by their places, 0 at those that are no points.

        Args:
            values: At the points, first axis points.
        """
        return self._places.gathered(values)

    @property
    def matrix(self) -> csr_matrix:
        """W between all places."""
        columns = self._areas * self._scale
        return csr_matrix(diags(self._scale) @ self._kernel @ diags(columns))

    @property
    def places(self) -> Integers:
        """Numbers of this rank's points among the places of all ranks; nodes by theirs."""
        return self._places.mine

    @property
    def nodes_of_places(self) -> tuple[Integers, Array]:
        """Nodes of the surface that each place moves with, and their shares, (places, 1 or 6)."""
        return self._places.nodes_of_places

    @property
    def _areas(self) -> Array:
        if self._counted is None:
            self.over(np.ones(len(self._trace.weights), dtype=bool))
        assert self._counted is not None
        return self._counted

    def _scaled(self, at_places: Array) -> Array:
        """Kernel and scale times values at all places, at the points of this rank."""
        return np.asarray((self._scale * (self._kernel @ at_places))[self.places])


def bump(ratio: Array) -> Array:
    """exp(−1 / (1 − r²)) of r = d/ρ < 1, and 0 from there on, where it has no kink at all.

    Args:
        ratio: R; with an imaginary part for a complex step.
    """
    inside = np.where(ratio.real < 1, ratio, 0.0)
    return np.where(ratio.real < 1, np.exp(-1 / ((1 - inside) * (1 + inside))), 0.0)


def _scale(kernel: csr_matrix, areas: Array) -> Array:
    """The s > 0 with s_i Σ_j K_ij A_j s_j = 1 where A_i > 0, and 0 elsewhere.

    A symmetric matrix with a positive diagonal has one (R. Sinkhorn, P. Knopp, Pac. J. Math. 21
    (1967) 343-348). With the square root the iteration does not go to and fro: its errors halve.
    """
    counts = areas > 0
    inside = kernel[counts][:, counts]
    within = areas[counts]
    found = 1 / np.sqrt(inside @ within) if counts.any() else np.zeros(0)
    ones = found * (inside @ (within * found))
    while np.abs(ones - 1).max(initial=0.0) > _EXACT:
        found = found / np.sqrt(ones)
        ones = found * (inside @ (within * found))
    scale = np.zeros(len(areas))
    scale[counts] = found
    return scale


def _along_line(places: MirroredPlaces, radius: float) -> _Kernel:
    """Kernel of distances along a line: pairs of places, and their values at a radius."""
    rows, columns, distances = places.along_line(radius)
    return (rows, columns), lambda reach: bump(distances / reach)


def _straight(places: MirroredPlaces, radius: float) -> _Kernel:
    """Weights by straight distances in 3D, images one by one."""
    rows, columns, copies = places.straight(radius, [0, 1, 2])
    there, normals = places.images(columns, copies)
    distances = np.linalg.norm(places.coordinates[rows] - there, axis=1)
    along = np.einsum("ij,ij->i", places.normals[rows], normals) > 0
    return (rows, columns), lambda reach: np.where(along, bump(distances / reach), 0.0)


def _around_axis(places: MirroredPlaces, radius: float) -> _Kernel:
    """Mean of the weight over the rings around the axis."""
    rows, columns, copies = places.straight(radius, [0, 1])
    there, there_normals = places.images(columns, copies)
    here, normals = places.coordinates[rows], places.normals[rows]
    product = here[:, 0] * there[:, 0]
    apart = ((here - there) ** 2).sum(axis=1)

    def values(reach: complex) -> Array:
        # d² = apart + 2 r r' (1 − cos θ) reaches ρ² at the angle `last`, or nowhere.
        share = (reach**2 - apart) / (4 * np.where(product > 0, product, 1.0))
        whole = share.real >= 1
        part = np.where((share.real > 0) & ~whole, share, 0.0)
        half = np.where(whole, 0.5 * np.pi, np.arcsin(np.sqrt(part)))
        last = np.where(product > 0, 2 * half, np.pi)
        found = np.zeros_like(share)
        for node, weight in zip(*np.polynomial.legendre.leggauss(_AROUND), strict=True):
            angle = 0.5 * last * (1 + node)
            distance = np.sqrt(apart + 4 * product * np.sin(0.5 * angle) ** 2)
            turned = normals[:, 0] * there_normals[:, 0] * np.cos(angle)
            along = (turned + normals[:, 1] * there_normals[:, 1]).real > 0
            found += weight * np.where(along, bump(distance / reach), 0.0)
        return np.asarray(found * last / (2 * np.pi))

    return (rows, columns), values
