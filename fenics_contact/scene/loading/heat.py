"""Heat that flows: what boundaries of a scene have of it, and what its contacts conduct."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from fenics_contact.common.arrays import Array
from fenics_contact.scene.units.dimensions import CONDUCTANCE, HEAT_FLUX, STRESS, TEMPERATURE
from fenics_contact.scene.values import RAMP, LoadPath, Number, Text, Value, scene_class


@scene_class
class Film:
    """What flows between a boundary and what is around it: coefficient × (temperature − T)."""

    coefficient: Annotated[
        Annotated[Number, Field(ge=0)],
        CONDUCTANCE,
        Field(description="heat flow over area and difference of temperature"),
    ]
    temperature: Annotated[Number, TEMPERATURE, Field(description="of what is around")]


@scene_class
class Heat:
    """What a boundary has of heat: a temperature, a flux, or a film.

    Where there is one, temperatures are found by stationary conduction, in every load step.

    >>> Heat("outside", temperature=20, flux=1)
    Traceback (most recent call last):
    fenics_contact.common.errors.SceneError: Heat: give exactly one of temperature, flux and film
    """

    on: Annotated[Text, Field(description="physical group of a boundary")]
    temperature: Annotated[
        Value | None, TEMPERATURE, Field(description="that the boundary has, once `path` is 1")
    ] = None
    flux: Annotated[
        Value | None,
        HEAT_FLUX,
        Field(description="heat flow over area, > 0 into the body"),
    ] = None
    film: Annotated[
        Film | None,
        Field(description="convection: `{ coefficient = …, temperature = … }`"),
    ] = None
    path: Annotated[
        LoadPath,
        Field(
            description="over the load steps, of a flux, or of the difference of a temperature to "
            "the materials' `reference_temperature`"
        ),
    ] = RAMP

    def __post_init__(self) -> None:
        given = (self.temperature, self.flux, self.film)
        if sum(value is not None for value in given) != 1:
            raise ValueError("give exactly one of temperature, flux and film")


@scene_class
class Conductance:
    """Heat flow over area and difference of temperature, as it grows with the contact pressure.

    >>> Conductance(pressures=(0, 10), values=(0, 2)).at(np.array([0, 5, 20])).tolist()
    [0.0, 1.0, 2.0]
    """

    pressures: Annotated[
        tuple[Annotated[Number, STRESS], ...],
        Field(min_length=2, description="increasing contact pressures, the first one 0"),
    ]
    values: Annotated[
        tuple[Annotated[Annotated[Number, Field(ge=0)], CONDUCTANCE], ...],
        Field(min_length=2, description="at each; linear in between, constant beyond the last"),
    ]

    def __post_init__(self) -> None:
        if len(self.pressures) != len(self.values):
            raise ValueError(
                f"pressures has {len(self.pressures)} entries and values {len(self.values)}"
            )
        if self.pressures[0] != 0 or any(
            b <= a for a, b in zip(self.pressures, self.pressures[1:], strict=False)
        ):
            raise ValueError("the pressures must increase from 0")

    def at(self, pressure: Array) -> Array:
        """Conductance at contact pressures.

        Args:
            pressure: At points, (points,) (stress).
        """
        return np.interp(pressure, self.pressures, self.values)

    def slope_at(self, pressure: Array) -> Array:
        """Slope of the conductance at contact pressures, at a knot that beyond it.

        Args:
            pressure: At points, (points,) (stress).
        """
        slopes = np.append(np.diff(self.values) / np.diff(self.pressures), 0.0)
        return np.asarray(slopes[np.searchsorted(self.pressures, pressure, side="right") - 1])

    def shares_at(self, number: int, pressure: Array) -> Array:
        """How much of one of the values is in the conductance at contact pressures.

        Args:
            number: Of the value.
            pressure: At points, (points,) (stress).
        """
        return np.asarray(np.interp(pressure, self.pressures, np.eye(len(self.values))[number]))
