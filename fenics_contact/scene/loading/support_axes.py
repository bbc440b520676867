"""Directions of the components of a support: a turned frame, or around an axis."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from fenics_contact.scene.units.dimensions import PLACE
from fenics_contact.scene.values import AXES, PER_AXIS, Kinematics, Number, scene_class

Direction = Annotated[tuple[Number, ...], Field(min_length=2, max_length=3)]

#: Components of a support by the axes that it has: of the model, of a frame, or around an axis.
ComponentName = Literal["x", "y", "z", "radial", "around", "axial"]
AROUND_AN_AXIS: tuple[ComponentName, ...] = ("radial", "around", "axial")


@scene_class
class SupportAxes:
    """Directions of the components of a support, in place of the axes of the mesh.

    >>> SupportAxes(cylindrical=(0, 0, 1)).names(3)
    ('radial', 'around', 'axial')
    """

    cylindrical: Annotated[
        Annotated[tuple[Number, ...], Field(min_length=3, max_length=3)] | None,
        Field(
            description="direction of an axis, of any length; the components are then `radial`, "
            "`around` and `axial`; `[0, 0, 1]` in plane models"
        ),
    ] = None
    at: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        Field(description="a point of that axis; by default the origin"),
    ] = None
    x: Annotated[
        Direction | None,
        Field(description="direction of the component `x` of a turned frame, of any length"),
    ] = None
    y: Annotated[
        Direction | None,
        Field(
            description="in space, that of `y`; what of it is along `x` is taken off. In plane "
            "models `y` is `x` turned by 90°, counterclockwise"
        ),
    ] = None

    def __post_init__(self) -> None:
        if (self.cylindrical is None) == (self.x is None):
            raise ValueError("give either cylindrical or x")
        if self.at is not None and self.cylindrical is None:
            raise ValueError("at: is a point of the axis of cylindrical, which is missing")
        for name in ("cylindrical", "x", "y"):
            given = getattr(self, name)
            if given is not None and not any(given):
                raise ValueError(f"{name} = 0: give a direction")

    def names(self, dimension: int) -> tuple[ComponentName, ...]:
        """Return the names of the components.

        Args:
            dimension: Number of axes of the model.
        """
        return (AROUND_AN_AXIS if self.cylindrical is not None else AXES)[:dimension]

    def require_model(self, kinematics: Kinematics, key: str) -> None:
        """Refuse axes that a kinematic model does not have.

        Args:
            kinematics: Of the model.
            key: Its own, such as ``support[0].axes``.

        Raises:
            ValueError: In words that begin with the key.
        """
        dimension = 3 if kinematics == "3D" else 2
        if kinematics == "axisymmetric" and self.cylindrical is not None:
            raise ValueError(f"{key}.cylindrical: in an axisymmetric model x is radial anyway")
        if self.cylindrical is not None and dimension == 2 and any(self.cylindrical[:2]):
            raise ValueError(f"{key}.cylindrical: [0, 0, 1] in a {kinematics} model")
        for name in ("x", "y", "at"):
            given = getattr(self, name)
            if given is not None and len(given) != dimension:
                raise ValueError(
                    f"{key}.{name} has {len(given)} entries; a {kinematics} model needs {dimension}"
                )
        if self.x is not None and (self.y is None) == (dimension == 3):
            what = "is missing" if dimension == 3 else "is not for plane models"
            raise ValueError(f"{key}.y {what}")
        if self.x is not None and self.y is not None and not np.cross(self.x, self.y).any():
            raise ValueError(f"{key}.y: is along x; give another direction")
