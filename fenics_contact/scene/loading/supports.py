"""Supports of a scene: displacements that it prescribes, and faces that it turns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from typing import Annotated

import numpy as np
from pydantic import Field

from fenics_contact.common.arrays import Array
from fenics_contact.scene.loading.load_kinds import times
from fenics_contact.scene.quantity_names import require_name
from fenics_contact.scene.units.dimensions import (
    LENGTH,
    PLACE,
)
from fenics_contact.scene.values import (
    AXES,
    PER_AXIS,
    RAMP,
    AxisName,
    Kinematics,
    LoadPath,
    Number,
    Text,
    Value,
    scene_class,
)


@scene_class
class FaceRotation:
    """By how much a support turns what it holds, about an axis: ω × (x − at), of small rotations.

    >>> FaceRotation(angle=0.01, at=(1, 0)).displacement("y", np.array([[3.0], [0.0], [0.0]]))
    array([0.02])
    """

    angle: Annotated[Number, Field(description="of the rotation, in radian")]
    axis: Annotated[
        Annotated[tuple[Number, ...], Field(min_length=3, max_length=3)] | None,
        Field(
            description="direction of the axis, of any length; none in plane models, which turn "
            "in their plane, counterclockwise"
        ),
    ] = None
    at: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        Field(description="a point of the axis; by default the origin"),
    ] = None

    def __post_init__(self) -> None:
        if self.axis is not None and not any(self.axis):
            raise ValueError("axis = 0: give the direction of the axis")

    def displacement(self, axis: AxisName, points: Array) -> Array:
        """A component of the displacement at points (length).

        Args:
            axis: Which component.
            points: Coordinates, (3, points) (length).
        """
        direction = np.array(self.axis or (0.0, 0.0, 1.0))
        arms = np.array(points, dtype=np.float64)
        if self.at is not None:
            arms[: len(self.at)] -= np.array(self.at)[:, None]
        turned = np.cross(self.angle * direction / np.linalg.norm(direction), arms.T)
        return np.asarray(turned[:, AXES.index(axis)])

    def require_model(self, kinematics: Kinematics, key: str) -> None:
        """Refuse an axis that the model has not.

        Args:
            kinematics: Of the model.
            key: Of the rotation in the scene.

        Raises:
            ValueError: In words.
        """
        if kinematics == "axisymmetric":
            raise ValueError(f"{key}: an axisymmetric model has no torsion, so no face turns in it")
        if kinematics != "3D" and self.axis is not None:
            raise ValueError(f"{key}.axis: a {kinematics} model turns in its plane; leave it out")
        if kinematics == "3D" and self.axis is None:
            raise ValueError(f"{key}.axis is missing: give the direction of the axis")


@scene_class
class Support:
    """Prescribed displacement components (the paper's Γ_D), or the rotation of a face.

    >>> Support("left", {"x": 0, "y": lambda x: 0.01 * x[1]}).path(2.0)
    1.0
    """

    on: Annotated[Text, Field(description="physical group: a boundary, or the whole body")]
    displacement: Annotated[
        Mapping[AxisName, Annotated[Value, LENGTH]],
        Field(description="component → value; such as `{ x = 0 }`"),
    ] = field(default_factory=dict)
    path: Annotated[LoadPath, Field(description="of the displacement over the load steps")] = RAMP
    name: Annotated[
        Text | None,
        Field(
            description="name in the results, by default that of the group; reactions of supports "
            "of the same name add up"
        ),
    ] = None
    rotation: Annotated[
        FaceRotation | None,
        Field(
            description="how far it turns what it holds; it adds to `displacement`, whose "
            "components it moves, or all of them where none is given"
        ),
    ] = None
    moment_about: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        Field(
            description="point that the quantity `reaction_moment` is about; by default the "
            "centroid of `on`, of supports of the same name that of all of them"
        ),
    ] = None

    def __post_init__(self) -> None:
        if self.name is not None:
            require_name(self.name)
        if not self.displacement and self.rotation is None:
            raise ValueError("give displacement or rotation")

    def held(self, dimension: int) -> tuple[AxisName, ...]:
        """The components that it holds.

        Args:
            dimension: Number of axes of the model.
        """
        return tuple(self.displacement) or AXES[:dimension]

    @property
    def moves(self) -> bool:
        """Whether it prescribes a displacement that is not 0."""
        turns = self.rotation is not None and self.rotation.angle != 0
        return turns or any(value != 0 for value in self.displacement.values())

    @property
    def is_turned(self) -> bool:
        """Whether it turns what it holds."""
        return self.rotation is not None

    def times(self, factor: float) -> Support:
        """The support with a multiple of its displacements.

        Args:
            factor: By which they are multiplied.
        """
        rotation = self.rotation and replace(self.rotation, angle=factor * self.rotation.angle)
        moved = {axis: times(value, factor) for axis, value in self.displacement.items()}
        return replace(self, displacement=moved, rotation=rotation)

    @property
    def label(self) -> str:
        """Name in results and messages."""
        return self.name or self.on
