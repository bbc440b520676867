"""Whether the points of a contact surface cover a zone: neither cut off nor with a hole in it."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from fenics_contact.common.arrays import Array

_ENDS = 1e-2  # of the zone's radius, that points may end before it
_HOLE = 1.5  # times the distances between points: how far from all of them nothing may be
_DIRECTIONS, _RINGS = 32, 100


def covers(offsets: Array, radius: float, mirrors: list[int]) -> bool:
    """Whether a surface reaches all around a zone, without a hole wider than a few spacings.

    Args:
        offsets: Of its points from the middle of the zone, (points, 1) or (points, 2) (length).
        radius: Of the zone, or its half-width (length).
        mirrors: Axes of the offsets across which planes of symmetry stand, through the middle.
    """
    for axis in mirrors:
        offsets = np.concatenate(
            [offsets, offsets * np.where(np.arange(offsets.shape[1]) == axis, -1, 1)]
        )
    _, once = np.unique(np.round(offsets / radius, 6), axis=0, return_index=True)
    offsets = offsets[once]
    line = offsets.shape[1] == 1
    turns = np.linspace(0, 2 * np.pi, _DIRECTIONS, endpoint=False)
    around = np.array([[1.0], [-1.0]]) if line else np.stack([np.cos(turns), np.sin(turns)], axis=1)
    neighbours = 1 if line else 4  # so that long cells are no holes
    if len(offsets) <= neighbours or (offsets @ around.T).max(axis=0).min() < (1 - _ENDS) * radius:
        return False
    tree = KDTree(offsets)
    spacing = tree.query(offsets, [neighbours + 1])[0][:, 0]
    zone = np.linspace(0, 1 - _ENDS, _RINGS)[:, None, None] * radius * around
    distance, nearest = tree.query(zone.reshape(-1, offsets.shape[1]))
    return bool((distance <= _HOLE * spacing[nearest]).all())
