"""Supports, loads and preloads of a body, and points whose displacement is a quantity."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from fenics_contact.quantities.names import MAX_CONTACT_PRESSURE
from fenics_contact.scene.loading.load_kinds import LoadKind, kinds_of
from fenics_contact.scene.quantity_names import require_name
from fenics_contact.scene.units.dimensions import BODY_FORCE, FORCE, LENGTH, PLACE, STRESS
from fenics_contact.scene.values import (
    PER_AXIS,
    RAMP,
    AxisName,
    LoadPath,
    Number,
    Positive,
    Text,
    Value,
    scene_class,
)


@scene_class
class Support:
    """Prescribed displacement components (the paper's Γ_D).

    >>> Support("left", {"x": 0, "y": lambda x: 0.01 * x[1]}).path(2.0)
    1.0
    """

    on: Annotated[Text, Field(description="physical group: a boundary, or the whole body")]
    displacement: Annotated[
        Mapping[AxisName, Annotated[Value, LENGTH]],
        Field(min_length=1, description="component → value; such as `{ x = 0 }`"),
    ]
    path: Annotated[LoadPath, Field(description="of the displacement over the load steps")] = RAMP
    name: Annotated[
        Text | None,
        Field(
            description="name in the results, by default that of the group; reactions of supports "
            "of the same name add up"
        ),
    ] = None

    def __post_init__(self) -> None:
        if self.name is not None:
            require_name(self.name)

    @property
    def label(self) -> str:
        """Name in results and messages."""
        return self.name or self.on


@scene_class
class Load:
    """A given load (the paper's f): exactly one of its kinds.

    >>> Load("right", traction=(-300, 0), pressure=300)
    Traceback (most recent call last):
    fenics_contact.common.errors.SceneError: Load: give exactly one of traction, pressure and body_force
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

    def __post_init__(self) -> None:
        *others, last = kinds_of(type(self))
        if sum(getattr(self, key) is not None for key in (*others, last)) != 1:
            raise ValueError(f"give exactly one of {', '.join(others)} and {last}")

    @property
    def kind(self) -> str:
        """The key that it is given by, such as ``traction``."""
        return next(key for key in kinds_of(type(self)) if getattr(self, key) is not None)

    @property
    def definition(self) -> LoadKind:
        """Rules for values of its kind."""
        return kinds_of(type(self))[self.kind]

    @property
    def value(self) -> Any:
        """The value of its kind, such as that of ``traction``."""
        return getattr(self, self.kind)


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
    """A point of the body at which the displacement is a quantity.

    ``Point("middle", (0, 0))`` makes ``displacement_middle``, one entry an axis (length).
    """

    name: Annotated[
        Text,
        Field(
            description="the quantity is `displacement_` and this name; letters, digits, `-`, `_`"
        ),
    ]
    at: Annotated[
        tuple[Annotated[Number, PLACE], ...],
        Field(
            min_length=2,
            max_length=3,
            description="its place in the undeformed body, one entry per axis; where two bodies "
            "touch it belongs to the first mesh",
        ),
    ]

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[\w-]+", self.name):
            raise ValueError(f"name = '{self.name}' may have only letters, digits, '-' and '_'")
