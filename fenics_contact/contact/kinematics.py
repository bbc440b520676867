"""Contact kinematics: the jump across a contact, its gap and slip.

What stands opposite is known here and in the modules that complete it, for a rigid obstacle and
for a second deformable body, and nowhere else.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np
from dolfinx import fem

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import largest, smallest
from fenics_contact.contact.between_points import BetweenPoints, missed_by_facets, require_smooth
from fenics_contact.contact.mortar.facet_mesh import FacetMesh
from fenics_contact.contact.mortar.pairing import Pairing, own_facets
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.contact.turning import Turning
from fenics_contact.results.contact_points import PointArray

# Of the lengths that a gap is a difference of: an overlap of no more is round-off.
ROUND_OFF = 32 * float(np.finfo(float).eps)
# Of an obstacle's motion: what rounding may leave between it and the gap that it has closed.
_HAIR = 8 * float(np.finfo(float).eps)


class ContactKinematics(ABC):
    """The jump w of a surface: its displacement relative to what stands opposite.

    Attributes:
        trace: The contact points.
        jump: w, a dolfinx function that energies see.
        gap: At the points, before anything moves; infinite where nothing stands (length).
        interference: By how much it is narrower than as drawn (length).
        worn: By how much wear has widened it, at the points (length).
        direction: Unit vector m along which an obstacle is driven, (components,); 0 without.
        indentation: How far d the obstacle is driven at present, from where it has been
            brought up to (length).
        brought_up: How far it was brought up to the surface beforehand, under a force: so
            that depths are no differences of long distances (length).
        displacement: How far it has moved besides, (components,) (length).
        turning: The axis about which an obstacle turns.
        angle: By how much it has turned at present (radian).
        shape_angle: The angle at which the gap to its shape is measured; 0 where a moment turns
            it (radian).
        shape_field: By how much the gap to its shape widens as the obstacle turns beyond that
            angle, along the normals at all nodes, (nodes, components) (length over radian).
        gap_left: What is left of gaps of closed points, of the lengths they are differences of.
        faces_body: Whether a deformable surface stands opposite, not a rigid obstacle.
        pairing: The deformable body opposite, None against an obstacle.
        axis: The obstacle's own, ``direction``; None where it has none but the surface's.
        state: Arrays at the points that results have besides those of laws.
        paired_at: Displacement at which it was found what faces what, at the body's nodes of
            this rank; None as meshed (length).
    """

    faces_body: ClassVar[bool] = False
    gap_left: ClassVar[float] = 1e-12
    state: ClassVar[tuple[PointArray, ...]] = ()
    pairing: Pairing | None = None
    axis: Array | None = None
    paired_at: Array | None = None

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self._spaces = trace.spaces
        self.jump = fem.Function(trace.surface.space)
        self.indentation = 0.0
        self.brought_up = 0.0
        self.displacement = np.zeros(self._spaces.components)
        self.direction = np.zeros(self._spaces.components)
        self.turning = Turning.of(None)
        self.angle = self.shape_angle = 0.0
        self.shape_field = np.zeros((len(trace.all_nodes), self._spaces.components))
        self.gap = self._drawn = np.zeros(len(trace.weights))
        self.interference, self.worn = 0.0, np.zeros(len(trace.weights))
        self._places = trace.coordinates
        self._at_points: Array | None = None
        self._jumps_of_body: Array | None = None

    def jumps_of_body(self, motions: Callable[[], Array]) -> Array:
        """Jumps at the points in the rigid motions of the body's parts; collective.

        Found once for what faces what.

        Args:
            motions: Gives them at the body's nodes of this rank, (nodes, components, motions)
                (length).

        Returns:
            (points, components, motions) (length).
        """
        if self._jumps_of_body is None:
            self._jumps_of_body = self.trace.at_points(self.relative(motions()))
        return self._jumps_of_body

    @abstractmethod
    def relative(self, displacement: Array) -> Array:
        """Displacement relative to a body opposite, at all nodes of the surface; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components, ...) (length).
        """

    def relative_or_own(self, displacement: Array) -> Array:
        """``relative``, or the surface's own displacement where it faces nothing; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components) (length).
        """
        return self.relative(displacement)

    @abstractmethod
    def on_body(self, force: Array) -> Array:
        """Forces at all nodes of the surface, and what they do opposite, at the body's nodes.

        Collective.

        Args:
            force: (nodes of the surface, components) (force).
        """

    @abstractmethod
    def reaches(self, flags: Flags) -> Flags:
        """The body's nodes that forces on some nodes of the surface reach; collective."""

    @abstractmethod
    def _gap(self, points: Array, normals: Array) -> Array:
        """Gap from points (points, 3) along normals (points, components)."""

    def missed(self) -> Array:
        """Excess of the gaps by what facets miss of curved surfaces; collective.

        At the points, < 0 where they are too narrow (length).
        """
        return missed_by_facets(self.trace)

    def require_one_sided(self, key: str) -> None:
        """Refuse a surface with a sharp edge.

        Raises:
            InputError: On every rank.
        """
        require_smooth(self.trace, f"{key}.on")

    @abstractmethod
    def between_points(self, displacement: Array) -> BetweenPoints:
        """Where facets are deepest in what stands opposite, between their points; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components) (length).
        """

    @abstractmethod
    def leave_out(self, points: Flags) -> None:
        """Take points out of an obstacle's reach."""

    @abstractmethod
    def move_to_first_contact(self) -> None:
        """Take an obstacle to where it first touches the undeformed surface; collective."""

    @abstractmethod
    def displace(self, displacement: Array, angle: float = 0.0) -> None:
        """Move an obstacle, and the gap to its shape with it.

        Args:
            displacement: From where it stood at first, (components,) (length).
            angle: That it has turned by since (radian).
        """

    @abstractmethod
    def stand(self) -> None:
        """Take the gap of an obstacle as it stands now, after it was driven or moved."""

    @abstractmethod
    def touch(self) -> None:
        """Drive an obstacle until it just touches the body; collective."""

    @abstractmethod
    def update_pairing(self, displacement: Array | None) -> None:
        """Find what faces what on the displaced bodies; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components); None as meshed
                (length).
        """

    def overlap_by(self, interference: float, worn: Array) -> None:
        """Narrow the gap of the meshes by an interference along the normals, and widen it by wear.

        Args:
            interference: The overlap, < 0 a gap (length).
            worn: At the points, (points,) (length).
        """
        self.interference, self.worn = interference, worn
        self.gap = self._drawn - interference + worn

    def set_gap(self, gap: Array) -> None:
        """Take a gap at the points as it is given (length)."""
        self.gap = gap

    def _measure(self, drawn: Array) -> None:
        """Take a gap that was found from where the two sides stand."""
        self._drawn = drawn
        self.overlap_by(self.interference, self.worn)

    def shown(self) -> dict[str, Array]:
        """Arrays of ``state`` at the points at present, by name."""
        return {}

    def kept(self) -> dict[str, Array]:
        """Arrays at the points that a later load step needs, by name; mostly none."""
        return {}

    def recall(self, at_points: Mapping[str, Array]) -> None:  # noqa: B027  (most keep nothing)
        """Go back to arrays that ``kept`` gave, others among them."""

    def begin_slip_again(self, points: Flags) -> bool:
        """Count slip of some points from where they are now; whether it can be: mostly not.

        Args:
            points: Which, (points,).
        """
        return False

    def relative_sliding(self, closed: Flags) -> float:
        """Slip since it was found what faces what, over the size of the contact; collective.

        Args:
            closed: Which points are in contact.
        """
        return 0.0

    @cached_property
    def facets(self) -> FacetMesh:
        """This rank's facets of the surface, as meshed."""
        return own_facets(self.trace)

    @property
    def sagitta(self) -> float:
        """How far the facets of two bodies are from smooth surfaces, about (length)."""
        return 0.0

    @property
    def facet_turn(self) -> float:
        """Angle between the surface's facets and its averaged normals, about (radians)."""
        return self.trace.averaged.turn

    @property
    def distance_as_drawn(self) -> Array:
        """At the points, from one side to the other, without interference and wear (length)."""
        return self._drawn

    @property
    def pressing_interference(self) -> float:
        """The interference beyond the gap that the meshes leave open everywhere; collective.

        No force acts on the way through that gap, so the interference does no work there (length).
        """
        if self.interference <= 0:
            return self.interference
        drawn = self.distance_as_drawn[self.trace.owned & self.reached]
        free = smallest(self.trace.surface.comm, drawn)
        return self.interference - float(np.clip(free, 0.0, self.interference))

    def whole_gap(self) -> Array:
        """The gap as an obstacle stands, also at points left out of its reach (length)."""
        return self.gap

    def depths_of_slid(self, distance: float) -> Array:
        """How deep points that slid farther than a distance are in an obstacle with a shape.

        Where they are now, along the normals of the undeformed surface; −∞ where it is not before
        them (length).
        """
        return np.zeros(0)

    @property
    def reached(self) -> Flags:
        """Flags of points that have something opposite, (points,)."""
        return np.isfinite(self.gap)

    @property
    def facing(self) -> Array:
        """How squarely the obstacle is driven onto each point, −m·n."""
        return np.asarray(-self.trace.normals @ self.direction)

    def begin_again(self) -> None:
        """Stand as at first, before anything moved; bodies are paired as they were then."""
        self.drive(0.0)
        self.turn_back(0.0, 0.0)
        if self.displacement.any():
            self.displace(np.zeros_like(self.displacement))
        self.overlap_by(0.0, np.zeros_like(self.worn))
        self.stand()
        self.move(self.motion_at_nodes)

    def turn(self, angle: float) -> None:
        """Turn the obstacle, but not the gap to its shape; the jump follows with ``move``.

        Args:
            angle: From how it stood at first (radian).
        """
        self.angle = angle

    def turn_back(self, angle: float, shape_angle: float) -> None:
        """Take an obstacle back to how it had turned at the end of a load step.

        Args:
            angle: That of the obstacle (radian).
            shape_angle: That at which the gap to its shape was measured (radian).
        """
        self.angle = angle
        if shape_angle != self.shape_angle:
            self.displace(self.displacement, shape_angle)

    def drive(self, indentation: float) -> None:
        """Bring the obstacle in by a depth; the jump follows with the next ``move``.

        Args:
            indentation: How far it is driven (length).
        """
        self.indentation = indentation

    def move(self, relative: Array) -> None:
        """Set the jump.

        Args:
            relative: As found by ``relative``, (nodes, components) (length).
        """
        jump = relative - self.motion_at_nodes
        self.jump.x.array[:] = jump.reshape(-1)
        self._at_points = None

    def _shift_jump(self, by: Array) -> None:
        """Add to the jump, at all nodes, (nodes, components) (length)."""
        self.jump.x.array[:] += by.reshape(-1)
        self._at_points = None

    def jump_at_points(self) -> Array:
        """The present jump, (points, components), the same array until it moves (length)."""
        if self._at_points is None:
            jump = self.jump.x.array.reshape(-1, self._spaces.components)
            self._at_points = self.trace.at_points(jump)
            self._at_points.setflags(write=False)
        return self._at_points

    def normal(self, vectors: Array) -> Array:
        """Normal part of vectors given at the contact points, or at their nodes."""
        return np.asarray(np.einsum("ij,ij->i", vectors, self.trace.normals[: len(vectors)]))

    def tangential(self, vectors: Array) -> Array:
        """Tangential part of vectors given at the contact points, or at their nodes."""
        normals = self.trace.normals[: len(vectors)]
        return vectors - self.normal(vectors)[:, None] * normals

    @property
    def translation(self) -> Array:
        """How far what stands opposite has moved by itself, (components,) (length)."""
        return self.indentation * self.direction + self.displacement

    @property
    def motion(self) -> Array:
        """Displacement of the obstacle, then its angle, (components + 1,) (length, radian)."""
        return np.append(self.translation, self.angle)

    def field(self, motion: Array) -> Array:
        """How far a motion takes points of the obstacle at the contact points (length).

        Args:
            motion: A translation and an angle, (components + 1,) (length, radian).

        Returns:
            Shape (points, components).
        """
        return np.asarray(motion[:-1] + motion[-1] * self._turned_by_unit)

    @property
    def motion_at_points(self) -> Array:
        """How far the obstacle has moved at the contact points, (points, components) (length)."""
        found = self.field(self.motion)
        if self.angle == self.shape_angle:
            return found
        return found + self.trace.at_points(self.beyond_shape)

    @property
    def motion_at_nodes(self) -> Array:
        """Displacement of the obstacle at the surface's nodes, (nodes, components) (length)."""
        return np.asarray(self.translation + self.angle * self.turned_nodes + self.beyond_shape)

    @property
    def beyond_shape(self) -> Array:
        """What the gap to the shape misses of the present angle, as a motion at all nodes (length).

        In the jump it is a widening of the gap, to first order in the angle.
        """
        return (self.angle - self.shape_angle) * self.shape_field

    @property
    def present_gap(self) -> Array:
        """The gap with that, before the body moves, (points,) (length)."""
        return self.gap + self.normal(self.trace.at_points(self.beyond_shape))

    @cached_property
    def _turned_by_unit(self) -> Array:
        """How far a unit angle moves an obstacle's points, (points, components) (length)."""
        return self.turning.field(self.trace.coordinates, self._spaces.components)

    @cached_property
    def turned_nodes(self) -> Array:
        """The same at all nodes of the surface, (nodes, components) (length)."""
        return self.turning.field(self.trace.surface.coordinates, self._spaces.components)

    @cached_property
    def lever(self) -> float:
        """Largest distance of the surface's nodes from the axis of turning (length); collective."""
        return largest(self._spaces.comm, np.linalg.norm(self.turned_nodes, axis=1))

    def wrench(self, force: Array) -> Array:
        """Resultant of this rank's forces, and moment about the axis, (components + 1,).

        Args:
            force: On the body at the contact's nodes, (nodes, components) (force).
        """
        owned = self.trace.owned[: len(force)]
        turned = self._turned_by_unit[: len(force)]
        moment = np.sum(force[owned] * turned[owned])
        return np.append(force[owned].sum(axis=0), moment)

    def without_round_off(self, gap: Array, size: float) -> Array:
        """Gaps of which an overlap that is round-off is none: bodies as drawn just touch there.

        Else such overlaps, of 1e-16 between turned blocks, would press, each as luck will have it.

        Args:
            gap: At the points, before anything moves (length).
            size: Largest of the lengths that it is a difference of, but for ``motion`` (length).
        """
        motion = self.motion_at_points
        moved = np.linalg.norm(motion, axis=1)
        across = self.normal(motion)
        overlap = -across - gap
        touches = (overlap > 0) & (overlap <= ROUND_OFF * (size + moved))
        return np.where(touches, _HAIR * moved - across, gap)

    def end_of_obstacle(self, reached: Integers, beyond: Integers) -> Array:
        """How far what stands opposite goes, from points before it to others beyond it (0 … 1)."""
        starts, ends = self._places[reached], self._places[beyond]
        normals = self.trace.normals[reached]
        # Mostly it goes all the way, and the point beyond is only open.
        found = np.where(np.isfinite(self._gap(ends, normals)), 1.0, 0.0)
        cut = np.flatnonzero(found == 0.0)
        starts, ends, normals = starts[cut], ends[cut], normals[cut]
        low, high = np.zeros(len(cut)), np.ones(len(cut))
        for _ in range(40 if len(cut) else 0):
            middle = 0.5 * (low + high)
            points = starts + middle[:, None] * (ends - starts)
            inside = np.isfinite(self._gap(points, normals))
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        found[cut] = low
        return found


class FacingObstacle(ContactKinematics):
    """The jump of a surface that faces no body: its displacement, and forces on its own nodes."""

    def relative(self, displacement: Array) -> Array:
        """Displacement at all nodes of the surface: the obstacle's own is no unknown here."""
        return displacement[self.trace.all_nodes]

    def on_body(self, force: Array) -> Array:
        """Forces at the nodes of the surface, at the body's nodes; collective."""
        return self.trace.surface.on_body(force)

    def reaches(self, flags: Flags) -> Flags:
        """The body's nodes that forces on some nodes of the surface reach; collective."""
        return self.trace.surface.on_body(flags.astype(np.float64)) > 0
