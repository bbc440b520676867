"""The nearest point of a convex cone to a load, and the motion that separates the two.

The cone is known by its rays: a function gives, for a direction, the ray that goes farthest along
it. Rays are added one by one until none goes along what is left of the load, and those that carry
nothing are dropped (C. L. Lawson and R. J. Hanson, Solving Least Squares Problems, 1974, ch. 23;
with rays found when needed: Y. Zheng and C.-M. Chew, IEEE Trans. Robotics 25 (2009) 1397-1412).
What is left is orthogonal to all rays that carry, to round-off of itself: so that a motion is found
to full accuracy even where it is tiny beside the load.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array

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
