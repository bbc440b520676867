"""Temperatures of bodies, which expand them: the table ``[[temperature]]`` of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from fenics_contact.scene.body import Material
from fenics_contact.scene.units.dimensions import TEMPERATURE
from fenics_contact.scene.values import RAMP, LoadPath, Text, Value, scene_class


@scene_class
class Temperature:
    """The temperature of a body, or of all: it expands by α (T − reference temperature).

    >>> Temperature("hub", value=120).label
    'temperature of hub'
    >>> Temperature("hub", value=120, file="oven.vtu")
    Traceback (most recent call last):
    fenics_contact.common.errors.SceneError: Temperature: give either a value or a file
    """

    on: Annotated[
        str, Field(description="physical group of cells that has it; by default the body")
    ] = ""
    value: Annotated[
        Value | None,
        TEMPERATURE,
        Field(description="once `path` is 1: a number, or how it varies in space"),
    ] = None
    path: Annotated[
        LoadPath,
        Field(
            description="of the difference to the material's `reference_temperature` over the "
            "load steps"
        ),
    ] = RAMP
    file: Annotated[
        Text | None,
        Field(
            description="in place of a value: temperatures at places around the body, of a mesh "
            "with a field (`.vtu`, `.xdmf`, `.med`) or a table (`.csv`: x, y, z and temperature); "
            "between these they are linear; relative to the scene file"
        ),
    ] = None
    field: Annotated[
        Text | None,
        Field(description="name of the field of a mesh; may be left out where there is one alone"),
    ] = None

    def __post_init__(self) -> None:
        if (self.value is None) == (self.file is None):
            raise ValueError("give either a value or a file")
        if self.field is not None and self.file is None:
            raise ValueError("field: only a file has one")

    @property
    def label(self) -> str:
        """Name in results and messages."""
        return f"temperature of {self.on}" if self.on else "temperature"

    @property
    def is_uniform(self) -> bool:
        """Whether it is the same everywhere."""
        return isinstance(self.value, float | int)


def expansions(material: Material) -> tuple[float, tuple[float, float, float]] | None:
    """Return the largest size α of a material's thermal expansion, and that of each axis over it.

    None where the material has none.

    >>> expansions(Material(youngs_modulus=1, poissons_ratio=0, thermal_expansion=(2e-6, 1e-6, 0)))
    (2e-06, (1.0, 0.5, 0.0))
    """
    given = material.thermal_expansion
    if given is None:
        return None
    x, y, z = given if isinstance(given, tuple) else (given, given, given)
    largest = max(x, y, z, key=abs)
    if largest == 0:
        return 0.0, (1.0, 1.0, 1.0)
    return largest, (x / largest, y / largest, z / largest)


def largest_expansion(material: Material) -> float:
    """Largest size of a material's thermal expansion; 0 without one (1/temperature)."""
    found = expansions(material)
    return 0.0 if found is None else abs(found[0])


def largest_rise(temperatures: Sequence[Temperature], materials: Sequence[Material]) -> float:
    """Largest difference of a uniform temperature from a reference; 1 without any (temperature).

    >>> cold = Material(youngs_modulus=1, poissons_ratio=0, reference_temperature=20)
    >>> largest_rise([Temperature(value=120)], [cold])
    100.0
    """
    rises = [
        abs(float(given.value) - material.reference_temperature)
        for given in temperatures
        for material in materials
        if isinstance(given.value, float | int)
    ]
    return max(rises, default=0.0) or 1.0
