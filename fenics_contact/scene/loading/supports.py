"""Supports of a scene: displacements that it prescribes, faces that it turns, and springs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from math import inf
from typing import Annotated

import numpy as np
from pydantic import Field

from fenics_contact.common.arrays import Array
from fenics_contact.scene.loading.load_kinds import times
from fenics_contact.scene.loading.support_axes import ComponentName, SupportAxes
from fenics_contact.scene.quantity_names import require_name
from fenics_contact.scene.units.dimensions import (
    LENGTH,
    PLACE,
    SPRING,
    STIFFNESS,
)
from fenics_contact.scene.values import (
    AXES,
    PER_AXIS,
    RAMP,
    AxisName,
    Kinematics,
    LoadPath,
    Number,
    Positive,
    Text,
    Value,
    scene_class,
)


@scene_class
class FaceRotation:
    """Small rotation of what a support holds, about an axis: u = ω × (x − at).

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
        require_axis(self.axis, kinematics, key)


def require_axis(axis: tuple[float, ...] | None, kinematics: Kinematics, key: str) -> None:
    """Refuse an axis of a rotation in a plane model, and a rotation without one in space.

    Args:
        axis: Direction of the axis; None of none.
        kinematics: Of the model.
        key: Of the rotation in the scene.

    Raises:
        ValueError: In words.
    """
    if kinematics != "3D" and axis is not None:
        raise ValueError(f"{key}.axis: a {kinematics} model turns in its plane; leave it out")
    if kinematics == "3D" and axis is None:
        raise ValueError(f"{key}.axis is missing: give the direction of the axis")


_PER_COMPONENT = Field(min_length=1)


