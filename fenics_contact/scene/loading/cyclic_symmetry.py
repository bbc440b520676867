"""A sector of a body that repeats itself around an axis: its two cut faces move alike."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from fenics_contact.scene.units.dimensions import PLACE
from fenics_contact.scene.values import PER_AXIS, Integer, Kinematics, Number, Text, scene_class


@scene_class
class CyclicSymmetry:
    """Two cut faces of a sector: one moves as the other does, turned by 2π/sectors.

    >>> CyclicSymmetry("cut", "other cut", sectors=12).angle
    30.0
    """

    on: Annotated[Text, Field(description="physical group: one cut face of the sector")]
    against: Annotated[
        Text,
        Field(
            description="physical group: the other cut face, which a turn about the axis takes to "
            "where the first one is"
        ),
    ]
    sectors: Annotated[
        Integer, Field(ge=2, description="number of sectors of the whole ring, at least 2")
    ]
    axis: Annotated[
        Annotated[tuple[Number, ...], Field(min_length=3, max_length=3)] | None,
        Field(
            description="direction of the axis in 3D models, of any length; in plane models it is z"
        ),
    ] = None
    at: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        Field(description="a point of the axis; by default the origin"),
    ] = None

    def __post_init__(self) -> None:
        if self.on == self.against:
            raise ValueError(f"against = '{self.against}': is on, too; name the other cut face")
        if self.axis is not None and not any(self.axis):
            raise ValueError("axis = 0: give a direction")

    @property
    def angle(self) -> float:
        """Angle of the sector (degrees)."""
        return 360 / self.sectors

    def require_model(self, kinematics: Kinematics) -> None:
        """Refuse what a kinematic model does not have.

        Args:
            kinematics: Of the model.

        Raises:
            ValueError: In words that begin with the key.
        """
        dimension = 3 if kinematics == "3D" else 2
        if kinematics == "axisymmetric":
            raise ValueError(
                "cyclic_symmetry: is for plane and 3D models; an axisymmetric one is a whole turn"
            )
        if dimension == 3 and self.axis is None:
            raise ValueError("cyclic_symmetry.axis is missing: a 3D model needs its direction")
        if dimension == 2 and self.axis is not None:
            raise ValueError(f"cyclic_symmetry.axis: in a {kinematics} model it is z; leave it out")
        if self.at is not None and len(self.at) != dimension:
            raise ValueError(
                f"cyclic_symmetry.at has {len(self.at)} entries; a {kinematics} model needs "
                f"{dimension}"
            )
