"""Couplings of a scene: a face that moves as a rigid body, loaded or moved at a point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Annotated, Literal

from pydantic import Field

from fenics_contact.scene.quantity_names import require_name
from fenics_contact.scene.units.dimensions import FORCE, LENGTH, MOMENT, PLACE
from fenics_contact.scene.values import (
    AXES,
    PER_AXIS,
    RAMP,
    AxisName,
    Kinematics,
    LoadPath,
    Number,
    Text,
    scene_class,
)

# One way in which a rigid face moves: along an axis, or about it.
Way = tuple[Literal["displacement", "rotation"], AxisName]


@scene_class
class Coupling:
    """A boundary that moves as a rigid body with a point: u = d + θ × (x − at), small rotations.

    What neither ``displacement`` nor ``rotation`` gives follows from ``force`` and ``moment``,
    which are 0 by default.

    >>> handle = Coupling("end", name="handle", force=(0, -100), rotation={"z": 0})
    >>> handle.given
    {('rotation', 'z'): 0.0}
    """

    on: Annotated[Text, Field(description="physical group: the boundary that stays rigid")]
    kind: Annotated[
        Literal["rigid", "distributing"],
        Field(
            description='`"rigid"`; for `"distributing"`, which leaves the boundary elastic, give '
            "a `[[load]]` with `force`, `moment` and `at`"
        ),
    ] = "rigid"
    at: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        Field(description="the point; by default the centroid of the boundary"),
    ] = None
    displacement: Annotated[
        Mapping[AxisName, Annotated[Number, LENGTH]],
        Field(description="component → displacement of the point that is given"),
    ] = field(default_factory=dict)
    rotation: Annotated[
        Mapping[AxisName, Number],
        Field(
            description="component → rotation that is given, in radian; in plane models `z`, "
            "counterclockwise"
        ),
    ] = field(default_factory=dict)
    force: Annotated[
        Annotated[tuple[Annotated[Number, FORCE], ...], PER_AXIS] | None,
        Field(
            description="on the point, one entry per axis, 0 along what is given; of the part that "
            "is modelled, over the whole turn in axisymmetric models"
        ),
    ] = None
    moment: Annotated[
        Annotated[Number, MOMENT]
        | Annotated[tuple[Annotated[Number, MOMENT], ...], Field(min_length=3, max_length=3)]
        | None,
        Field(
            description="on the point, 0 about what is given; a number in the plane, "
            "counterclockwise, else one entry per axis"
        ),
    ] = None
    path: Annotated[
        LoadPath,
        Field(description="of displacement, rotation, force and moment over the load steps"),
    ] = RAMP
    name: Annotated[
        Text | None, Field(description="name in the results, by default that of the boundary")
    ] = None

    def __post_init__(self) -> None:
        if self.kind == "distributing":
            raise ValueError(
                "kind = 'distributing': a [[load]] with force, moment and at does that; a "
                "[[coupling]] is rigid"
            )
        if self.name is not None:
            require_name(self.name)
        for way, value in self.acting.items():
            if value != 0 and way in self.given:
                key = "force" if way[0] == "displacement" else "moment"
                raise ValueError(
                    f"{key} along {way[1]} = {value:g}: {'.'.join(way)} is given, too; the {key} "
                    "there follows from it, so leave one of them out"
                )

    @property
    def label(self) -> str:
        """Name in results and messages."""
        return self.name or self.on

    @property
    def given(self) -> dict[Way, float]:
        """The displacements and rotations that the scene gives, by way (length, radian)."""
        found: dict[Way, float] = {("displacement", a): v for a, v in self.displacement.items()}
        return found | {("rotation", axis): value for axis, value in self.rotation.items()}

    @property
    def acting(self) -> dict[Way, float]:
        """Force and moment by way (force, force times length)."""
        found: dict[Way, float] = {
            ("displacement", axis): value
            for axis, value in zip(AXES, self.force or (), strict=False)
        }
        moment = self.moment
        if isinstance(moment, tuple):
            return found | {
                ("rotation", axis): value for axis, value in zip(AXES, moment, strict=True)
            }
        return found if moment is None else found | {("rotation", "z"): moment}

    def require_model(self, kinematics: Kinematics, key: str) -> None:
        """Refuse ways that a kinematic model does not have.

        Args:
            kinematics: Of the model.
            key: Its own, such as ``coupling[0]``.

        Raises:
            ValueError: In words that begin with the key.
        """
        if kinematics != "3D" and isinstance(self.moment, tuple):
            raise ValueError(f"{key}.moment: a number, as a {kinematics} model turns in its plane")
        if kinematics == "3D" and isinstance(self.moment, float | int):
            raise ValueError(f"{key}.moment: one entry per axis in space")
        known = ways_of(kinematics)
        for way in self.given | {way: value for way, value in self.acting.items() if value}:
            if way not in known:
                named = ", ".join(f"{kind}.{axis}" for kind, axis in known)
                raise ValueError(
                    f"{key}: {'.'.join(way)} is no motion of a rigid face in a {kinematics} model; "
                    f"those are {named}"
                )


def ways_of(kinematics: Kinematics) -> list[Way]:
    """Return the ways in which a rigid face can move.

    >>> ways_of("axisymmetric")
    [('displacement', 'y')]
    """
    if kinematics == "axisymmetric":
        return [("displacement", "y")]
    if kinematics == "3D":
        every: list[Way] = [("displacement", axis) for axis in AXES]
        return [*every, *(("rotation", axis) for axis in AXES)]
    return [("displacement", "x"), ("displacement", "y"), ("rotation", "z")]
