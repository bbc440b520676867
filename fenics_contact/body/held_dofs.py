"""Degrees of freedom that supports, planes of symmetry and the axis of revolution hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.body.description import BodyDescription, HeldGroup
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, of_every_rank, smallest, total
from fenics_contact.scene.values import AXES

# A plane of symmetry is flat to this share of the body's size.
_FLAT = 1e-9


@dataclass(frozen=True)
class SymmetryPlane:
    """A plane of symmetry of the model.

    Attributes:
        on: Name of the group.
        axis: Number of the axis that it stands across.
        at: Its coordinate on that axis (length).
    """

    on: str
    axis: int
    at: float


@dataclass(frozen=True, eq=False)
class Held:
    """Dofs that one thing holds, whatever displacements it prescribes.

    Attributes:
        on: Name of the group.
        dofs: Local indices (owned and ghost) into the flat displacement array; of a support one
            component after the other.
    """

    on: str
    dofs: Integers


class HeldDofs:
    """All that is held; collective.

    Attributes:
        by_supports: In scene order.
        by_symmetry: By planes of symmetry, and the axis of revolution where it is reached.
        planes: The planes of symmetry; the axis of revolution is none.
        walls: Axis and coordinate of the flat sides that supports hold across, each once.
        dofs: Every held dof once, sorted (local indices, owned and ghost).

    Raises:
        InputError: A plane of symmetry is not flat.
    """

    def __init__(self, description: BodyDescription, spaces: Spaces) -> None:
        self._spaces = spaces
        self.by_supports = [self._group(i, held) for i, held in enumerate(description.held)]
        planes = [self._plane(on, f"symmetry[{i}]") for i, on in enumerate(description.symmetry)]
        self.walls = self._walls(description)
        self.by_symmetry = [self._of_plane(plane) for plane in planes]
        self.planes = list({(plane.axis, round(plane.at, 9)): plane for plane in planes}.values())
        if spaces.kinematics == "axisymmetric":
            self.planes = [plane for plane in self.planes if plane.axis != 0]
            self.by_symmetry += self._axis_of_revolution()
        none = np.zeros(0, dtype=np.int64)
        self.dofs = np.unique(np.concatenate([none, *(held.dofs for held in self.every)]))

    @property
    def every(self) -> list[Held]:
        """Held dofs of supports, then those of symmetry."""
        return [*self.by_supports, *self.by_symmetry]

    @property
    def symmetry(self) -> str:
        """Part of the whole that is modelled, and its planes of symmetry, in words."""
        if not self.planes:
            return "none"
        part = {1: "half", 2: "quarter", 3: "eighth"}.get(len(self.planes), "part")
        if self.parallel_planes:
            part = "part"
        where = (f"{AXES[plane.axis]} = {plane.at:.12g}" for plane in self.planes)
        return f"{part} ({', '.join(where)})"

    @property
    def flat_sides(self) -> list[tuple[int, float]]:
        """Axis and coordinate of the planes of symmetry, and of the axis of revolution."""
        sides = [(plane.axis, plane.at) for plane in self.planes]
        return [*sides, (0, 0.0)] if self._spaces.kinematics == "axisymmetric" else sides

    @property
    def parallel_planes(self) -> bool:
        """Whether two planes face each other: mirrored in both, the body goes on for ever."""
        return len({plane.axis for plane in self.planes}) < len(self.planes)

    def _group(self, number: int, held: HeldGroup) -> Held:
        spaces = self._spaces
        nodes = spaces.nodes(spaces.body.group(held.on, f"support[{number}].on"))
        axes = np.array([AXES.index(axis) for axis in held.axes])
        return Held(held.on, (nodes.astype(np.int64) * spaces.components + axes[:, None]).ravel())

    def _walls(self, description: BodyDescription) -> list[tuple[int, float]]:
        """Planes across an axis in which facets lie that supports hold along this axis.

        For a contact surface that ends in it, such a plane is what one of symmetry is.
        """
        spaces = self._spaces
        mesh, size = spaces.body.mesh, spaces.size
        found: dict[tuple[int, float], float] = {}
        for number, held in enumerate(description.held):
            group = spaces.body.group(held.on, f"support[{number}].on")
            if group.dimension != mesh.topology.dim - 1:
                continue
            nodes = compat.nodes_of_entities(mesh, group.dimension, spaces.body.entities(group))
            places = mesh.geometry.x[nodes]
            lowest = places.min(axis=1, initial=np.inf)
            extents = places.max(axis=1, initial=-np.inf) - lowest
            for axis in map(AXES.index, held.axes):
                at = np.unique(lowest[extents[:, axis] <= _FLAT * size, axis])
                found |= {(axis, round(float(one) / size, 9)): float(one) for one in at}
        for other in of_every_rank(spaces.comm, found):
            found = other | found
        return sorted((axis, at) for (axis, _), at in found.items())

    def _plane(self, on: str, key: str) -> SymmetryPlane:
        spaces = self._spaces
        points = spaces.coordinates[spaces.nodes(spaces.body.boundary(on, key))]
        lowest = np.array([smallest(spaces.comm, column) for column in points.T])
        highest = np.array([largest(spaces.comm, column) for column in points.T])
        extent = (highest - lowest)[: spaces.components]
        axis = int(np.argmin(extent))
        if extent[axis] > _FLAT * extent.max():
            raise InputError(f"{key} = '{on}': must lie in a plane across an axis of the mesh")
        at = float(lowest[axis])
        return SymmetryPlane(on, axis, 0.0 if abs(at) <= _FLAT * extent.max() else at)

    def _of_plane(self, plane: SymmetryPlane) -> Held:
        spaces = self._spaces
        nodes = spaces.nodes(spaces.body.boundary(plane.on, "symmetry"))
        return Held(plane.on, nodes.astype(np.int64) * spaces.components + plane.axis)

    def _axis_of_revolution(self) -> list[Held]:
        """Points on the axis stay on it, where the body reaches it."""
        spaces = self._spaces
        radii = spaces.coordinates[:, 0]
        nodes = np.flatnonzero(radii <= _FLAT * largest(spaces.comm, radii)).astype(np.int64)
        if total(spaces.comm, len(nodes)) == 0:
            return []
        return [Held("the axis of revolution", nodes * spaces.components)]
