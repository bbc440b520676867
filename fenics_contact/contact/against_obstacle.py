"""A contact surface against a rigid obstacle, or against nothing where the pressure is given."""

from __future__ import annotations

import numpy as np

from fenics_contact.analytic.complex_step import slope
from fenics_contact.common.arrays import Array, Flags, Integers, in_3d
from fenics_contact.common.errors import FenicsContactError, InputError
from fenics_contact.common.parallel import gather_rows, raise_together, smallest, total
from fenics_contact.contact.between_points import BetweenPoints, TooCoarseError
from fenics_contact.contact.kinematics import FacingObstacle
from fenics_contact.contact.mortar.facet_mesh import (
    CLOSE,
    CLOSEST,
    FacetSamples,
    PointFunction,
    lowest_points,
    normalised,
)
from fenics_contact.contact.rigid_obstacle import RigidObstacle
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.contact.turning import Turning
from fenics_contact.mesh.rigid_surface import load_surface
from fenics_contact.scene.obstacle import Obstacle

# Of the spacing of points: a place between them that is nearer by no more is none.
_AS_NEAR = 1e-9
# Cosine between the obstacle's way and a surface that it meets.
_AHEAD = 1e-9


class ObstacleKinematics(FacingObstacle):
    """The jump w = u − d m against a rigid obstacle, or w = u against nothing.

    Args:
        trace: The contact points.
        obstacle: The scene's obstacle; None where there is none.
        key: Where the scene describes it, for messages.

    Attributes:
        first_place: Where an obstacle under a force touched first, (1, 3) (length).
        first_normal: Of the surface there, (1, components).

    Raises:
        InputError: The obstacle does not fit the model, or misses the surface; of it,
            ``TooCoarseError``: it misses all points of the surface, but not the surface.
    """

    def __init__(self, trace: Trace, obstacle: Obstacle | None, key: str) -> None:
        super().__init__(trace)
        self._left_out = np.zeros(len(trace.weights), dtype=bool)
        self._has_shape = obstacle is not None and bool(obstacle.shape or obstacle.file)
        self._measured, self._size = self.gap, 0.0
        self._counts: Integers | None = None
        if obstacle is not None:
            self._place(obstacle, key)

    def _place(self, obstacle: Obstacle, key: str) -> None:
        trace, comm = self.trace, self._spaces.comm
        normals = gather_rows(comm, trace.normals[trace.owned])
        surface = None
        if obstacle.file is not None:
            surface = load_surface(obstacle.file, f"{key}.file", comm)
        kinematics = self._spaces.kinematics
        self._obstacle = RigidObstacle(obstacle, kinematics, normals, key, surface)
        self.turning = Turning.of(obstacle.turning)
        self.turning.require_symmetric(trace.symmetry.axes, f"{key}.rotation")
        self.direction = self._obstacle.direction
        if self._obstacle.has_axis:
            self.axis = self.direction
        error: FenicsContactError | None = None
        try:
            self._measured = self._gap(trace.coordinates, trace.normals)
        except InputError as caught:
            error = caught
        raise_together(comm, error)
        self._size = trace.surface.farthest() + self._obstacle.size
        self._finds_angle = obstacle.moment is not None
        self._follow_shape()
        self.stand()
        self._require_in_its_way(self.reached, key)

    def _require_in_its_way(self, points: Flags, key: str) -> None:
        """Refuse an obstacle before which no point lies: none of the surface, or of its mesh."""
        comm = self._spaces.comm
        if total(comm, points.sum()) > 0:
            return
        between = self._lowest(self._distance, CLOSEST)
        if total(comm, len(between.facets)) > 0:
            raise TooCoarseError(key, self.trace, between)
        raise InputError(
            f"{key}: no point of the surface lies in its way; see its position, normal and "
            "direction"
        )

    def require_one_sided(self, key: str) -> None:
        """Refuse an obstacle that is driven away from the surface, and a sharp edge in that."""
        if self.direction.any():
            self._require_in_its_way(self.reached & (self.facing > 0), f"{key}.obstacle")
        super().require_one_sided(key)

    def leave_out(self, points: Flags) -> None:
        """Take points out of the obstacle's reach."""
        self._left_out = points
        self._measured = np.where(points, np.inf, self._measured)
        self.stand()

    def whole_gap(self) -> Array:
        """The gap as the obstacle stands, also at points left out of its reach (length)."""
        return self._whole() - self.interference + self.worn

    def _whole(self) -> Array:
        gap = self._gap(self.trace.coordinates, self.trace.normals)
        return gap - self.brought_up * self.facing

    def _gap(self, points: Array, normals: Array) -> Array:
        return self._gap_to(self._obstacle, self._shape_motion, points, normals)

    @property
    def _shape_motion(self) -> Array:
        """Displacement of the shape, and its angle, (components + 1,) (length, radian)."""
        return np.append(self.displacement, self.shape_angle)

    def _gap_to(
        self, obstacle: RigidObstacle, motion: Array, points: Array, normals: Array
    ) -> Array:
        """Gap to an obstacle that has moved aside, and turned, (points,) (length).

        A point that a ray meets at a distance s has moved by θ a × (x + s n − at): to the obstacle
        as it stood at first the ray begins aside of x, and is turned the other way.
        """
        size, angle = normals.shape[1], motion[-1]
        if not motion.any():
            return obstacle.gap(points, normals, self._spaces.position)
        moved = motion[:-1] + angle * self.turning.field(points, size)
        aside = moved - np.einsum("ij,ij->i", normals, moved)[:, None] * normals
        places = points.astype(aside.dtype)
        places[:, :size] -= aside
        rays = normals - angle * self.turning.across(normals, size)
        return obstacle.gap(places, rays, self._spaces.position)

    def gap_slopes(self, name: str, axis: int) -> Array:
        """Slopes of the gap in a number of the obstacle, by a complex step, (points,).

        Args:
            name: ``radius``, ``position``, or a direction.
            axis: Of all but the first.
        """
        obstacle, points = self._obstacle, (self.trace.coordinates, self.trace.normals)

        def gap(value: complex) -> Array:
            changed = obstacle.with_number(name, axis, value)
            return self._gap_to(changed, self._shape_motion, *points)

        return np.where(self._left_out, 0.0, slope(gap, obstacle.number(name, axis)))

    def gap_slopes_of_motion(self, axis: int) -> Array:
        """Slopes of the gap at the points in a component of the obstacle's motion, (points,).

        Args:
            axis: Of the displacement; behind these comes the angle.
        """

        def gap(value: complex) -> Array:
            motion = self._shape_motion.astype(complex)
            motion[axis] = value
            points = self.trace.coordinates, self.trace.normals
            return self._gap_to(self._obstacle, motion, *points)

        return np.where(self._left_out, 0.0, slope(gap, self._shape_motion[axis]))

    def direction_slopes(self, name: str, axis: int) -> Array:
        """Slopes of ``direction`` in a component of what the scene gives, (components,).

        Args:
            name: Of a direction of the obstacle.
            axis: The component.
        """
        obstacle = self._obstacle

        def direction(value: complex) -> Array:
            return obstacle.with_number(name, axis, value).direction

        return slope(direction, obstacle.number(name, axis))

    def keeps_right_angle(self, name: str, axis: int) -> bool:
        """Whether the lines of a cylinder stay at a right angle to the normal as one turns."""
        return self._obstacle.keeps_right_angle(name, axis)

    def first_gap_slope(self, name: str, axis: int) -> float:
        """Derivative of the gap where it touched first, before it moved, as ``gap_slopes``."""
        position = self._spaces.position

        def gap(value: complex) -> Array:
            obstacle = self._obstacle.with_number(name, axis, value)
            return obstacle.gap(self.first_place, self.first_normal, position)

        return float(slope(gap, self._obstacle.number(name, axis))[0])

    def brought_up_slope(self, of_gap: float) -> float:
        """Further way of the obstacle to first contact, of a gap that changes where it touched."""
        return of_gap / float(-self.first_normal[0] @ self.direction)

    def depths_of_slid(self, distance: float) -> Array:
        """How deep points that slid farther than a distance are in an obstacle with a shape.

        Where they are now, along the normals of the undeformed surface; −∞ where it is not before
        them (length).
        """
        if not self._has_shape:
            return np.zeros(0)
        jump = self.jump_at_points() + self.trace.at_points(self.beyond_shape)
        jump = jump - self.brought_up * self.direction
        aside = self.tangential(jump)
        slid = (np.linalg.norm(aside, axis=1) > distance) & ~self._left_out
        moved, normals = self.trace.coordinates[slid], self.trace.normals[slid]
        moved[:, : normals.shape[1]] += aside[slid]
        gap = self._obstacle.gap(moved, normals, self._spaces.position)
        return np.asarray(self.normal(jump)[slid] - gap)

    def displace(self, displacement: Array, angle: float = 0.0) -> None:
        """Move the obstacle, and the gap to its shape with it.

        The part along a normal closes the gap through the jump; the gap itself is that of
        the obstacle moved by the part along the surface, and turned.
        """
        if not np.array_equal(np.append(displacement, angle), self._shape_motion):
            before = self.beyond_shape
            self.displacement, self.shape_angle = displacement, angle
            self._measured = np.where(self._left_out, np.inf, self._whole())
            self._follow_shape()
            # What was in the jump is in the gap now: points are as deep as they were.
            self._shift_jump(before - self.beyond_shape)
        self.stand()

    def _follow_shape(self) -> None:
        """Take the slopes of the gap in an angle that is found, where the shape is measured."""
        if self._finds_angle:
            slopes = np.where(np.isfinite(self._measured), self.gap_slopes_of_motion(-1), 0.0)
            normals = self.trace.normals_at_nodes
            self.shape_field = self.trace.at_every_node(slopes)[:, None] * normals

    def stand(self) -> None:
        """Take the gap of the obstacle as it stands now, after it was driven or moved."""
        self._measure(self.without_round_off(self._measured, self._size))

    def move_to_first_contact(self) -> None:
        """Take the obstacle to where it first touches the undeformed surface; collective.

        That may be between the points: an apex smaller than the cells meets no node first.
        """
        comm, ahead = self._spaces.comm, self._ahead
        at_points, lowest = self.first_distances()
        rows = [self.trace.coordinates[ahead], self.trace.normals[ahead]]
        found = FacetSamples(self.facets, lowest.facets, lowest.reference[:, None])
        normals = normalised(found.interpolate(self.facets.normals))
        # One that is as near as a point, as under a flat punch, is no nearer.
        between = -lowest.depth + _AS_NEAR * lowest.spacing
        rows = [np.concatenate(parts) for parts in zip(rows, (lowest.places, normals), strict=True)]
        table = np.column_stack([np.concatenate([at_points, between]), *rows])
        nearest = gather_rows(comm, table[np.argsort(table[:, 0], kind="stable")[:1]])
        first = nearest[np.argmin(nearest[:, 0])]
        self.first_place, self.first_normal = first[None, 1:4], first[None, 4:]
        self.brought_up = float(first[0])
        self._measured = self._measured - self.brought_up * self.facing
        self.stand()

    @property
    def _ahead(self) -> Flags:
        return np.asarray(self.reached & (self.facing > 0))

    def first_distances(self) -> tuple[Array, BetweenPoints]:
        """How far it is to the points before it, along its own way, and to places between these.

        As it stands before it is driven; depths of the latter are these distances, negative.
        """
        lowest = self._lowest(self._distance, CLOSEST)
        return self.gap[self._ahead] / self.facing[self._ahead], lowest

    def _distance(self, samples: FacetSamples) -> Array:
        """How far the obstacle is from places on facets, along its own way (length)."""
        normals = normalised(samples.interpolate(self.facets.normals))
        facing = -(normals @ self.direction)
        ahead = facing > _AHEAD
        gap = self._gap(samples.positions, normals)
        gap -= self.interference + self.brought_up * facing
        return np.where(ahead, gap / np.where(ahead, facing, 1.0), np.inf)

    def between_points(self, displacement: Array) -> BetweenPoints:
        """Where facets are deepest in the obstacle, between their points."""
        mesh, jump = self.facets, displacement[self.trace.all_nodes] - self.motion_at_nodes
        worn = self.trace.at_all_nodes(self.worn[: len(self.trace.nodes)])[:, None]
        nodal, size = np.hstack([mesh.normals, jump, worn]), mesh.dimension

        def present_gap(samples: FacetSamples) -> Array:
            found = samples.interpolate(nodal)
            normals = normalised(found[:, :size])
            gap = self._gap(samples.positions, normals) + found[:, 2 * size] - self.interference
            # The way that brought the obstacle up to the surface closes the gap as the jump does.
            closing = found[:, size : 2 * size] - self.brought_up * self.direction
            return np.asarray(gap - np.einsum("ij,ij->i", closing, normals))

        return self._lowest(present_gap, CLOSE)

    def _lowest(self, gap: PointFunction, closest: float) -> BetweenPoints:
        """Where a gap is narrowest on each facet before the obstacle."""
        mesh = self.facets
        if self._counts is None:
            normals = normalised(mesh.normals_at_centres())
            self._counts = self._obstacle.samples(in_3d(mesh.centres), mesh.radii, normals)
        idle = self.trace.at_all_nodes(self._left_out[: len(self.trace.nodes)])
        counts = np.where(idle[mesh.nodes].any(axis=1), 0, self._counts)
        found = lowest_points(mesh, counts, gap, closest)
        met = np.flatnonzero(np.isfinite(found.values))
        return BetweenPoints(
            depth=-found.values[met] - mesh.sagittas[met],
            places=in_3d(mesh.positions(met, found.reference[met])),
            facets=met,
            reference=found.reference[met],
            spacing=self.facets.spacing[met],
        )

    def touch(self) -> None:
        """Drive the obstacle until it just touches the body; collective."""
        ahead = self.reached & (self.facing > 0)
        normal = self.normal(self.jump_at_points())
        distance = (self.gap - normal)[ahead] / self.facing[ahead]
        nearest = smallest(self._spaces.comm, distance)
        jump = self.jump.x.array.reshape(-1, self._spaces.components)
        relative = jump + self.motion_at_nodes
        self.drive(self.indentation + nearest)
        self.move(relative)

    def update_pairing(self, displacement: Array | None) -> None:
        """An obstacle is measured where it stands, whatever the body does."""
