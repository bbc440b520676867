"""Convex polygons in the plane: what two of them have in common, for many pairs at once.

Polygons are (polygons, corners, 2) (length); where one has fewer corners, its last is repeated.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array


def areas(polygons: Array) -> Array:
    """Areas, negative for polygons that run clockwise, (polygons,)."""
    x = polygons - polygons[:, :1]
    following = np.roll(x, -1, axis=1)
    return 0.5 * _cross(x, following).sum(axis=1)


def counter_clockwise(polygons: Array) -> Array:
    """The polygons, reversed where they run clockwise."""
    return np.where(areas(polygons)[:, None, None] < 0, polygons[:, ::-1], polygons)


def clip(polygons: Array, windows: Array) -> Array:
    """Common parts of convex polygons and windows that run counter-clockwise.

    After Sutherland and Hodgman: the polygon is cut along each side of the window in turn.
    Parts that are empty have area 0.
    """
    for side in range(windows.shape[1]):
        begin, end = windows[:, side], windows[:, (side + 1) % windows.shape[1]]
        polygons = _cut(polygons, begin, end)
    return polygons


def fan(polygons: Array) -> Array:
    """Triangles from the first corner of convex polygons, (polygons, corners − 2, 3, 2)."""
    begin, end = polygons[:, 1:-1], polygons[:, 2:]
    return np.stack([np.broadcast_to(polygons[:, :1], begin.shape), begin, end], axis=2)


def _cut(polygons: Array, begin: Array, end: Array) -> Array:
    """The parts to the left of lines from begin to end, (polygons, 2) each."""
    count, corners = polygons.shape[:2]
    height = _cross((end - begin)[:, None], polygons - begin[:, None])
    following, height_following = np.roll(polygons, -1, axis=1), np.roll(height, -1, axis=1)
    stays = height >= 0
    crosses = stays != (height_following >= 0)
    share = height / np.where(crosses, height - height_following, 1.0)
    crossing = polygons + share[:, :, None] * (following - polygons)

    # Along each side: its first corner, then where it crosses the line.
    points = np.stack([polygons, crossing], axis=2).reshape(count, 2 * corners, 2)
    kept = np.stack([stays, crosses], axis=2).reshape(count, 2 * corners)
    # A line adds one corner to a convex polygon at most.
    order = np.argsort(~kept, axis=1, kind="stable")[:, : corners + 1]
    last = np.maximum(kept.sum(axis=1) - 1, 0)
    order = np.take_along_axis(order, np.minimum(np.arange(corners + 1), last[:, None]), axis=1)
    return np.take_along_axis(points, order[:, :, None], axis=1)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
