"""Loads, preloads and points of a scene.

The kinds that a load may be of, the marks of its keys, are in ``load_kinds``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal

from pydantic import Field

from fenics_contact.quantities.names import MAX_CONTACT_PRESSURE, PRESSURE_INTEGRAL
from fenics_contact.scene.loading.inertia_kinds import AccelerationKind, Rotation, RotationKind
from fenics_contact.scene.loading.load_kinds import LoadKind, kinds_of
from fenics_contact.scene.loading.resultant_kind import ResultantKind
from fenics_contact.scene.quantity_names import require_name
from fenics_contact.scene.units.dimensions import (
    ACCELERATION,
    BODY_FORCE,
    FORCE,
    MOMENT,
    PLACE,
    STRESS,
)
from fenics_contact.scene.values import (
    PER_AXIS,
    RAMP,
    Kinematics,
    LoadPath,
    Number,
    Positive,
    Text,
    Value,
    scene_class,
)

RESULTANT = ResultantKind(
    "force",
    PRESSURE_INTEGRAL,
    keys=("force", "moment", "at", "distribution"),
    needs=("force", "moment"),
)


@scene_class
class Load:
    """A given load (the paper's f): exactly one of its kinds.

    >>> Load("right", traction=(-300, 0), pressure=300)
    Traceback (most recent call last):
    fenics_contact.common.errors.SceneError: Load: give exactly one of traction, pressure, body_force, force or moment, acceleration and rotation
    """  # noqa: E501

    on: Annotated[Text, Field(description="physical group: boundary, or body for a body force")]
    traction: Annotated[
        Annotated[tuple[Annotated[Value, STRESS], ...], PER_AXIS] | None,
        LoadKind("traction", MAX_CONTACT_PRESSURE),
        Field(description="force per area, one entry per axis"),
    ] = None
    pressure: Annotated[
        Value | None,
        STRESS,
        LoadKind("pressure", MAX_CONTACT_PRESSURE),
        Field(description="pressure, > 0 pushes on the body"),
    ] = None
    body_force: Annotated[
        Annotated[tuple[Annotated[Value, BODY_FORCE], ...], PER_AXIS] | None,
        LoadKind("body force", MAX_CONTACT_PRESSURE),
        Field(description="force per volume, one entry per axis"),
    ] = None
    path: Annotated[LoadPath, Field(description="of the load over the load steps")] = RAMP
    force: Annotated[
        Annotated[tuple[Annotated[Number, FORCE], ...], PER_AXIS] | None,
        RESULTANT,
        Field(
            description="resultant over a boundary, one entry per axis, alone or with a `moment`; "
            "of the part that is modelled, over the whole turn in axisymmetric models"
        ),
    ] = None
    moment: Annotated[
        Annotated[Number, MOMENT]
        | Annotated[tuple[Annotated[Number, MOMENT], ...], Field(min_length=3, max_length=3)]
        | None,
        RESULTANT,
        Field(
            description="couple over a boundary, alone or with a `force`; a number in the plane, "
            "counterclockwise, else one entry per axis"
        ),
    ] = None
    at: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        RESULTANT,
        Field(description="where the `force` acts; by default at the centroid of the boundary"),
    ] = None
    distribution: Annotated[
        Literal["linear", "bearing"] | None,
        RESULTANT,
        Field(
            description="of the `force`: by default a traction linear in the place, which does "
            'not stiffen the boundary; `"bearing"`: pressure of a pin on one half of a hole'
        ),
    ] = None
    acceleration: Annotated[
        Annotated[tuple[Annotated[Number, ACCELERATION], ...], PER_AXIS] | None,
        AccelerationKind("acceleration", MAX_CONTACT_PRESSURE),
        Field(
            description="force per mass, as that of gravity, one entry per axis; needs densities"
        ),
    ] = None
    rotation: Annotated[
        Rotation | None,
        RotationKind("rotation", MAX_CONTACT_PRESSURE),
        Field(description="rotates about an axis; centrifugal forces, from densities"),
    ] = None

    def __post_init__(self) -> None:
        if len(self._given) != 1:
            kinds = kinds_of(type(self))
            *others, last = [" or ".join(kind.needs) or key for key, kind in kinds.items()]
            raise ValueError(f"give exactly one of {', '.join(others)} and {last}")
        self.definition.require(self.value)

    @property
    def _given(self) -> list[str]:
        """Names of the kinds of which it has keys."""
        return [
            name
            for name, kind in kinds_of(type(self)).items()
            if any(getattr(self, key) is not None for key in kind.keys or (name,))
        ]

    @property
    def kind(self) -> str:
        """The key that it is given by, such as ``traction``; of several the one that names it."""
        return self._given[0]

    @property
    def definition(self) -> LoadKind:
        """Rules for values of its kind."""
        return kinds_of(type(self))[self.kind]

    @property
    def words(self) -> str:
        """Name in results and messages, such as ``traction on right``."""
        return f"{self.definition.words_of(self.value)} on {self.on}"

    @property
    def given(self) -> dict[str, Any]:
        """The keys that it is given by, with their values."""
        keys = self.definition.keys or (self.kind,)
        return {key: value for key in keys if (value := getattr(self, key)) is not None}

    @property
    def value(self) -> Any:
        """The value of its kind, such as that of ``traction``; of several keys all of them."""
        return self.given if self.definition.keys else self.given[self.kind]

    @property
    def components(self) -> tuple[Value, ...]:
        """Components of what acts on the body."""
        return self.definition.components(self.value)

    def vectors(self, key: str) -> dict[str, tuple[Value, ...]]:
        """Return the lists that need an entry per axis of the model, by their keys.

        Args:
            key: Its own, such as ``load[0]``.
        """
        return self.definition.vectors(self.value, self._key_of_value(key))

    def require_model(self, kinematics: Kinematics, key: str) -> None:
        """Refuse what a kinematic model cannot have.

        Args:
            kinematics: Such as ``axisymmetric``.
            key: Its own, such as ``load[0]``.

        Raises:
            ValueError: In words that begin with the key.
        """
        self.definition.require_model(self.value, kinematics, self._key_of_value(key))

    def _key_of_value(self, key: str) -> str:
        return key if self.definition.keys else f"{key}.{self.kind}"

    def times(self, factor: float) -> Load:
        """Return a multiple of the load, on the same path.

        Args:
            factor: 1 leaves it as it is.
        """
        value = self.definition.times(self.value, factor)
        return replace(self, **(value if self.definition.keys else {self.kind: value}))

    def slopes(self, names: Sequence[str]) -> tuple[Value, ...] | None:
        """Return the derivatives of the components by one number of the load.

        Args:
            names: Of the number's key in the load, such as ``["traction", "1"]``.

        Returns:
            None where there is no derivative by that number.
        """
        inner = names if self.definition.keys else names[1:]
        return self.definition.slopes(self.value, inner)


@scene_class
class Preload:
    """A bolt that is tightened to a force, and whose length may be kept from then on.

    >>> Preload(on="shank", axis=(0, 0, 1), force=20e3, locked_from=1).label
    'shank'
    """

    on: Annotated[
        Text,
        Field(
            description="physical group of cells, such as a bolt's shank, whose ends must be plane "
            "and at right angles to the axis; or with `between` a body of a CAD file"
        ),
    ]
    axis: Annotated[
        tuple[Number, ...],
        Field(
            min_length=2,
            max_length=3,
            description="along the bolt, one entry per axis, of any length; along y in "
            "axisymmetric models",
        ),
    ]
    force: Annotated[
        Number,
        FORCE,
        Field(
            description="along the axis, > 0 pulls at the bolt; of the part that is modelled, "
            "per unit thickness in plane models without a thickness"
        ),
    ]
    path: Annotated[LoadPath, Field(description="of the force over the load steps")] = RAMP
    locked_from: Annotated[
        Positive | None,
        Field(
            description="pseudo-time of a load step from whose end on the unstressed length is "
            "kept, and the force follows from the loads"
        ),
    ] = None
    name: Annotated[
        Text | None, Field(description="name in the results, by default that of the group")
    ] = None
    between: Annotated[
        tuple[Annotated[Number, PLACE], Annotated[Number, PLACE]] | None,
        Field(
            description="positions along the axis, from and to, at which that body is cut before "
            "it is meshed, measured from the origin; what is between is preloaded"
        ),
    ] = None

    def __post_init__(self) -> None:
        if not any(self.axis):
            raise ValueError("axis = 0: give the direction along the bolt")
        if self.between is not None and self.between[0] >= self.between[1]:
            start, end = self.between
            raise ValueError(
                f"between = [{start:g}, {end:g}]: the first must be less than the second"
            )
        if self.name is not None:
            require_name(self.name)

    @property
    def label(self) -> str:
        """Name in results and messages."""
        return self.name or self.on

    @property
    def group(self) -> str:
        """The group of cells that is preloaded; that of what is between, where a body is cut."""
        if self.between is None:
            return self.on
        start, end = self.between
        return f"{self.on} between {start:.12g} and {end:.12g}"


@scene_class
class Point:
    """A point of the body at which displacement and stress are quantities.

    ``Point("middle", (0, 0))`` makes ``displacement_middle``, one entry an axis (length), and
    ``stress_middle_xx``, … (stress).
    """

    name: Annotated[
        Text,
        Field(
            description="the quantities are `displacement_NAME`, and `stress_NAME_xx`, `_yy`, …, "
            "`strain_NAME_xx`, …; letters, digits, `-`, `_`"
        ),
    ]
    at: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        Field(
            description="its place in the undeformed body, one entry per axis; where two bodies "
            "touch it belongs to the first mesh"
        ),
    ] = None
    on: Annotated[
        Text | None,
        Field(
            description="instead of `at`, a point of the mesh or of the CAD file, by name or as "
            '`"point 3"`'
        ),
    ] = None

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[\w-]+", self.name):
            raise ValueError(f"name = '{self.name}' may have only letters, digits, '-' and '_'")
        if (self.at is None) == (self.on is None):
            raise ValueError("give either at, its place, or on, the name of a point of the mesh")