@scene_class
class Support:
    """Prescribed displacement components (the paper's Γ_D), the rotation of a face, or springs.

    >>> Support("left", {"x": 0, "y": lambda x: 0.01 * x[1]}).path(2.0)
    1.0
    """

    on: Annotated[Text, Field(description="physical group: a boundary, or the whole body")]
    displacement: Annotated[
        Mapping[ComponentName, Annotated[Value, LENGTH]],
        Field(
            description="component → value; such as `{ x = 0 }`, or `{ radial = 0 }` with `axes`"
        ),
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
    stiffness: Annotated[
        Annotated[Positive, SPRING]
        | Annotated[Mapping[ComponentName, Annotated[Positive, SPRING]], _PER_COMPONENT]
        | None,
        Field(
            description="total stiffness of springs to the ground, spread evenly over the "
            "boundary; a number for every component, or component → number, others are free. "
            "`displacement` is then that of the springs' foot, by default 0"
        ),
    ] = None
    foundation_stiffness: Annotated[
        Annotated[Positive, STIFFNESS]
        | Annotated[Mapping[ComponentName, Annotated[Positive, STIFFNESS]], _PER_COMPONENT]
        | None,
        Field(description="in place of `stiffness`: that of the springs by area; likewise"),
    ] = None

    axes: Annotated[
        SupportAxes | None,
        Field(
            description="directions of the components of `displacement` and of stiffnesses, in "
            "place of those of the mesh. Without a stiffness springs hold the components, which "
            "give way by 1e-5 of what the body does"
        ),
    ] = None
    normal: Annotated[
        Value | None,
        LENGTH,
        Field(
            description="displacement across the boundary, > 0 outwards; along it, the boundary "
            "slides freely. A plane or a cylinder; held as by `axes`"
        ),
    ] = None

    def __post_init__(self) -> None:
        if self.name is not None:
            require_name(self.name)
        if self.normal is not None:
            self._require_normal()
        elif self.stiffness is not None or self.foundation_stiffness is not None:
            self._require_springs()
        elif not self.displacement and self.rotation is None:
            raise ValueError(
                "give displacement, rotation, normal, stiffness or foundation_stiffness"
            )
        if self.axes is not None and self.rotation is not None:
            raise ValueError("rotation: not beside axes; give axes.cylindrical and around")

    def _require_normal(self) -> None:
        """Refuse keys that a boundary cannot have that slides on itself."""
        others = ("displacement", "axes", "rotation", "stiffness", "foundation_stiffness")
        for key in others:
            if getattr(self, key):
                raise ValueError(
                    f"normal: not beside {key}; give another support for what else is held"
                )

    def _require_springs(self) -> None:
        """Refuse keys that a support with springs cannot have."""
        if self.stiffness is not None and self.foundation_stiffness is not None:
            raise ValueError("give stiffness or foundation_stiffness, not both")
        if self.rotation is not None:
            raise ValueError(
                "rotation: not beside stiffness or foundation_stiffness; give the displacement of "
                "the springs' foot as a function of the place"
            )
        key, given = self.springs
        for axis in self.displacement:
            if isinstance(given, Mapping) and axis not in given:
                raise ValueError(
                    f"displacement.{axis}: no spring acts along {axis}; give {key}.{axis}, or "
                    f"leave displacement.{axis} out"
                )

    @property
    def is_elastic(self) -> bool:
        """Whether it is springs, which give way, and holds no dof."""
        stiff = self.stiffness is not None or self.foundation_stiffness is not None
        return stiff or self.axes is not None or self.normal is not None

    @property
    def is_rigid(self) -> bool:
        """Whether the scene gives no stiffness, so that springs or conditions hold what it says."""
        return self.stiffness is None and self.foundation_stiffness is None

    @property
    def springs(self) -> tuple[str, float | Mapping[ComponentName, float]]:
        """Key of the springs' stiffness, and what the scene gives for it; inf where they hold."""
        if self.stiffness is not None:
            return "stiffness", self.stiffness
        if self.foundation_stiffness is not None:
            return "foundation_stiffness", self.foundation_stiffness
        return "displacement", dict.fromkeys(self.displacement, inf)

    @property
    def key_of_springs(self) -> str:
        """The key that makes it springs."""
        if self.is_rigid:
            return "axes" if self.normal is None else "normal"
        return self.springs[0]

    def components(self, dimension: int) -> tuple[ComponentName, ...]:
        """Names of the components that it may have: those of its axes.

        Args:
            dimension: Number of axes of the model.
        """
        return AXES[:dimension] if self.axes is None else self.axes.names(dimension)

    def sprung(self, dimension: int) -> dict[ComponentName, float]:
        """The springs' stiffness by component, inf where they hold; empty without springs.

        Args:
            dimension: Number of axes of the model.
        """
        if not self.is_elastic or self.normal is not None:
            return {}
        _, given = self.springs
        if isinstance(given, Mapping):
            return dict(given)
        return dict.fromkeys(self.components(dimension), given)

    def stiffnesses(self, dimension: int) -> tuple[tuple[int, float], ...]:
        """Stiffness of the springs by the number of each direction; inf where they hold.

        The normal of a boundary is the only direction of its support.

        Args:
            dimension: Number of axes of the model.
        """
        if self.normal is not None:
            return ((0, inf),)
        names = self.components(dimension)
        return tuple((names.index(name), k) for name, k in self.sprung(dimension).items())

    def feet(self, dimension: int) -> dict[str, tuple[int, Value]]:
        """Displacements of the springs' foot: key → number of the direction, and value.

        Args:
            dimension: Number of axes of the model.
        """
        if self.normal is not None:
            return {"normal": (0, self.normal)}
        names = self.components(dimension)
        return {
            f"displacement.{name}": (names.index(name), value)
            for name, value in self.displacement.items()
        }

    def held(self, dimension: int) -> tuple[AxisName, ...]:
        """The components that it holds; none where springs give way.

        Args:
            dimension: Number of axes of the model.
        """
        if self.is_elastic:
            return ()
        return tuple(axis for axis in AXES if axis in self.displacement) or AXES[:dimension]

    @property
    def moves(self) -> bool:
        """Whether it prescribes a displacement that is not 0."""
        turns = self.rotation is not None and self.rotation.angle != 0
        given = [*self.displacement.values(), 0 if self.normal is None else self.normal]
        return turns or any(value != 0 for value in given)

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
        normal = None if self.normal is None else times(self.normal, factor)
        return replace(self, displacement=moved, rotation=rotation, normal=normal)

    @property
    def label(self) -> str:
        """Name in results and messages."""
        return self.name or self.on
