"""The part of a scene that asks for an accuracy, for which the mesh is then made."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Mapping
from typing import Annotated, Any

from pydantic import Field

from fenics_contact.scene_values import Integer, Number, scene_class

_Asked = Annotated[Number, Field(gt=0, lt=1)] | None
# Of a scene that says but one number; in each, those that it has.
MAIN = ("normal_force", "max_contact_pressure", "contact_area", "stick_area")


@scene_class
class Accuracy:
    """Estimated errors that the answer may have, relative; `accuracy = 1e-3` asks for all main.

    >>> Accuracy(main=1e-2, normal_force=1e-4).asked(["normal_force", "contact_area"])
    {'normal_force': 0.0001, 'contact_area': 0.01}
    """

    main: Annotated[
        _Asked,
        Field(
            description="of `normal_force`, `max_contact_pressure`, `contact_area` and, with "
            "friction whose bound is not given, `stick_area`"
        ),
    ] = None
    normal_force: Annotated[_Asked, Field(description="over itself")] = None
    friction_force: Annotated[_Asked, Field(description="over the normal force")] = None
    max_contact_pressure: Annotated[_Asked, Field(description="over itself")] = None
    contact_area: Annotated[_Asked, Field(description="over itself")] = None
    stick_area: Annotated[_Asked, Field(description="over the area in contact")] = None
    slip_area: Annotated[_Asked, Field(description="over the area in contact")] = None
    max_slip: Annotated[_Asked, Field(description="over itself")] = None
    indentation: Annotated[_Asked, Field(description="over itself")] = None
    strain_energy: Annotated[_Asked, Field(description="over itself")] = None
    friction_work: Annotated[_Asked, Field(description="over the strain energy")] = None
    max_levels: Annotated[
        Integer, Field(ge=1, le=50, description="meshes at the most, with the first")
    ] = 10
    max_dofs: Annotated[Integer, Field(ge=100, description="of a mesh at the most")] = 200_000

    def __post_init__(self) -> None:
        if not any(getattr(self, name) for name in QUANTITIES) and self.main is None:
            raise ValueError(f"ask for that of main or of any of {', '.join(QUANTITIES)}")

    def asked(self, present: Collection[str]) -> dict[str, float]:
        """Quantities asked for, each with the relative error that it may have.

        Args:
            present: Quantities that the scene has; others are left out of those of ``main``.
        """
        asked = {name: getattr(self, name) for name in QUANTITIES}
        if self.main is not None:
            asked |= {name: asked[name] or self.main for name in MAIN if name in present}
        return {name: limit for name, limit in asked.items() if limit is not None}


QUANTITIES = tuple(
    field.name
    for field in dataclasses.fields(Accuracy)
    if field.name not in ("main", "max_levels", "max_dofs")
)
# Quantities that may vanish, over what is their size then.
MEASURED_BY = {
    "friction_force": "normal_force",
    "stick_area": "contact_area",
    "slip_area": "contact_area",
    "friction_work": "strain_energy",
}


def as_accuracy(value: Any) -> Any:
    """A number asks for that of all main quantities."""
    is_number = isinstance(value, float | int) and not isinstance(value, bool)
    if is_number:
        return {"main": float(value)}
    if value is None or isinstance(value, Accuracy | Mapping):
        return value
    raise ValueError("must be a number, as in accuracy = 1e-3, or a table")
