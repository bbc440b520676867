"""The parts of a scene that ask how it vibrates: its modes, and what its joints damp of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.units.dimensions import LENGTH
from fenics_contact.scene.values import Integer, Number, Positive, Text, scene_class


@scene_class
class Modes:
    """Natural frequencies and modes about the state after the last load step, all contacts stuck.

    >>> Modes(number=3).number
    3
    """

    number: Annotated[
        Integer, Field(ge=1, le=200, description="how many, the lowest natural frequencies")
    ] = 5


@scene_class
class Damping:
    """Modes that are driven to and fro about that state, each at several amplitudes.

    >>> Damping(amplitudes=(1e-3, 1e-2)).modes
    (1,)
    """

    amplitudes: Annotated[
        tuple[Annotated[Positive, LENGTH], ...],
        Field(
            min_length=1,
            max_length=200,
            description="largest displacements to which the forces drive the mode if nothing "
            "slips, each > 0 and larger than the one before",
        ),
    ]
    modes: Annotated[
        tuple[Annotated[Integer, Field(ge=1)], ...],
        Field(min_length=1, description="numbers of the modes that are driven, the lowest is 1"),
    ] = (1,)
    by: Annotated[
        Mapping[Text, Annotated[tuple[Number, ...], Field(min_length=1, max_length=200)]],
        Field(
            description="all of it for each of several values of other numbers: key as of `--set` "
            '→ values, such as `{ "contact.0.friction_coefficient" = [0.1, 0.2] }`; of several '
            "keys all combinations"
        ),
    ] = Field(default_factory=dict)
    increments: Annotated[
        Integer,
        Field(ge=8, le=10_000, description="load steps of a cycle, in fours"),
    ] = 40
    cycles: Annotated[
        Integer,
        Field(ge=2, le=1000, description="that are driven at the most until the loop closes"),
    ] = 10
    tolerance: Annotated[
        Positive,
        Field(lt=1, description="as of `[cycles]`: by how much a loop that is closed may change"),
    ] = 1e-3

    def __post_init__(self) -> None:
        for first, second in zip(self.amplitudes, self.amplitudes[1:], strict=False):
            numbers = isinstance(first, float | int) and isinstance(second, float | int)
            if numbers and second <= first:
                raise ValueError("amplitudes: each must be larger than the one before")
        if len(set(self.modes)) < len(self.modes):
            raise ValueError("modes: a number is given twice")
        if self.increments % 4:
            raise ValueError(f"increments = {self.increments} must be a multiple of 4")


class _AskingForModes(CoreScene):
    """A scene with one of these tables."""

    modes: Modes | None
    damping: Damping | None


def require(scene: _AskingForModes) -> None:
    """Refuse a scene whose modes or damping cannot be found.

    Raises:
        ValueError: Densities or modes are missing, the body has no end, or friction has no memory.
    """
    modes, damping = scene.modes, scene.damping
    if modes is None:
        raise ValueError("damping: say by [modes] how many modes are to be found")
    if scene.half_space is not None:
        raise ValueError("modes: a half-space has none; take a body of finite size")
    if scene.coupling and damping is not None:
        raise ValueError("damping: not beside a coupling yet, whose face its forces would not move")
    for number, material in enumerate(scene.material):
        if material.density is None:
            key = f"material[{number}]" if len(scene.material) > 1 else "material"
            raise ValueError(f"modes: {key}.density is missing: the mass of a unit of volume")
    for number, contact in enumerate(scene.contact):
        if contact.is_rough and contact.law == "static":
            raise ValueError(
                f"modes: contact[{number}].law = 'static' has no memory; set law = 'incremental'"
            )
        if damping is not None and contact.wear is not None:
            raise ValueError(
                f"damping: contact[{number}] has a wear, so that no loop closes; leave it out"
            )
    if damping is not None and max(damping.modes) > modes.number:
        raise ValueError(
            f"damping.modes: mode {max(damping.modes)} is driven, but modes.number = {modes.number}"
        )
