"""Where a surface lies in planes of symmetry, in walls, or on the axis of revolution.

A wall is a flat side that supports hold along the axis across it. A model held there is the same as
one with a plane of symmetry, so normals at the end of a smooth surface are the same, too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.contact.surface.space import SurfaceSpace

# Distance from a plane over the extent of the surface, up to which a node lies in it.
_IN_PLANE = 1e-9
# Up to which part across a wall, over how much this part changes along a facet, a normal at the
# wall is that of a surface which goes on smoothly behind it, by the order of the cells. On equal
# straight facets of a circle it is 1, on facets of order 2 that span 90 degrees 0.08.
_GOES_ON = {1: 2.0, 2: 0.1}
# A part of a normal that is round-off.
_ROUND_OFF = 1e-9


class SurfaceSymmetry:
    """Planes of symmetry, and the axis of revolution, as a surface meets them.

    Args:
        surface: The surface.
        flat_sides: Axis across each plane, and where on that axis it stands (length).
        walls: The same of flat sides that supports hold.
        normals: Averages over the facets around each node, unit normals at all nodes,
            (nodes, components).
    """

    def __init__(
        self,
        surface: SurfaceSpace,
        flat_sides: Sequence[tuple[int, float]],
        walls: Sequence[tuple[int, float]],
        normals: Array,
    ) -> None:
        self._surface, self._flat_sides = surface, flat_sides
        self._mirrored = self.in_planes() | self._goes_on_behind(walls, normals)

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
        return self._in(self._flat_sides)

    def _in(self, sides: Sequence[tuple[int, float]]) -> Flags:
        """Across which axes nodes lie in planes, (nodes, components); collective."""
        surface = self._surface
        found = np.zeros((len(surface.coordinates), surface.components), dtype=bool)
        size = surface.extent()
        for axis, at in sides:
            found[:, axis] |= np.abs(surface.coordinates[:, axis] - at) <= _IN_PLANE * size
        return found

    def _goes_on_behind(self, walls: Sequence[tuple[int, float]], normals: Array) -> Flags:
        """At which nodes, across which axes, it goes on smoothly behind a wall; collective.

        (nodes, components). There the part of a normal across the wall is what the average over
        one side alone makes. Where the surface meets the wall at another angle, as a wedge does,
        normals are kept.
        """
        surface = self._surface
        at_nodes = normals[surface.facet_nodes]
        turns = np.abs(at_nodes[:, :, None] - at_nodes[:, None]).max(axis=2, initial=0.0)
        sums = np.zeros((len(normals), 1 + surface.components))
        ones = np.ones((*turns.shape[:2], 1))
        np.add.at(sums, surface.facet_nodes, np.concatenate([ones, turns], axis=2))
        sums = surface.summed(sums)
        turn = sums[:, 1:] / np.maximum(sums[:, :1], 1.0)
        most = _GOES_ON[surface.spaces.geometry_order] * turn + _ROUND_OFF
        return np.asarray(self._in(walls) & (np.abs(normals) <= most))

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
        """In a plane of symmetry, in a wall, or on the axis, normals have no part across it.

        The average over one side alone would be tilted where the surface is curved.

        Args:
            normals: At all nodes, (nodes, components).

        Returns:
            Unit normals, likewise.
        """
        kept = np.where(self._mirrored, 0.0, normals)
        lengths = np.linalg.norm(kept, axis=1)
        return np.asarray(kept / np.where(lengths > 0, lengths, 1.0)[:, None])
