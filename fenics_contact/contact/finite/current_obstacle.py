"""A contact surface against a rigid obstacle, measured where the two stand at present.

Gap, normals and areas are those of current places. Slip is convected: it is the way of a point's
nearest place along the obstacle, in the obstacle's own coordinate, so that it does not depend on
how surface and obstacle have turned meanwhile. Of a point it counts from the begin of the load step
in which it touches.

Between two measurements the jump is linear, as laws of small strains take it: w = w₀ + u − u₀, with
w₀ = −g n + s t of the gap g, the outward normal n and the slip s along the tangent t where it was
measured last.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

import numpy as np
import ufl
from dolfinx.fem import Function

from fenics_contact.analytic.obstacle_shapes import Nearest, Sizes, turned
from fenics_contact.common.arrays import Array, Flags, in_3d
from fenics_contact.common.errors import InputError
from fenics_contact.contact.between_points import BetweenPoints
from fenics_contact.contact.kinematics import FacingObstacle
from fenics_contact.contact.mortar.facet_mesh import CLOSE, FacetSamples, lowest_points
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.contact.turning import Turning
from fenics_contact.results.contact_points import CURRENT_PLACE, PointArray
from fenics_contact.scene.obstacle import Obstacle

# Of a facet's side, between whose points it is looked for places in an obstacle.
_SAMPLES = 8


class CurrentObstacle(FacingObstacle):
    """The jump against a rigid obstacle in a plane model, about the last measured places.

    Args:
        trace: The contact points, which are nodes.
        obstacle: The scene's obstacle, of a shape whose nearest points are known.

    Attributes:
        places: Current places of the points, where they were measured last, (points, 2) (length).
        curvature: By which the obstacle's normal turns there as a point moves along it, (points,)
            (1/length).
        slip_rate: How fast slip grows there by the way of a point along the obstacle, (points,).
    """

    gap_left: ClassVar[float] = 1e-9
    state: ClassVar[tuple[PointArray, ...]] = (CURRENT_PLACE,)

    def __init__(self, trace: Trace, obstacle: Obstacle) -> None:
        super().__init__(trace)
        assert obstacle.kind is not None and obstacle.normal is not None
        self._shape = obstacle.kind
        normal = in_3d(obstacle.normal)
        normal = normal / np.linalg.norm(normal)
        self._sizes = Sizes(normal, obstacle.radius, 0.0)
        self._apex = in_3d(obstacle.position or (0.0,))[:2]
        given = normal if obstacle.direction is None else in_3d(obstacle.direction)
        self.direction = (given / np.linalg.norm(given))[:2]
        self.axis = self.direction
        self.turning = Turning.of(obstacle.turning)
        self._left_out = np.zeros(len(trace.weights), dtype=bool)
        self._origin = np.zeros_like(self.jump.x.array).reshape(-1, 2)
        self._meshed = trace.surface.coordinates[:, :2]
        self._first_arc = self._nearest(self._meshed).arc
        self._deformation: Function | None = None
        self.places, self.curvature = self._meshed[trace.numbers], np.zeros(len(trace.weights))
        self.slip_rate = np.ones(len(trace.weights))

    def _nearest(self, places: Array) -> Nearest:
        """Nearest points of the obstacle as it stands at present.

        They are found where the obstacle stood at first, to which places are moved and turned back.
        """
        centre, forth = self.turning.at[:2], _rotation(self.angle)
        before = centre + (places - self.translation - centre) @ forth
        found = self._shape.nearest(before - self._apex, self._sizes)
        return replace(found, normals=found.normals @ forth.T)

    def wrench(self, force: Array) -> Array:
        """Resultant of this rank's forces, and moment about the axis where it is now, (3,).

        Args:
            force: On the body at the contact's nodes, (nodes, 2) (force).
        """
        owned = self.trace.owned[: len(force)]
        arms = self.places[: len(force)] - self.turning.at[:2] - self.translation
        moments = arms[:, 0] * force[:, 1] - arms[:, 1] * force[:, 0]
        return np.append(force[owned].sum(axis=0), moments[owned].sum())

    def measure(self, displacement: Array, slip_before: Array) -> None:
        """Take gaps, normals, slips and areas at a displacement; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, 2) (length).
            slip_before: Near which slips are, along the tangents of the points, (points,): they
                are known but for whole turns around an obstacle that is closed (length).
        """
        moved = displacement[self.trace.all_nodes]
        places = self._meshed + moved
        found = self._nearest(places)
        normals = -found.normals
        slip = found.arc - self._first_arc
        period = self._shape.period(self._sizes)
        if np.isfinite(period):
            near = self.trace.at_all_nodes(slip_before)
            slip = slip - period * np.round((slip - near) / period)
        self.trace.turn(normals, np.zeros((0, 2)))
        jump = slip[:, None] * tangents(normals) - found.distance[:, None] * normals
        self._origin = moved - jump
        self._stretch(moved)
        self.places = places[self.trace.numbers]
        self.curvature = found.curvature[self.trace.numbers]
        self.slip_rate = found.rate[self.trace.numbers]
        self._measure(np.where(self._left_out, np.inf, 0.0))
        self.move(moved)

    def shown(self) -> dict[str, Array]:
        """Current places of the points (length)."""
        return {CURRENT_PLACE.name: self.places}

    def kept(self) -> dict[str, Array]:
        """Where slip of the points begins along the obstacle (length)."""
        return {"slip_origin": self._first_arc[self.trace.numbers]}

    def recall(self, at_points: Mapping[str, Array]) -> None:
        """Go back to where slip began."""
        self._first_arc = self.trace.at_all_nodes(at_points["slip_origin"])

    def begin_slip_again(self, points: Flags) -> bool:
        """Count slip of some points from where they are now: of those that do not touch.

        Args:
            points: Which, (points,).
        """
        normals = self.trace.normals
        slip = np.where(points, along(self.jump_at_points(), normals), 0.0)
        self._first_arc = self._first_arc + self.trace.at_all_nodes(slip)
        self._origin = self._origin + self.trace.at_all_nodes(slip[:, None] * tangents(normals))
        self._shift_jump(-self.trace.at_all_nodes(slip[:, None] * tangents(normals)))
        return True

    def _stretch(self, moved: Array) -> None:
        """Weigh each point by its current area; forms follow; collective.

        Args:
            moved: Displacement at all nodes of the surface, (nodes, 2) (length).
        """
        if self._deformation is None:
            mesh = self.trace.surface.mesh
            self._deformation = Function(self.trace.surface.space)
            jacobian = ufl.Jacobian(mesh)
            tangent = ufl.as_vector([jacobian[0, 0], jacobian[1, 0]])
            line = tangent / ufl.sqrt(ufl.dot(tangent, tangent))
            current = line + ufl.dot(ufl.grad(self._deformation), line)
            self.trace.stretch_by(ufl.sqrt(ufl.dot(current, current)))
        self._deformation.x.array[:] = moved.reshape(-1)
        self.trace.follow_stretch(moved)

    def move(self, relative: Array) -> None:
        """Set the jump, linear from where it was measured last.

        Args:
            relative: As found by ``relative``, (nodes, 2) (length).
        """
        self.jump.x.array[:] = (relative - self._origin).reshape(-1)
        self._at_points = None

    def _gap(self, points: Array, normals: Array) -> Array:
        """Distances of points from the obstacle, whatever the normals."""
        return self._nearest(points[:, :2]).distance

    def missed(self) -> Array:
        """Nothing: facets are measured where they are."""
        return np.zeros(len(self.trace.weights))

    def require_one_sided(self, key: str) -> None:
        """Any surface will do, also with edges: normals are those of the obstacle."""

    def between_points(self, displacement: Array) -> BetweenPoints:
        """Where facets are deepest in the obstacle now, between their points; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, 2) (length).
        """
        mesh, moved = self.facets, displacement[self.trace.all_nodes]

        def distance(samples: FacetSamples) -> Array:
            return self._nearest(samples.positions[:, :2] + samples.interpolate(moved)).distance

        idle = self.trace.at_all_nodes(self._left_out)[mesh.nodes].any(axis=1)
        found = lowest_points(mesh, np.where(idle, 0, _SAMPLES), distance, CLOSE)
        met = np.flatnonzero(np.isfinite(found.values))
        return BetweenPoints(
            depth=-found.values[met],
            places=in_3d(mesh.positions(met, found.reference[met])),
            facets=met,
            reference=found.reference[met],
            spacing=mesh.spacing[met],
        )

    def leave_out(self, points: Flags) -> None:
        """Take points out of the obstacle's reach."""
        self._left_out = points
        self._measure(np.where(points, np.inf, 0.0))

    def move_to_first_contact(self) -> None:
        """Refuse: obstacles are driven by displacements.

        Raises:
            InputError: Always.
        """
        raise InputError('obstacle.force: not with strains = "finite" yet; give an indentation')

    def displace(self, displacement: Array, angle: float = 0.0) -> None:
        """Move the obstacle; the jump follows when it is measured.

        Args:
            displacement: From where it stood at first, (2,) (length).
            angle: Which ``turn`` has taken already (radian).
        """
        self.displacement = displacement

    def stand(self) -> None:
        """Gaps follow when they are measured."""

    def touch(self) -> None:
        """No obstacle is driven by what touches it."""

    def update_pairing(self, displacement: Array | None) -> None:
        """An obstacle is measured where it stands."""


def _rotation(angle: float) -> Array:
    """Matrix that turns vectors counterclockwise, (2, 2)."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def tangents(normals: Array) -> Array:
    """Unit vectors along which slip counts, counterclockwise around the obstacle, (points, 2).

    Args:
        normals: Outward unit normals of the body, (points, 2).
    """
    return turned(-normals)


def along(vectors: Array, normals: Array) -> Array:
    """Components of vectors along the tangents of points, (points,)."""
    return np.asarray(np.einsum("ij,ij->i", vectors, tangents(normals)))


def carried_along(vectors: Array, before: Array, now: Array) -> Array:
    """Vectors along a surface, taken along with its tangents as it turns, (points, 2).

    Args:
        vectors: Along the tangents as they were.
        before: Outward unit normals of the body then, (points, 2).
        now: Those at present, likewise.
    """
    return along(vectors, before)[:, None] * tangents(now)
