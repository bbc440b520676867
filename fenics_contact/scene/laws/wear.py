"""Wear of a contact: a table of its own in a scene, ``contact.wear``."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.units.dimensions import PER_STRESS, STRESS
from fenics_contact.scene.values import Number, Value, scene_class


@scene_class
class Wear:
    """Archard's law: where a point slips by ds under a pressure p, the surfaces lose k p |ds|.

    What is lost widens the gap of the load steps that follow.

    >>> Wear(coefficient=1e-8).threshold
    0.0
    """

    coefficient: Annotated[
        Value,
        PER_STRESS,
        Field(
            description="k ≥ 0: worn volume over force and way, of both surfaces together "
            "(hardness is in it)"
        ),
    ]
    threshold: Annotated[
        Annotated[Number, Field(ge=0)],
        STRESS,
        Field(description="pressure up to which nothing is worn; beyond, what exceeds it wears"),
    ] = 0.0

    share: Annotated[
        Annotated[Number, Field(ge=0, le=1)] | None,
        FREE_AT_RESUME,
        Field(
            description="between bodies: part of the depth that the surface `on` loses, the other "
            "loses the rest; by default nothing is said of which has lost how much"
        ),
    ] = None

    def __post_init__(self) -> None:
        if isinstance(self.coefficient, float | int) and self.coefficient < 0:
            raise ValueError(f"coefficient = {self.coefficient} must be ≥ 0")
