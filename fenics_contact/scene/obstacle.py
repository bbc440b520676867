"""The parts of a scene that say what stands opposite: a rigid obstacle; and a half-space around."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, Self

from pydantic import Field

from fenics_contact.analytic import obstacle_shapes
from fenics_contact.analytic.obstacle_shapes import ObstacleShape
from fenics_contact.scene.loading.load_kinds import times
from fenics_contact.scene.loading.supports import require_axis
from fenics_contact.scene.units.dimensions import FORCE, LENGTH, MOMENT, PLACE
from fenics_contact.scene.values import (
    PER_AXIS,
    RAMP,
    Kinematics,
    LoadPath,
    Number,
    OneOf,
    Positive,
    Text,
    Value,
    scene_class,
)

Direction = Annotated[tuple[Number, ...], PER_AXIS]
Place = Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS]
Motion = Annotated[tuple[Annotated[Number, LENGTH], ...], PER_AXIS]
Shape = Annotated[str, OneOf(obstacle_shapes.names)]


@scene_class
class ObstacleRotation:
    """Small rotation of an obstacle about an axis: its point at x moves by ω × (x − at).

    In finite strains it is of any size.

    >>> ObstacleRotation(angle=0.01, at=(1, 0)).angle
    0.01
    """

    angle: Annotated[
        Number | None,
        Field(description="of the rotation, in radian; it is found where a moment turns it"),
    ] = None
    axis: Annotated[
        Annotated[tuple[Number, ...], Field(min_length=3, max_length=3)] | None,
        Field(
            description="direction of the axis, of any length; none in plane models, where it "
            "turns in the plane, counterclockwise"
        ),
    ] = None
    at: Annotated[Place | None, Field(description="a point of the axis; by default the origin")] = (
        None
    )

    def __post_init__(self) -> None:
        if self.axis is not None and not any(self.axis):
            raise ValueError("axis = 0: give the direction of the axis")

    def require_model(self, kinematics: Kinematics, key: str) -> None:
        """Refuse an axis that the model has not.

        Args:
            kinematics: Of the model.
            key: Of the rotation in the scene.

        Raises:
            ValueError: In words.
        """
        if kinematics == "axisymmetric":
            raise ValueError(
                f"{key}: an axisymmetric model has no torsion, so no obstacle turns in it"
            )
        require_axis(self.axis, kinematics, key)


@scene_class
class Obstacle:
    """A rigid obstacle: its shape, where it stands, and what drives it.

    Without a shape and a gap it touches the contact surface everywhere.

    >>> Obstacle(shape="sphere", radius=8, force=4144.2).indentation is None  # it is found
    True
    >>> Obstacle(shape="plane", normal=(0.3, 1), position=(0, 0)).path(0.5)  # a ramp by default
    0.5
    """

    shape: Annotated[
        Shape | None,
        Field(
            description="`paraboloid` and `sphere` in axisymmetric and 3D models, `parabola` and "
            "`cylinder` in plane and 3D ones; a `flat punch` ends at its radius"
        ),
    ] = None
    radius: Annotated[
        Positive | None,
        LENGTH,
        Field(
            description="of a sphere or cylinder, of curvature at the apex of a parabola or "
            "paraboloid, or outer radius (half width in plane models) of a punch"
        ),
    ] = None
    inner_radius: Annotated[Positive | None, LENGTH, Field(description="of an annular punch")] = (
        None
    )
    gap: Annotated[
        Value | None,
        LENGTH,
        Field(
            description="instead of a shape: gap along the surface's normal, negative where they "
            "overlap; in Python a function of x that returns UFL"
        ),
    ] = None
    position: Annotated[
        Place | None,
        Field(
            description="apex, a point of a plane, the place of a file's origin, or where a gap's "
            "force acts on a half-space; by default the origin"
        ),
    ] = None
    normal: Annotated[
        Direction | None,
        Field(
            description="outward normal at the apex, of any length; slanting for a tilted "
            "obstacle; by default against that of a flat contact surface"
        ),
    ] = None
    along: Annotated[
        Direction | None,
        Field(description="direction of the straight lines of a 3D parabola or cylinder"),
    ] = None
    direction: Annotated[
        Direction | None,
        Field(description="in which it is driven, of any length; by default its normal"),
    ] = None
    indentation: Annotated[
        Number | None,
        LENGTH,
        Field(description="how far it is driven; by default 0, unless by a force"),
    ] = None
    force: Annotated[
        Annotated[Number, Field(ge=0)] | None,
        FORCE,
        Field(description="drives it instead; on the part that is modelled"),
    ] = None
    displacement: Annotated[
        Motion | None,
        Field(
            description="how far it moves besides, one entry an axis; along a half-space "
            "in plane strain relative to what lies straight below, at the far end of the mesh"
        ),
    ] = None
    path: Annotated[LoadPath, Field(description="of indentation or force over the load steps")] = (
        RAMP
    )
    displacement_path: Annotated[
        LoadPath, Field(description="of the displacement over the load steps")
    ] = RAMP
    file: Annotated[
        Text | None,
        Field(
            description="in place of a shape, in 3D models: an `.stl`, `.step`, `.stp` or `.brep` "
            "file of a surface, whose path is from the scene's folder"
        ),
    ] = None
    rotation: Annotated[
        ObstacleRotation | None,
        Field(
            description="how far it turns besides, about which axis; small, as in linear theory, "
            "of any size in finite strains, where the axis moves along"
        ),
    ] = None
    rotation_path: Annotated[
        LoadPath, Field(description="of the rotation's angle or the moment over the load steps")
    ] = RAMP
    moment: Annotated[
        Number | None,
        MOMENT,
        Field(
            description="turns it about `rotation.axis` through `rotation.at` in place of an "
            "angle; on the part that is modelled"
        ),
    ] = None

    def __post_init__(self) -> None:
        given = [key for key in ("shape", "file", "gap") if getattr(self, key) is not None]
        if len(given) > 1:
            raise ValueError(f"give either {' or '.join(f'a {key}' for key in given)}")
        if self.force is not None and self.indentation is not None:
            raise ValueError("give either an indentation or a force")
        self._require_turn()
        if not given and self.position is not None:
            raise ValueError("position: only a shape, a file or a gap has one")
        kind = self.kind
        if self.along is not None and not (kind and kind.has_lines):
            raise ValueError("along: only a 3D parabola or cylinder has such a direction")
        needs_radius = kind is not None and kind.has_radius
        if needs_radius and self.radius is None:
            raise ValueError(f"radius is missing for the shape '{self.shape}'")
        if not needs_radius and self.radius is not None:
            raise ValueError("radius: only a curved shape or a punch has one")
        if (kind is not None and kind.has_inner_radius) != (self.inner_radius is not None):
            raise ValueError("inner_radius belongs to the shape 'annular punch', and only there")
        if self.radius and self.inner_radius and self.inner_radius >= self.radius:
            raise ValueError(f"inner_radius = {self.inner_radius:g} must be less than the radius")
        for key in ("normal", "along", "direction"):
            vector = getattr(self, key)
            if vector is not None and not any(vector):
                raise ValueError(f"{key} must not be a zero vector")

    def _require_turn(self) -> None:
        """Refuse a rotation that nothing drives, or two things do."""
        angle = None if self.rotation is None else self.rotation.angle
        if angle is not None and self.moment is not None:
            raise ValueError("give either a rotation.angle or a moment")
        if self.rotation is not None and angle is None and self.moment is None:
            raise ValueError("rotation: give its angle, or a moment that turns the obstacle")
        if self.turning is None and self.rotation_path != RAMP:
            raise ValueError("rotation_path: only an obstacle that turns has one")

    def times(self, factor: float) -> Self:
        """The obstacle with all that drives it times a factor.

        Args:
            factor: 1 leaves it as it is.
        """
        names = ("indentation", "force", "displacement", "moment")
        found = {name: getattr(self, name) for name in names}
        driven: dict[str, Any] = {}
        driven |= {name: times(value, factor) for name, value in found.items() if value is not None}
        if self.rotation is not None and self.angle:
            driven["rotation"] = replace(self.rotation, angle=factor * self.angle)
        return replace(self, **driven)

    @property
    def turning(self) -> ObstacleRotation | None:
        """About what it turns; None where it does not."""
        if self.rotation is None and self.moment is not None:
            return ObstacleRotation()
        return self.rotation

    @property
    def angle(self) -> float:
        """The angle that is given; 0 where it does not turn, or a moment turns it (radian)."""
        return 0.0 if self.rotation is None else self.rotation.angle or 0.0

    @property
    def has_form(self) -> bool:
        """Whether it has a form of its own; else it touches the surface everywhere."""
        return not (self.shape is None and self.file is None and self.gap is None)

    @property
    def kind(self) -> ObstacleShape | None:
        """The obstacle's shape as an object; None without a shape."""
        return None if self.shape is None else obstacle_shapes.shape_of(self.shape)


@scene_class
class HalfSpace:
    """Makes the body a piece of a half-space.

    On its outer boundary the displacement is that of the half-space under the forces that
    the contacts carry, into it (Boussinesq) and along its surface (Cerruti).
    """

    on: Annotated[
        tuple[Text, ...],
        Field(min_length=1, description="physical groups of the outer boundary, inside the body"),
    ]

    @property
    def label(self) -> str:
        """Name in results, as that of a support."""
        return ", ".join(self.on)
