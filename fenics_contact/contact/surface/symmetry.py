"""Where a surface lies in planes of symmetry, or on the axis of revolution."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.contact.surface.space import SurfaceSpace

# Distance from a plane over the extent of the surface, up to which a node lies in it.
_IN_PLANE = 1e-9


class SurfaceSymmetry:
    """Planes of symmetry, and the axis of revolution, as a surface meets them.

    Args:
        surface: The surface.
        flat_sides: Axis across each plane, and where on that axis it stands (length).
    """

    def __init__(self, surface: SurfaceSpace, flat_sides: Sequence[tuple[int, float]]) -> None:
        self._surface, self._flat_sides = surface, flat_sides

    @property
    def axes(self) -> list[int]:
        """Axes across planes of symmetry, and across the axis of revolution."""
        return sorted({axis for axis, _ in self._flat_sides})

    def planes(self) -> list[tuple[int, float]]:
        """Planes of symmetry that the surface ends in, without the axis of revolution; collective.

        Returns:
            Axis across each, and where on that axis it stands (length).
        """
        surface = self._surface
        is_axis = surface.spaces.kinematics == "axisymmetric"
        sides = [side for side in self._flat_sides if not (is_axis and side[0] == 0)]
        owned, size = surface.coordinates[: surface.owned_nodes], surface.extent()
        ends = [np.abs(owned[:, axis] - at) <= _IN_PLANE * size for axis, at in sides]
        counts = total(surface.comm, np.array([end.sum() for end in ends]))
        return [side for side, count in zip(sides, counts, strict=True) if count > 0]

    def in_planes(self) -> Flags:
        """Across which axes nodes lie in planes of symmetry, (nodes, components); collective."""
        surface = self._surface
        found = np.zeros((len(surface.coordinates), surface.components), dtype=bool)
        size = surface.extent()
        for axis, at in self._flat_sides:
            found[:, axis] |= np.abs(surface.coordinates[:, axis] - at) <= _IN_PLANE * size
        return found

    def cut_axes(self) -> list[int]:
        """Axes across planes of symmetry that the surface ends in, and the radius; collective.

        The rest of a surface lies behind such a plane. One that does not reach it has a mirror
        image of its own there.
        """
        surface = self._surface
        owned = slice(0, surface.owned_nodes)
        found = total(surface.comm, self.in_planes()[owned].sum(axis=0)) > 0
        if surface.spaces.kinematics == "axisymmetric":
            found[0] = True
        return [int(axis) for axis in np.flatnonzero(found)]

    def mirrored(self, normals: Array) -> Array:
        """In a plane of symmetry, or on the axis, normals have no part across it; collective.

        The average over one side alone would be tilted where the surface is curved.

        Args:
            normals: At all nodes, (nodes, components).

        Returns:
            Unit normals, likewise.
        """
        kept = np.where(self.in_planes(), 0.0, normals)
        lengths = np.linalg.norm(kept, axis=1)
        return np.asarray(kept / np.where(lengths > 0, lengths, 1.0)[:, None])
