"""Couplings of a scene: a face that moves with a point, loaded or moved there; springs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Annotated, Literal

from pydantic import Field

from fenics_contact.scene.quantity_names import require_name
from fenics_contact.scene.units.dimensions import FORCE, LENGTH, MASS, MOMENT, PLACE, SPRING
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
    scene_class,
)

# One way in which a coupled point moves: along an axis, or about it.
Way = tuple[Literal["displacement", "rotation"], AxisName]


@scene_class
class Coupling:
    """A boundary that moves with a point: u = d + θ × (x − at), small rotations.

    A rigid one does so at all its points, a distributing one in the mean, by area: force and moment
    act on it as a traction that is linear in the place. What neither ``displacement`` nor
    ``rotation`` gives follows from ``force`` and ``moment``, which are 0 by default.

    >>> handle = Coupling("end", name="handle", force=(0, -100), rotation={"z": 0})
    >>> handle.given
    {('rotation', 'z'): 0.0}
    """

    on: Annotated[Text, Field(description="physical group: the boundary")]
    kind: Annotated[
        Literal["rigid", "distributing"],
        Field(
            description='`"rigid"`: the boundary moves as a rigid body; `"distributing"`: it stays '
            "elastic, and the point has its mean motion"
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
    mass: Annotated[
        Annotated[Positive, MASS] | None,
        Field(
            description="at the point, without a moment of inertia, of the part that is modelled; "
            "it counts in `[modes]` and `[motion]`, and in loads by `acceleration` and `rotation` "
            "on a part of the body that the boundary belongs to"
        ),
    ] = None

    def __post_init__(self) -> None:
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
    def is_rigid(self) -> bool:
        """Whether the boundary moves as a rigid body."""
        return self.kind == "rigid"

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


#: What a spring may be joined to besides couplings.
GROUND = "ground"


@scene_class
class Spring:
    """Springs between the points of two couplings, or of one and the ground.

    They act along each axis by the difference of displacements, and about it by that of rotations.

    >>> Spring(between=("lever", "ground"), rotational_stiffness=1e3).by_way("plane strain")
    {('rotation', 'z'): 1000.0}
    """

    between: Annotated[
        tuple[Text, Text],
        Field(description='names of two couplings, or of one and `"ground"`'),
    ]
    stiffness: Annotated[
        Annotated[Positive, SPRING]
        | Annotated[Mapping[AxisName, Annotated[Positive, SPRING]], Field(min_length=1)]
        | None,
        Field(
            description="force over displacement: a number along every axis, or component → number"
        ),
    ] = None
    rotational_stiffness: Annotated[
        Annotated[Positive, MOMENT]
        | Annotated[Mapping[AxisName, Annotated[Positive, MOMENT]], Field(min_length=1)]
        | None,
        Field(description="moment over rotation (radian); likewise, in plane models about `z`"),
    ] = None

    name: Annotated[Text | None, Field(description="name in words about the scene")] = None
    gap: Annotated[
        Annotated[Number, LENGTH] | Mapping[AxisName, Annotated[Number, LENGTH]],
        Field(
            description="of a stop: how far the first point moves along an axis, relative to the "
            "second, before `stiffness` acts on it, which then pushes it back and never pulls; "
            "> 0 for motion along the axis, < 0 against it, and 0 for a spring both ways; a number "
            "for every axis with a `stiffness`, or component → number"
        ),
    ] = 0.0

    def __post_init__(self) -> None:
        if self.stiffness is None and self.rotational_stiffness is None:
            raise ValueError("give stiffness or rotational_stiffness")
        named = self.gap if isinstance(self.gap, Mapping) else {}
        stiff = self.stiffness if isinstance(self.stiffness, Mapping) else dict.fromkeys(AXES)
        if self.stiffness is None and (self.gap or named):
            raise ValueError("gap: is of stiffness, which is missing")
        for axis in named:
            if axis not in stiff:
                raise ValueError(f"gap.{axis}: stiffness has no {axis}")
        one, other = self.between
        if one in (other, GROUND):
            raise ValueError(
                f"between = ['{one}', '{other}']: two couplings, or a coupling and then 'ground'"
            )

    def by_way(self, kinematics: Kinematics) -> dict[Way, float]:
        """Return the stiffness of each way in which faces move that has one.

        Args:
            kinematics: Of the model.
        """
        given = {"displacement": self.stiffness, "rotation": self.rotational_stiffness}
        found: dict[Way, float] = {}
        for way in ways_of(kinematics):
            kind, axis = way
            value = given[kind]
            if isinstance(value, Mapping):
                value = value.get(axis)
            if value is not None:
                found[way] = value
        return found

    def gaps(self, kinematics: Kinematics) -> dict[Way, float]:
        """Return the gap of each way that has a stiffness and a gap (length).

        Args:
            kinematics: Of the model.
        """
        found: dict[Way, float] = {}
        for kind, axis in self.by_way(kinematics):
            gap = self.gap.get(axis, 0.0) if isinstance(self.gap, Mapping) else self.gap
            if kind == "displacement" and gap != 0:
                found[kind, axis] = gap
        return found

    def require_model(self, kinematics: Kinematics, couplings: Sequence[str], key: str) -> None:
        """Refuse what a kinematic model does not have, and couplings that are not there.

        Args:
            kinematics: Of the model.
            couplings: Names of all couplings.
            key: Its own, such as ``spring[0]``.

        Raises:
            ValueError: In words that begin with the key.
        """
        known = ways_of(kinematics)
        kinds = {"stiffness": "displacement", "rotational_stiffness": "rotation"}
        for name, kind in (*kinds.items(), ("gap", "displacement")):
            value = getattr(self, name)
            axes = [axis for each, axis in known if each == kind]
            if value is not None and not axes:
                raise ValueError(f"{key}.{name}: in a {kinematics} model no face turns")
            for axis in value if isinstance(value, Mapping) else ():
                if axis not in axes:
                    raise ValueError(
                        f"{key}.{name}.{axis}: in a {kinematics} model a face has only "
                        f"{', '.join(axes)}"
                    )
        for name in self.between:
            if name not in (*couplings, GROUND):
                raise ValueError(
                    f"{key}.between: '{name}' is no coupling; there are "
                    + (", ".join(f"'{one}'" for one in couplings) or "none")
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
