"""Displacements that supports and planes of symmetry prescribe, of the dofs that they hold."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fenics_contact.body.description import BodyDescription, CoupledGroup, HeldGroup
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, of_every_rank, raise_together, smallest, total
from fenics_contact.scene.loading.load_paths import KeyedPath, knots
from fenics_contact.scene.loading.supports import FaceRotation, Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import AXES, RAMP, AxisName, Value

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
        by_couplings: Likewise; of these the displacement follows from scalar unknowns. Couplings
            that are not rigid hold no dof.
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
        self.by_couplings = [self._of_face(i, one) for i, one in enumerate(description.couplings)]
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
        """Held dofs of supports, of couplings, which move them, then those of symmetry."""
        return [*self.by_supports, *self.by_couplings, *self.by_symmetry]

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

    def reached_planes(self, nodes: AnyIntegers) -> set[int]:
        """Axes across planes of symmetry in which some of the nodes lie; collective."""
        spaces = self._spaces
        places, close = spaces.coordinates[nodes], _FLAT * spaces.size
        return {
            plane.axis
            for plane in self.planes
            if smallest(spaces.comm, np.abs(places[:, plane.axis] - plane.at)) <= close
        }

    def _group(self, number: int, held: HeldGroup) -> Held:
        spaces = self._spaces
        nodes = spaces.nodes(spaces.body.group(held.on, f"support[{number}].on"))
        axes = np.array([AXES.index(axis) for axis in held.axes], dtype=np.int64)
        return Held(held.on, (nodes.astype(np.int64) * spaces.components + axes[:, None]).ravel())

    def _of_face(self, number: int, described: CoupledGroup) -> Held:
        spaces = self._spaces
        nodes = spaces.nodes(spaces.body.boundary(described.on, f"coupling[{number}].on"))
        size = spaces.components if described.is_rigid else 0
        dofs = nodes.astype(np.int64) * spaces.components + np.arange(size)[:, None]
        return Held(described.on, dofs.ravel())

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
            raise InputError(
                f"{key} = '{on}': must lie in a plane across an axis of the mesh; of another plane "
                "give a [[support]] with normal = 0"
            )
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


# Of the largest displacement, of those that are the same; and of shares of one.
_SAME_VALUE, _SAME_SHARE = 1e-12, 1e-9


@dataclass(frozen=True, eq=False)
class AppliedSupport:
    """A support as degrees of freedom.

    Attributes:
        on: Name of the group.
        dofs: Local indices (owned and ghost) into the flat displacement array.
        values: Prescribed displacement of each (length).
        path: How they grow over the load steps.
        name: In results; by default that of the group.
        follows: Whether scalar unknowns move it, besides these values.
    """

    on: str
    dofs: Integers
    values: Array
    path: Callable[[float], float] = RAMP
    name: str = ""
    follows: bool = False

    @property
    def label(self) -> str:
        """Name in results."""
        return self.name or self.on


class Supports:
    """The displacements that supports prescribe; collective.

    Attributes:
        applied: Supports in scene order, the planes of symmetry, the axis of revolution.
        held: The dofs that these hold.
        dofs: Every constrained dof once, sorted (local indices, owned and ghost).
        values: Their prescribed displacements (length).

    Raises:
        InputError: Two supports contradict each other.
    """

    def __init__(self, scene: Scene, spaces: Spaces, held: HeldDofs) -> None:
        self._spaces, self.held = spaces, held
        self.applied = [
            self._support(f"support[{number}]", support, held.by_supports[number])
            for number, support in enumerate(scene.support)
        ]
        self.applied += [
            AppliedSupport(
                one.on, held_so.dofs, np.zeros(len(held_so.dofs)), name=one.label, follows=True
            )
            for one, held_so in zip(scene.coupling, held.by_couplings, strict=True)
        ]
        self.applied += [
            AppliedSupport(each.on, each.dofs, np.zeros(len(each.dofs)))
            for each in held.by_symmetry
        ]
        self.dofs, self.values = self._constraints()
        self._given = scene.support
        self._shared = self._moved_by_several()
        self._require_same_paths(scene)

    def again(self, scene: Scene) -> Supports | None:
        """Supports of another scene on the same dofs; None where they differ; collective.

        Args:
            scene: Whose body is the same.
        """
        if scene.support != self._given:
            return None
        self._require_same_paths(scene)
        return copy.copy(self)

    def _support(self, key: str, support: Support, held: Held) -> AppliedSupport:
        spaces = self._spaces
        nodes = (held.dofs // spaces.components).astype(np.int32)
        axes = support.held(spaces.components)
        if not axes:  # springs hold no dof
            return AppliedSupport(held.on, held.dofs, np.zeros(0), name=support.label)
        nodes = nodes.reshape(len(axes), -1)
        given = [support.displacement.get(axis, 0.0) for axis in axes]
        values = [
            spaces.evaluate(value, of_axis, f"{key}.displacement.{axis}")
            for of_axis, axis, value in zip(nodes, axes, given, strict=True)
        ]
        turn = support.rotation
        if turn is not None:
            places = [spaces.coordinates[of_axis].T for of_axis in nodes]
            values = [
                moved + turn.displacement(axis, points)
                for moved, axis, points in zip(values, axes, places, strict=True)
            ]
        path = KeyedPath(support.path, f"{key}.path")
        return AppliedSupport(held.on, held.dofs, np.concatenate(values), path, support.label)

    def add(self, support: AppliedSupport) -> None:
        """Hold dofs that nothing holds yet."""
        self.applied = [*self.applied, support]
        self.dofs, self.values = self._constraints()

    def _constraints(self) -> tuple[Integers, Array]:
        """All constrained dofs, each once, with their values."""
        none = np.zeros(0)
        every = np.concatenate([none.astype(np.int64), *(one.dofs for one in self.applied)])
        given = np.concatenate([none, *(one.values for one in self.applied)])
        size = largest(self._spaces.comm, np.abs(given))
        dofs, first, same = np.unique(every, return_index=True, return_inverse=True)
        values = given[first]  # the first to hold a dof counts
        other = np.flatnonzero(np.abs(values[same] - given) > _SAME_VALUE * size)
        error = None
        if len(other):
            last = int(other[-1])
            axis = AXES[int(every[last]) % self._spaces.components]
            on, held_by = self._holder(last), self._holder(int(first[same[last]]))
            error = InputError(
                f"support on '{on}': displacement.{axis} = {given[last]:g}, but the support on "
                f"'{held_by}' prescribes {values[same[last]]:g} at a point of both"
            )
        raise_together(self._spaces.comm, error)
        return dofs, values

    def _holder(self, place: int) -> str:
        """Where the support is of which a dof is, by its place among those of all supports."""
        ends = np.cumsum([len(support.dofs) for support in self.applied])
        return self.applied[int(np.searchsorted(ends, place, side="right"))].on

    def _moved_by_several(self) -> list[tuple[int, int]]:
        """Pairs of supports that move a dof as far, by their numbers; collective."""
        size = largest(self._spaces.comm, np.abs(self.values))
        mine = {
            (one, other)
            for other, support in enumerate(self.applied)
            for one, first in enumerate(self.applied[:other])
            if np.isin(support.dofs[np.abs(support.values) > _SAME_VALUE * size], first.dofs).any()
        }
        return sorted(set().union(*of_every_rank(self._spaces.comm, mine)))

    def _require_same_paths(self, scene: Scene) -> None:
        """Supports that move a dof as far do so at the same time.

        Raises:
            InputError: They do not; on every rank.
        """
        if not self._shared:
            return
        ends = {*scene.load_steps.all_times, *knots(scene)}
        times = sorted({scene.path_time(time) for time in ends})
        for one, other in self._shared:
            first, second = self.applied[one], self.applied[other]
            for time in times:
                shares = (first.path(time), second.path(time))
                if abs(shares[0] - shares[1]) > _SAME_SHARE * max(np.abs(shares)):
                    raise InputError(
                        f"support on '{second.on}': at time {time:g} its path gives "
                        f"{shares[1]:g}, but that of the support on '{first.on}', which moves a "
                        f"point of both as far, {shares[0]:g}"
                    )

    def at(self, time: float) -> Array:
        """Prescribed displacements of ``dofs`` at a pseudo-time (length)."""
        return self._first_to_hold(self.applied, time)

    def slopes(self, number: int, axis: AxisName, unit: Value, time: float) -> Array:
        """Slopes of the same in what a support of the scene prescribes; collective.

        Args:
            number: Of the support.
            axis: Along which.
            unit: Derivative of the displacement that the scene gives.
            time: The pseudo-time.
        """
        support, components = self.applied[number], self._spaces.components
        mine = support.dofs % components == AXES.index(axis)
        nodes = (support.dofs[mine] // components).astype(np.int32)
        values = np.zeros(len(support.dofs))
        values[mine] = self._spaces.evaluate(unit, nodes, f"support[{number}].displacement.{axis}")
        others = [replace(one, values=np.zeros(len(one.dofs))) for one in self.applied]
        others[number] = replace(support, values=values)
        return self._first_to_hold(others, time)

    def rotation_slopes(self, number: int, rotation: FaceRotation, time: float) -> Array:
        """Displacements of ``dofs`` that a support turns by a rotation alone (length).

        Args:
            number: Of the support.
            rotation: By which it turns what it holds.
            time: The pseudo-time.
        """
        support, components = self.applied[number], self._spaces.components
        nodes, axes = np.divmod(support.dofs, components)
        points, values = self._spaces.coordinates[nodes].T, np.zeros(len(nodes))
        for axis in np.unique(axes):
            mine = axes == axis
            values[mine] = rotation.displacement(AXES[int(axis)], points[:, mine])
        others = [replace(one, values=np.zeros(len(one.dofs))) for one in self.applied]
        others[number] = replace(support, values=values)
        return self._first_to_hold(others, time)

    def _first_to_hold(self, supports: Sequence[AppliedSupport], time: float) -> Array:
        """Displacements of ``dofs`` by supports: the first to hold a dof counts."""
        values = np.zeros(self.dofs.max(initial=-1) + 1)
        for support in reversed(supports):
            values[support.dofs] = support.values * support.path(time)
        return values[self.dofs]
