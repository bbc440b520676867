"""Forces that contacts can bear on rigid motions, as cones and discs, and projections on cones.

The nearest point of a convex cone to a load, and the motion that separates the two. The cone is
known by its rays: a function gives, for a direction, the ray that goes farthest along it. Rays are
added one by one until none goes along what is left of the load, and those that carry nothing are
dropped (C. L. Lawson and R. J. Hanson, Solving Least Squares Problems, 1974, ch. 23; with rays
found when needed: Y. Zheng and C.-M. Chew, IEEE Trans. Robotics 25 (2009) 1397-1412). What is left
is orthogonal to all rays that carry, to round-off of itself: so that a motion is found to full
accuracy even where it is tiny beside the load.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, identity

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import gather_rows
from fenics_contact.problem.existence.rigid_slip import smooth_closing
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions, reduced

# Of the load: a distance that is no more is round-off.
NO_DISTANCE = 1e-12
# Of a ray: how far it may go along the motion that separates.
_ALONG = 1e-11
# The same where round-off stops the search.
_ALONG_AT_MOST = 1e-9
# Of a ray: what is less beside the other rays is round-off, and cannot be told from them.
_DEPENDS = 1e-13
# Five bodies in space take 460, and some three times as many close to the limit.
_MAX_RAYS = 10_000


@dataclass(frozen=True)
class Ray:
    """A generator of the cone.

    Attributes:
        along: Its direction, of any length (unknowns,).
        origin: What it is, for the caller.
    """

    along: Array
    origin: int


# For a unit direction: the ray that goes farthest along it for its length; None without any.
FindRay = Callable[[Array], Ray | None]


@dataclass(frozen=True)
class Separation:
    """How a load lies outside of a cone.

    Attributes:
        motion: Unit vector with motion · ray ≤ 0 for all rays, motion · load > 0, (unknowns,).
        distance: Of the load from the cone: motion · load.
        rays: Those that the nearest point of the cone is a sum of.
        amounts: How much of each, > 0.
    """

    motion: Array
    distance: float
    rays: list[Ray]
    amounts: Array


def separation(load: Array, find_ray: FindRay) -> Separation | None:
    """How a load lies outside of a cone; None where it lies within, or where round-off hides it."""
    size = float(np.linalg.norm(load))
    if size == 0:
        return None
    target = load / size
    rays: list[Ray] = []
    amounts = np.zeros(0)
    left = target
    for _ in range(_MAX_RAYS):
        distance = float(np.linalg.norm(left))
        if distance <= NO_DISTANCE:
            return None
        motion = left / distance
        ray = find_ray(motion)
        along = 0.0 if ray is None else float(motion @ ray.along / np.linalg.norm(ray.along))
        if ray is None or along <= _ALONG:
            return Separation(motion, size * distance, rays, size * amounts)
        before = rays
        rays, amounts, left = _with_ray(target, [*rays, ray], np.append(amounts, 0.0))
        if len(rays) == 0 or rays[-1] is not ray:
            break
    if along > _ALONG_AT_MOST:
        return None
    return Separation(motion, size * distance, before, size * amounts)


def separation_from(rays: Array, load: Array, size: float) -> Array | None:
    """The motion that separates a load from a cone of known rays.

    Args:
        rays: Its rays, (rays, unknowns).
        load: What may lie outside, (unknowns,).
        size: Of what the load is a sum of, for round-off.

    Returns:
        The unit vector of ``Separation``; None where the load lies within.
    """
    sizes = np.linalg.norm(rays, axis=1)
    units = rays[sizes > 0] / sizes[sizes > 0, None]

    def farthest(direction: Array) -> Ray | None:
        number = int(np.argmax(units @ direction))
        return Ray(units[number], number)

    found = separation(load, farthest if len(units) else lambda _: None)
    return None if found is None or found.distance <= NO_DISTANCE * size else found.motion


def _with_ray(target: Array, rays: list[Ray], amounts: Array) -> tuple[list[Ray], Array, Array]:
    """Least squares over non-negative amounts, the last ray being new; and what is left."""
    while True:
        matrix = np.column_stack([ray.along for ray in rays])
        orthonormal, upper = np.linalg.qr(matrix)
        short = np.abs(np.diag(upper)) <= _DEPENDS * np.linalg.norm(upper, axis=0)
        if matrix.shape[1] > matrix.shape[0] or short.any():
            wanted = np.append(amounts[:-1], -1.0)  # the new ray is no other than those before
        else:
            wanted = np.linalg.solve(upper, orthonormal.T @ target)
        if wanted.min(initial=1.0) > 0:
            left = target - orthonormal @ (orthonormal.T @ target)
            left -= orthonormal @ (orthonormal.T @ left)
            return rays, wanted, left
        falls = np.flatnonzero(wanted <= 0)
        shares = amounts[falls] / np.maximum(amounts[falls] - wanted[falls], 1e-300)
        amounts = amounts + shares.min() * (wanted - amounts)
        amounts[falls[np.argmin(shares)]] = 0.0
        kept = amounts > 0
        rays, amounts = [ray for ray, keep in zip(rays, kept, strict=True) if keep], amounts[kept]
        if not rays:
            return rays, amounts, target.copy()


# Of the closing of all motions: what is less is round-off.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class ContactCones:
    """Jumps of rigid motions where contacts may act, of all ranks.

    Attributes:
        closing: Across the surface at one-sided contacts, > 0 closing, (points, motions).
        coefficients: Friction coefficient there, (points,).
        slips: Along the surface there, as friction feels them, (points, components, motions).
        bounds: Friction bound times area where the bound is known, (other points,) (force).
        bounded_slips: The same there, (other points, components, motions).
        average: What makes of pressures at the points those that bounds follow; None where these
            are the same.
    """

    closing: Array
    coefficients: Array
    slips: Array
    bounds: Array
    bounded_slips: Array
    average: csr_matrix | None = None

    def resisted(self, lengths: Array) -> Array:
        """Work of friction by a unit pressure at each point against slips of some lengths.

        Averages keep ∫ p: what a pressure makes of bounds around it is by the same weights as what
        the pressures around a point make of its bound.

        Args:
            lengths: Of the slips at the points, (points,).
        """
        rubbed = self.coefficients * lengths
        return rubbed if self.average is None else np.asarray(self.average @ rubbed)

    def rubbing(self, point: int, directions: Array) -> Array:
        """Work of friction by a unit pressure at a point on the motions, (motions,).

        Args:
            point: Number of the point.
            directions: Of the friction at all points, (points, components).
        """
        if self.average is None:
            return np.asarray(self.coefficients[point] * (directions[point] @ self.slips[point]))
        row = self.average[[point]]
        weights = (row.data * self.coefficients[row.indices])[:, None] * directions[row.indices]
        return np.asarray(np.einsum("ic,icm->m", weights, self.slips[row.indices]))

    def aligned(self) -> tuple[ContactCones, Array]:
        """Take motions that close no contact as columns of their own, which close nothing at all.

        As a shaft's rotation in its bearing, also where its centre of mass lies beside its axis:
        else pressures of any size would hold the round-off of a combination.

        Returns:
            The cones of these motions, and the motions, as columns, (motions, motions).
        """
        motions = np.eye(self.closing.shape[1])
        _, sizes, rows = np.linalg.svd(np.linalg.qr(self.closing, mode="r"))
        sizes = np.append(sizes, np.zeros(len(rows) - len(sizes)))
        along = reduced(rows[sizes <= _ROUND_OFF * sizes.max(initial=0.0)].T)
        # Each is the only one in some row, of whose motion it takes the place.
        places = [int(np.abs(along - one).max(axis=1).argmin()) for one in np.eye(along.shape[1])]
        motions[:, places] = along
        found = self.of_motions(motions)
        closing = found.closing.copy()
        closing[:, places] = 0.0
        return replace(found, closing=closing), motions

    def of_motions(self, motions: Array) -> ContactCones:
        """The cones on combinations of the motions, which are columns."""
        return replace(
            self,
            closing=self.closing @ motions,
            slips=self.slips @ motions,
            bounded_slips=self.bounded_slips @ motions,
        )


def contact_cones(problem: Problem, rigid: RigidMotions) -> ContactCones:
    """Cones of all points that may touch, whatever their gap; collective.

    Left out are points whose ray misses what stands opposite. Glued ones need no room here:
    motions leave glue alone.
    """
    components, count = problem.spaces.components, rigid.count
    rows = [np.zeros((0, 3 + (1 + components) * count))]
    averages: dict[int, csr_matrix] = {}
    for number, contact in enumerate(problem.contacts):
        if not contact.is_one_sided:
            continue
        jumps, trace = rigid.jumps(contact), contact.trace
        coefficients = contact.friction.largest_coefficient
        neighbours, places = contact.friction.neighbours, np.zeros(len(coefficients))
        if neighbours is not None:
            averages[number], places = neighbours.matrix, neighbours.places.astype(float)
        numbers = np.full(len(places), float(number))
        closing = np.einsum("ijk,ij->ik", jumps, trace.normals)
        slips = contact.friction.rule.metric.at_each(
            jumps - closing[:, None, :] * trace.normals[:, :, None]
        )
        acts = trace.owned & contact.normal.can_press()
        closing = smooth_closing(contact, closing, jumps, acts)
        flat = slips.reshape(len(slips), components * count)
        rows.append(np.column_stack([coefficients, numbers, places, closing, flat])[acts])
    table = gather_rows(problem.comm, np.concatenate(rows))
    weights, slips = rigid.slips()
    known = gather_rows(
        problem.comm, np.column_stack([weights, slips.reshape(len(weights), components * count)])
    )
    return ContactCones(
        closing=table[:, 3 : 3 + count],
        coefficients=table[:, 0],
        slips=table[:, 3 + count :].reshape(-1, components, count),
        bounds=known[:, 0],
        bounded_slips=known[:, 1:].reshape(-1, components, count),
        average=_average(table[:, 1:3].astype(np.int64), averages) if averages else None,
    )


def _average(points: Integers, averages: dict[int, csr_matrix]) -> csr_matrix:
    """Factors of all points: contacts that average nothing have ones.

    Args:
        points: Contact and place of each, (points, 2).
        averages: Of contacts, by number, between their places.
    """
    found = identity(len(points), format="coo")
    own = ~np.isin(points[:, 0], list(averages))
    rows, columns, values = [found.row[own]], [found.col[own]], [found.data[own]]
    for number, matrix in averages.items():
        mine = np.flatnonzero(points[:, 0] == number)
        places = points[mine, 1]
        part = matrix[places][:, places].tocoo()
        rows.append(mine[part.row])
        columns.append(mine[part.col])
        values.append(part.data)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return csr_matrix(entries, shape=(len(points),) * 2)
