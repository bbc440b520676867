"""Rigid obstacles: the gap from a point of the body to them, along a given direction.

The gap is that of linear kinematics: it is measured once, along the outward normal of
the undeformed surface. Points whose normal misses the obstacle have an infinite gap.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.analytic import obstacle_shapes
from fenics_contact.analytic.obstacle_shapes import Sizes
from fenics_contact.common.arrays import Array, Integers, in_3d
from fenics_contact.common.errors import InputError
from fenics_contact.contact.facet_obstacle import FacetObstacle
from fenics_contact.mesh.rigid_surface import RigidSurface
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.values import Kinematics, Profile

# Directions that a scene gives, as lists.
DIRECTIONS = ("normal", "along", "direction")
# Normals that all point one way to this accuracy are those of a flat surface.
_FLAT = 1e-6
# Samples along the side of a facet, and over the width of what is to be seen between its nodes.
_FEWEST, _MOST, _PER_WIDTH = 4, 48, 2.5


class RigidObstacle:
    """A rigid obstacle as the scene describes it.

    Attributes:
        direction: Unit vector along which it is driven, towards the body, (components,).
        has_axis: Whether the scene says which way it faces; else it faces the surface, as a wall
            all around a body does.

    Args:
        obstacle: The scene's description.
        kinematics: That of the model.
        surface_normals: Outward unit normals of the contact surface, at all of its points
            on all ranks, shape (points, components); they give the default orientation.
        key: Where the scene describes it, for messages.
        surface: Of the file that it is from; None of others.

    Raises:
        InputError: The shape does not fit the kinematics, or a direction is missing.
    """

    def __init__(
        self,
        obstacle: Obstacle,
        kinematics: Kinematics,
        surface_normals: Array,
        key: str,
        surface: RigidSurface | None = None,
    ) -> None:
        self._obstacle = obstacle
        self._facets = None if surface is None else FacetObstacle(surface)
        self._shape = self._facets or obstacle.kind
        self._kinematics = kinematics
        self._key = key
        self._require_shape()
        says = (self._shape, obstacle.normal, obstacle.direction)
        self.has_axis = any(key is not None for key in says)
        given = _unit(obstacle.normal)
        self._normal: Array = self._facing(surface_normals) if given is None else given
        self._along = _unit(obstacle.along)
        if self._along is not None and abs(self._along @ self._normal) > _FLAT:
            raise InputError(f"{key}.along: must be at a right angle to the normal")
        self._apex = in_3d(obstacle.position or (0.0,))
        self._radius = obstacle.radius
        direction = _unit(obstacle.direction)
        direction = self._normal if direction is None else direction
        self.direction: Array = direction[: surface_normals.shape[1]]
        self._require_axis()

    @property
    def size(self) -> float:
        """Largest of the lengths by which gaps to it are found (length).

        Its radius is none: however large, gaps are as right as those to a plane.
        """
        facets = self._facets
        own = 0.0 if facets is None else float(np.linalg.norm(facets.middle)) + facets.radius
        return float(np.linalg.norm(self._apex)) + own

    def number(self, name: str, axis: int) -> float:
        """Number of the obstacle: radius or coordinate of its position (length), or a direction."""
        if name in DIRECTIONS:
            return float(getattr(self._obstacle, name)[axis])
        return float(self._radius or 0.0) if name == "radius" else float(self._apex[axis])

    def with_number(self, name: str, axis: int, value: complex) -> RigidObstacle:
        """The obstacle with another number, which may be complex: for slopes of the gap.

        Args:
            name: ``radius``, ``position``, or one of ``DIRECTIONS``.
            axis: Of the latter.
            value: Of the number (length, or of a direction).
        """
        found = copy.copy(self)
        found._take_number(name, axis, value)
        return found

    def _take_number(self, name: str, axis: int, value: complex) -> None:
        """Have another number; the arguments are those of ``with_number``."""
        if name in DIRECTIONS:
            components, given = len(self.direction), list(getattr(self._obstacle, name))
            given[axis] = value
            turned: Any = _unit(given)
            setattr(self, "direction" if name == "direction" else f"_{name}", turned)
            if name == "normal" and self._obstacle.direction is None:
                self.direction = turned
            self.direction = self.direction[:components]
        elif name == "radius":
            self._radius = value  # type: ignore[assignment]
        else:
            self._apex = self._apex.astype(complex)
            self._apex[axis] = value

    def keeps_right_angle(self, name: str, axis: int) -> bool:
        """Whether lines along it stay at a right angle to its normal as one of both turns.

        Args:
            name: ``normal`` or ``along``.
            axis: Component that changes.
        """
        other = {"normal": self._along, "along": self._normal}.get(name)
        return other is None or abs(float(other[axis])) < _FLAT

    def samples(self, centres: Array, radii: Array, normals: Array) -> Integers:
        """How closely facets are to be looked at, to see where it comes nearest to them.

        Args:
            centres: Of the facets, (facets, 3) (length).
            radii: Of spheres about these that hold them, (facets,) (length).
            normals: Outward unit normals there, (facets, components).

        Returns:
            Samples along a facet's side, (facets,): none where it is flat or not before the facet.
        """
        obstacle, shape = self._obstacle, self._shape
        if self._facets is not None:
            may_meet = self._facets.is_before(centres - self._apex, radii, in_3d(normals))
            return np.where(may_meet, _counts(radii, np.inf), 0)
        if isinstance(obstacle.gap, Profile):
            spacing = float(np.diff(obstacle.gap.at).min())
            return _counts(radii, spacing)
        if callable(obstacle.gap) or (shape is not None and shape.is_endless):
            return _counts(radii, np.inf)
        radius = obstacle.radius
        if shape is None or radius is None:
            return np.zeros(len(radii), dtype=np.int64)
        away = centres - (self._apex - radius * self._normal if shape.is_round else self._apex)
        rays = np.zeros_like(away)
        rays[:, : normals.shape[1]] = normals
        if self._along is not None:
            away = away - np.outer(away @ self._along, self._along)
        aside = away - np.einsum("ij,ij->i", away, rays)[:, None] * rays
        near = np.linalg.norm(aside, axis=1) <= radius + 2 * radii
        width = radius - (obstacle.inner_radius or 0.0)
        return np.where(near, _counts(radii, width), 0)

    def gap(self, points: Array, normals: Array, position: Expr) -> Array:
        """Gap s along the normals, before the obstacle is driven, shape (points,) (length).

        Args:
            points: Of the undeformed surface, shape (points, 3) (length).
            normals: Outward unit normals there, shape (points, components); or rays of another
                length, in whose lengths the gaps then are.
            position: x in UFL, for gaps given as functions of it.

        Raises:
            InputError: The user's function fails.
        """
        obstacle = self._obstacle
        if isinstance(obstacle.gap, Profile):
            return obstacle.gap(points.T)
        if callable(obstacle.gap):
            return self._gap_function(obstacle.gap, points, position)
        shape = self._shape
        if shape is None:
            return np.full(len(points), float(obstacle.gap or 0.0))
        rays = np.zeros((len(points), 3), normals.dtype)
        rays[:, : normals.shape[1]] = normals
        offsets = points - self._apex
        if self._along is not None:  # nothing changes along the lines of a cylinder
            across = np.eye(3) - np.outer(self._along, self._along)
            offsets, rays = offsets @ across, rays @ across
        sizes = Sizes(self._normal, self._radius, obstacle.inner_radius or 0.0)
        return shape.gaps(offsets, rays, sizes)

    def _gap_function(
        self, function: Callable[[Expr], Expr], points: Array, position: Expr
    ) -> Array:
        """Values of a user's UFL expression in x, point by point."""
        try:
            expression = ufl.as_ufl(function(position))
            values = [float(expression(tuple(point))) for point in points]
        except Exception as caught:  # whatever a user's function raises
            said = " ".join(str(caught).split())
            raise InputError(
                f"{self._key}.gap: its function fails: {type(caught).__name__}: {said}; it takes "
                "x and returns a UFL expression (ufl.sqrt, not numpy's)"
            ) from None
        if np.isnan(values).any():
            raise InputError(f"{self._key}.gap: its function gives values that are not a number")
        return np.array(values, dtype=np.float64)

    def _require_shape(self) -> None:
        shape, kinematics = self._shape, self._kinematics
        if shape is None:
            return
        if self._facets is not None and kinematics != "3D":
            raise InputError(f"{self._key}.file: is for 3D models, not for {kinematics}")
        if kinematics not in shape.models:
            accepted = obstacle_shapes.names_in(kinematics)
            raise InputError(
                f"{self._key}.shape = '{shape.name}': a {kinematics} model has "
                f"{', '.join(accepted)}"
            )
        lines = shape.has_lines and kinematics == "3D"
        if lines != (self._obstacle.along is not None):
            raise InputError(
                f"{self._key}.along: needed for a parabola or cylinder in 3D, and only there"
            )

    def _require_axis(self) -> None:
        """In an axisymmetric model the obstacle stands on the axis, and moves along it.

        One without a shape that nothing drives, as the wall of a bore, may face any way.
        """
        if self._kinematics != "axisymmetric":
            return
        if self._apex[0] != 0:
            raise InputError(f"{self._key}.position: must lie on the axis, x = 0")
        tilted = self._shape is not None and abs(self._normal[0]) > _FLAT
        moved = (self._obstacle.displacement or (0.0,))[0] != 0
        if tilted or moved or (self._driven() and abs(self.direction[0]) > _FLAT):
            raise InputError(
                f"{self._key}: an axisymmetric obstacle can be neither tilted nor driven aside"
            )

    def _facing(self, surface_normals: Array) -> Array:
        """Against the normal of a flat contact surface."""
        obstacle = self._obstacle
        mean = surface_normals.mean(axis=0)
        size = float(np.linalg.norm(mean))
        if size > _FLAT:
            mean = mean / size
            if np.abs(surface_normals - mean).max(initial=0.0) <= _FLAT:
                return in_3d(-mean)
        if self._shape is None and obstacle.direction is not None:
            return in_3d(obstacle.direction) / np.linalg.norm(obstacle.direction)
        if self._shape is None and not self._driven():
            return in_3d(-mean) if size > _FLAT else np.zeros(3)
        raise InputError(
            f"{self._key}.normal is missing: the contact surface is curved, so say which way "
            "the obstacle faces (or, without a shape, its direction)"
        )

    def _driven(self) -> bool:
        return bool(self._obstacle.indentation) or self._obstacle.force is not None


def _counts(radii: Array, width: float) -> Integers:
    """Samples along the sides of facets that show something so wide."""
    wanted = np.ceil(_PER_WIDTH * 2 * radii / width)
    return np.clip(wanted, _FEWEST, _MOST).astype(np.int64)


def _unit(vector: Sequence[complex] | None) -> Array | None:
    """A direction of length 1, (3,); of complex numbers as the same function of them."""
    if vector is None:
        return None
    padded = in_3d(vector)
    return np.asarray(padded / np.sqrt((padded**2).sum()))
