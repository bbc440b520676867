"""The kinds of loads by masses: under an acceleration, or rotating about an axis."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from fenics_contact.common.arrays import Array
from fenics_contact.scene.loading.load_kinds import LoadKind
from fenics_contact.scene.units.dimensions import PLACE, RATE
from fenics_contact.scene.values import PER_AXIS, Kinematics, Number, Value, scene_class


class AccelerationKind(LoadKind):
    """A force over mass, as gravity is, whose components are those of a field g + G x.

    First g, then the rows of G, which is 0 where the force is the same everywhere.
    """

    def components(self, value: Any) -> tuple[Value, ...]:
        """The acceleration, and zeros."""
        return (*value, *(0.0,) * len(value) ** 2)

    def require_model(self, value: Any, kinematics: Kinematics, key: str) -> None:
        """Refuse one across an axis of revolution.

        Raises:
            ValueError: In words.
        """
        if kinematics == "axisymmetric" and value[0]:
            raise ValueError(f"{key}: an axisymmetric model has one along its axis alone: [0, g]")

    def slopes(self, value: Any, names: Sequence[str]) -> tuple[Value, ...] | None:
        """Slopes of g and G by a component of the acceleration."""
        unit = np.eye(len(value))[int(names[0])]
        return self.components(tuple(unit.tolist()))


@scene_class
class Rotation:
    """How bodies rotate about an axis.

    >>> Rotation(speed=100, at=(1, 0)).field()[0].tolist()  # of ω² P (x − at), at the origin
    [-10000.0, 0.0]
    """

    speed: Annotated[Number, RATE, Field(description="angular velocity; radian over time")]
    axis: Annotated[
        Annotated[tuple[Number, ...], PER_AXIS] | None,
        Field(
            description="direction of the axis, of any length; `[0, 1]` in axisymmetric models; "
            "none in plane models, which rotate in their plane"
        ),
    ] = None
    at: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        Field(description="a point of the axis; by default the origin"),
    ] = None

    def __post_init__(self) -> None:
        if self.axis is not None and not any(self.axis):
            raise ValueError("axis = 0: give the direction of the axis")

    @property
    def dimension(self) -> int:
        """Components of its vectors."""
        return len(self.axis or self.at or (0.0, 0.0))

    def field(self) -> tuple[Array, Array]:
        """Return g and G of the force over mass ω² P (x − at) = g + G x."""
        return self._about(self.speed**2 * self._projection)

    def slope(self, names: Sequence[str]) -> tuple[Array, Array] | None:
        """Return the derivatives of g and G by one number; None where there is none.

        Args:
            names: Of the number's key, such as ``["at", "1"]``.
        """
        if names[0] == "speed":
            return self._about(2 * self.speed * self._projection)
        place = int(names[1])
        if names[0] == "at":
            return -(self.speed**2) * self._projection[:, place], np.zeros((self.dimension,) * 2)
        if self.dimension == 2:  # another direction is none of an axisymmetric model
            return None
        axis = np.array(self.axis)
        size, unit = axis @ axis, np.eye(len(axis))[place]
        turned = 2 * axis[place] * np.outer(axis, axis) / size**2
        turned -= (np.outer(unit, axis) + np.outer(axis, unit)) / size
        return self._about(self.speed**2 * turned)

    @property
    def _projection(self) -> Array:
        """P, onto the plane across the axis."""
        if self.axis is None:
            return np.eye(self.dimension)
        axis = np.array(self.axis) / np.linalg.norm(self.axis)
        return np.asarray(np.eye(len(axis)) - np.outer(axis, axis))

    def _about(self, linear: Array) -> tuple[Array, Array]:
        """Return g and G of the field G (x − at)."""
        at = np.zeros(self.dimension) if self.at is None else np.array(self.at)
        return -linear @ at, linear


class RotationKind(LoadKind):
    """Masses that are pulled outwards on circles, as of a field g + G x of force over mass."""

    def components(self, value: Any) -> tuple[Value, ...]:
        """Components of g, then the rows of G."""
        return _flat(value.field())

    def vectors(self, value: Any, key: str) -> dict[str, tuple[Value, ...]]:
        """The axis and its place."""
        named = {f"{key}.axis": value.axis, f"{key}.at": value.at}
        return {name: vector for name, vector in named.items() if vector is not None}

    def require_model(self, value: Any, kinematics: Kinematics, key: str) -> None:
        """Refuse an axis that the model has not.

        Raises:
            ValueError: In words.
        """
        if kinematics in ("plane stress", "plane strain"):
            if value.axis is not None:
                raise ValueError(
                    f"{key}.axis: a {kinematics} model rotates in its plane; leave it out"
                )
        elif value.axis is None:
            raise ValueError(f"{key}.axis is missing: give the direction of the axis")
        elif kinematics == "axisymmetric" and (value.axis[0] or (value.at or (0.0,))[0]):
            raise ValueError(f"{key}: an axisymmetric model rotates about its axis: axis = [0, 1]")

    def times(self, value: Any, factor: float) -> Any:
        """A multiple of the load, which goes with the square of the speed."""
        return dataclasses.replace(value, speed=value.speed * float(np.sqrt(factor)))

    def slopes(self, value: Any, names: Sequence[str]) -> tuple[Value, ...] | None:
        """Slopes of g and G by the speed, or by a number of the axis or its place."""
        slope = value.slope(names)
        return None if slope is None else _flat(slope)


def _flat(field: tuple[Array, Array]) -> tuple[float, ...]:
    return (*field[0].tolist(), *field[1].ravel().tolist())
