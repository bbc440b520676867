"""Shapes of rigid obstacles: a class for each, which says all that its kind decides.

All lengths of ``gaps`` are from the apex; rays need no length of 1, as along the lines of a
cylinder they are shortened.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fenics_contact.common.arrays import Array, Flags

PLANE_MODELS = ("plane strain", "plane stress")
ALL_MODELS = (*PLANE_MODELS, "axisymmetric", "3D")
# A point counts as opposite the edge of a punch within this share of its radius.
_EDGE = 1e-6
# Of the radius of a parabola: height above the centre of curvature down to which feet are found.
_LEAST_ABOVE = 1e-3
# Of a ray, how much of it has to go towards an obstacle.
_TOWARDS = 1e-9


@dataclass(frozen=True)
class Sizes:
    """Direction and lengths of an obstacle.

    Attributes:
        normal: Outward unit normal at the apex, (3,).
        radius: Of a shape that has one (length).
        inner_radius: Of a shape that has one; else 0 (length).
    """

    normal: Array
    radius: Any
    inner_radius: float


@dataclass(frozen=True)
class Nearest:
    """The points of an obstacle's line in the plane that are nearest to some places.

    Attributes:
        distance: To them, < 0 inside the obstacle, (places,) (length).
        normals: Outward unit normals of the obstacle there, (places, 2).
        arc: Where they lie along the line, counterclockwise around the obstacle, (places,)
            (length).
        curvature: By which the normal turns where the place moves along the line, (places,)
            (1/length).
        rate: How fast ``arc`` then grows: 1 on the obstacle, (places,).
    """

    distance: Array
    normals: Array
    arc: Array
    curvature: Array
    rate: Array


class ObstacleShape(ABC):
    """A shape of rigid obstacles.

    Attributes:
        name: As in a scene.
        models: Kinematics that have it.
        has_radius: Whether it needs a radius.
        has_inner_radius: Whether it needs an inner radius, too.
        has_lines: Whether it is straight along lines in 3D, whose direction a scene gives.
        has_edge: Whether it ends at an edge, where contact jumps as the edge moves.
        is_round: Whether it is a part of a circle: seen from its centre, not from the apex.
        is_endless: Whether it is as wide as one looks.
        is_hertzian: Whether Hertz's formulas are of it.
        tells_nearest: Whether ``nearest`` is known, from which finite strains measure gaps.
    """

    name: ClassVar[str]
    models: ClassVar[tuple[str, ...]]
    has_radius: ClassVar[bool] = True
    has_inner_radius: ClassVar[bool] = False
    has_lines: ClassVar[bool] = False
    has_edge: ClassVar[bool] = False
    is_round: ClassVar[bool] = False
    is_endless: ClassVar[bool] = False
    is_hertzian: ClassVar[bool] = False
    tells_nearest: ClassVar[bool] = False

    def nearest(self, offsets: Array, sizes: Sizes) -> Nearest:
        """The nearest points in a plane model, from anywhere.

        Args:
            offsets: Of places from the apex, (places, 2) (length).
            sizes: Of the obstacle.

        Raises:
            NotImplementedError: The shape has an edge, or no formula for them.
        """
        raise NotImplementedError(f"no nearest points of the shape '{self.name}'")

    def period(self, sizes: Sizes) -> float:
        """Length of the line after which ``Nearest.arc`` begins again; infinite if never."""
        return np.inf

    @abstractmethod
    def gaps(self, offsets: Array, rays: Array, sizes: Sizes) -> Array:
        """From points along rays to the obstacle, (points,) (length); infinite where none hits it.

        Args:
            offsets: Of the points from the apex, (points, 3) (length).
            rays: Directions, (points, 3).
            sizes: Of the obstacle; they may be complex, for derivatives.
        """


class Plane(ObstacleShape):
    """A plane without an end."""

    name, has_radius, tells_nearest = "plane", False, True
    models: ClassVar[tuple[str, ...]] = ALL_MODELS

    def nearest(self, offsets: Array, sizes: Sizes) -> Nearest:
        """The feet of the perpendiculars."""
        normal = sizes.normal[:2]
        straight = np.zeros(len(offsets))
        normals = np.broadcast_to(normal, offsets.shape)
        arc = offsets @ turned(normal)
        return Nearest(offsets @ normal, normals, arc, straight, 1 + straight)

    def gaps(self, offsets: Array, rays: Array, sizes: Sizes) -> Array:
        """To the plane through the apex."""
        facing = -rays @ sizes.normal
        gap = np.full(len(rays), np.inf, np.result_type(offsets, facing))
        towards = facing > _TOWARDS
        gap[towards] = (offsets @ sizes.normal)[towards] / facing[towards]
        return gap


class FlatPunch(Plane):
    """A disc, or a strip in plane models."""

    name, has_radius, has_edge, tells_nearest = "flat punch", True, True, False

    def gaps(self, offsets: Array, rays: Array, sizes: Sizes) -> Array:
        """To the plane, where the ray meets it inside of the edge."""
        gap = super().gaps(offsets, rays, sizes)
        hit = np.isfinite(gap)
        reached = offsets + np.where(hit, gap, 0.0)[:, None] * rays
        aside = reached - np.outer(reached @ sizes.normal, sizes.normal)
        gap[self._outside(np.linalg.norm(aside, axis=1), sizes)] = np.inf
        return gap

    @staticmethod
    def _outside(distance: Array, sizes: Sizes) -> Flags:
        radius = float(np.real(sizes.radius))
        margin = _EDGE * radius
        return np.asarray((distance > radius + margin) | (distance < sizes.inner_radius - margin))


class AnnularPunch(FlatPunch):
    """A flat ring."""

    name, has_inner_radius = "annular punch", True
    models = ("axisymmetric", "3D")


class Paraboloid(ObstacleShape):
    """A paraboloid of revolution, by its radius of curvature at the apex."""

    name = "paraboloid"
    models: ClassVar[tuple[str, ...]] = ("axisymmetric", "3D")
    is_endless, is_hertzian = True, True

    def gaps(self, offsets: Array, rays: Array, sizes: Sizes) -> Array:
        """First entry into height ≤ −ρ²/2R: smaller root of A s² + B s + C."""
        radius = sizes.radius
        height, rise = offsets @ sizes.normal, rays @ sizes.normal
        across = np.einsum("ij,ij->i", offsets, rays) - height * rise
        a = (np.einsum("ij,ij->i", rays, rays) - rise**2) / (2 * radius)
        b = rise + across / radius
        c = height + (np.einsum("ij,ij->i", offsets, offsets) - height**2) / (2 * radius)
        discriminant = b**2 - 4 * a * c
        towards = (rise < -_TOWARDS) & (discriminant >= 0)
        divisor = -b + np.sqrt(np.where(towards, discriminant, 0.0))
        towards &= divisor > 0
        return np.where(towards, 2 * c / np.where(towards, divisor, 1.0), np.inf)


class Parabola(Paraboloid):
    """A parabola, which is straight along lines in 3D."""

    name, has_lines, tells_nearest = "parabola", True, True
    models = (*PLANE_MODELS, "3D")

    def nearest(self, offsets: Array, sizes: Sizes) -> Nearest:
        """Feet t of the normals, t³ + 2R (R + h) t = 2R² x of a place at x along and h above.

        Of places deeper than the centre of curvature at the apex it is one of three.
        """
        normal, radius = sizes.normal[:2], sizes.radius
        tangent = turned(normal)
        along, height = offsets @ tangent, offsets @ normal
        linear = 2 * radius * np.maximum(radius + height, _LEAST_ABOVE * radius)
        root = np.sqrt(linear / 3)
        slope = 2 * root * np.sinh(np.arcsinh(radius**2 * along / root**3) / 3) / radius
        length = np.sqrt(1 + slope**2)
        normals = (normal + slope[:, None] * tangent) / length[:, None]
        feet = radius * (slope[:, None] * tangent - 0.5 * slope[:, None] ** 2 * normal)
        distance = np.einsum("ij,ij->i", offsets - feet, normals)
        arc = 0.5 * radius * (slope * length + np.arcsinh(slope))
        own = 1 / (radius * length**3)
        return Nearest(distance, normals, arc, own / (1 + own * distance), 1 / (1 + own * distance))


class Sphere(ObstacleShape):
    """A full sphere, by its radius."""

    name = "sphere"
    models: ClassVar[tuple[str, ...]] = ("axisymmetric", "3D")
    is_round, is_hertzian = True, True

    def gaps(self, offsets: Array, rays: Array, sizes: Sizes) -> Array:
        """First entry into |x − centre| ≤ R; overlaps deeper than R are no contact.

        All is taken over R, and from the apex: of a large radius the centre is so far away that
        distances from it tell nothing of the gap.
        """
        radius = sizes.radius
        along = -(rays @ sizes.normal) - np.einsum("ij,ij->i", offsets, rays) / radius
        lengths = np.einsum("ij,ij->i", rays, rays)
        outside = 2 * offsets @ sizes.normal + np.einsum("ij,ij->i", offsets, offsets) / radius
        discriminant = along**2 - lengths * (outside / radius)
        hit = (discriminant >= 0) & (along > 0)
        # The stable form of (along − √discriminant) / lengths.
        divisor = along + np.sqrt(np.where(hit, discriminant, 0.0))
        gap = np.where(hit, outside / np.where(hit, divisor, 1.0), np.inf)
        return np.where(gap < -radius, np.inf, gap)


class Cylinder(Sphere):
    """A circular cylinder, which is straight along lines in 3D."""

    name, has_lines, tells_nearest = "cylinder", True, True
    models = (*PLANE_MODELS, "3D")

    def nearest(self, offsets: Array, sizes: Sizes) -> Nearest:
        """Along rays from the centre; the arc is 0 at the apex."""
        normal = sizes.normal[:2]
        rays = offsets + sizes.radius * normal
        lengths = np.linalg.norm(rays, axis=1)
        safe = np.where(lengths > 0, lengths, 1.0)
        angle = np.arctan2(rays @ turned(normal), rays @ normal)
        distance, arc = lengths - sizes.radius, sizes.radius * angle
        return Nearest(distance, rays / safe[:, None], arc, 1 / safe, sizes.radius / safe)

    def period(self, sizes: Sizes) -> float:
        """Length of the way once around the cylinder (length)."""
        return float(2 * np.pi * sizes.radius)


def turned(vectors: Array) -> Array:
    """Vectors in the plane turned by a right angle, counterclockwise, (…, 2)."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


_SHAPES: dict[str, ObstacleShape] = {
    shape.name: shape
    for shape in (
        *(Plane(), Parabola(), Paraboloid(), Cylinder(), Sphere(), FlatPunch(), AnnularPunch()),
    )
}


def register(shape: ObstacleShape) -> None:
    """Make a shape known by its name.

    Raises:
        ValueError: There is a shape of this name.
    """
    if shape.name in _SHAPES:
        raise ValueError(f"there is a shape '{shape.name}'")
    _SHAPES[shape.name] = shape


def unregister(name: str) -> None:
    """Take out a shape that was registered."""
    del _SHAPES[name]


def names() -> tuple[str, ...]:
    """Names of all shapes, in the order in which they are listed."""
    return tuple(_SHAPES)


def names_in(kinematics: str) -> list[str]:
    """Names of the shapes that models of some kinematics have."""
    return [name for name, shape in _SHAPES.items() if kinematics in shape.models]


def names_with_nearest(kinematics: str) -> list[str]:
    """Names of the shapes of models of some kinematics whose nearest points are known."""
    return [name for name in names_in(kinematics) if _SHAPES[name].tells_nearest]


def shape_of(name: str) -> ObstacleShape:
    """The shape of a name."""
    return _SHAPES[name]
