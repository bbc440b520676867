"""Prescribed displacements: supports and planes of symmetry as degrees of freedom."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, raise_together, smallest, total
from fenics_contact.scene.load_paths import KeyedPath
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import AXES, RAMP

# A plane of symmetry is flat to this share of the body's size.
_FLAT = 1e-9


@dataclass(frozen=True, eq=False)
class AppliedSupport:
    """A support as degrees of freedom.

    Attributes:
        on: Name of the group.
        dofs: Local indices (owned and ghost) into the flat displacement array.
        values: Prescribed displacement of each (length).
        path: How they grow over the load steps.
        name: In results; by default that of the group.
    """

    on: str
    dofs: Integers
    values: Array
    path: Callable[[float], float] = RAMP
    name: str = ""

    @property
    def label(self) -> str:
        """Name in results."""
        return self.name or self.on


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


class Supports:
    """All supports of a scene; collective.

    Attributes:
        applied: Supports in scene order, the planes of symmetry, the axis of revolution.
        planes: The planes of symmetry; the axis of revolution is none.
        dofs: Every constrained dof once, sorted (local indices, owned and ghost).
        values: Their prescribed displacements (length).

    Raises:
        InputError: Two supports contradict each other, or a plane of symmetry is not flat.
    """

    def __init__(self, scene: Scene, spaces: Spaces) -> None:
        self._spaces = spaces
        self.applied = [self._support(scene, number) for number in range(len(scene.support))]
        planes = [self._plane(on, f"symmetry[{i}]") for i, on in enumerate(scene.symmetry)]
        self.applied += [self._of_plane(plane) for plane in planes]
        self.planes = list({(plane.axis, round(plane.at, 9)): plane for plane in planes}.values())
        if spaces.kinematics == "axisymmetric":
            self.planes = [plane for plane in self.planes if plane.axis != 0]
            self.applied += self._axis_of_revolution()
        self.dofs, self.values = self._constraints()

    @property
    def symmetry(self) -> str:
        """Which part of the whole is modelled, and by which planes."""
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

    def _support(self, scene: Scene, number: int) -> AppliedSupport:
        key, spaces = f"support[{number}]", self._spaces
        on = scene.support[number].on
        nodes = spaces.nodes(spaces.body.group(on, f"{key}.on"))
        dofs, values = [], []
        for axis, value in scene.support[number].displacement.items():
            dofs.append(nodes.astype(np.int64) * spaces.components + AXES.index(axis))
            values.append(spaces.evaluate(value, nodes, f"{key}.displacement.{axis}"))
        path = KeyedPath(scene.support[number].path, f"{key}.path")
        held, label = np.concatenate(dofs), scene.support[number].label
        return AppliedSupport(on, held, np.concatenate(values), path, label)

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

    def _of_plane(self, plane: SymmetryPlane) -> AppliedSupport:
        spaces = self._spaces
        nodes = spaces.nodes(spaces.body.boundary(plane.on, "symmetry"))
        dofs = nodes.astype(np.int64) * spaces.components + plane.axis
        return AppliedSupport(plane.on, dofs, np.zeros(len(dofs)))

    def _axis_of_revolution(self) -> list[AppliedSupport]:
        """Points on the axis stay on it, where the body reaches it."""
        spaces = self._spaces
        radii = spaces.coordinates[:, 0]
        nodes = np.flatnonzero(radii <= _FLAT * largest(spaces.comm, radii)).astype(np.int64)
        if total(spaces.comm, len(nodes)) == 0:
            return []
        name = "the axis of revolution"
        return [AppliedSupport(name, nodes * spaces.components, np.zeros(len(nodes)))]

    def add(self, support: AppliedSupport) -> None:
        """Hold dofs that nothing holds yet."""
        self.applied.append(support)
        self.dofs, self.values = self._constraints()

    def _constraints(self) -> tuple[Integers, Array]:
        """All constrained dofs, each once, with their values."""
        owner: dict[int, tuple[float, str]] = {}
        error = None
        every = [np.zeros(0), *(support.values for support in self.applied)]
        size = largest(self._spaces.comm, np.abs(np.concatenate(every)))
        for support in self.applied:
            for dof, value in zip(support.dofs.tolist(), support.values.tolist(), strict=True):
                first, on = owner.setdefault(dof, (value, support.on))
                if abs(first - value) > 1e-12 * size:
                    axis = AXES[dof % self._spaces.components]
                    error = InputError(
                        f"support on '{support.on}': displacement.{axis} = {value:g}, but the "
                        f"support on '{on}' prescribes {first:g} at a point of both"
                    )
        raise_together(self._spaces.comm, error)
        dofs = np.array(sorted(owner), dtype=np.int64)
        return dofs, np.array([owner[dof][0] for dof in dofs.tolist()])

    def at(self, time: float) -> Array:
        """Prescribed displacements of ``dofs`` at a pseudo-time (length)."""
        values = np.zeros(self.dofs.max(initial=-1) + 1)
        for support in reversed(self.applied):  # the first to hold a dof counts
            values[support.dofs] = support.values * support.path(time)
        return values[self.dofs]
