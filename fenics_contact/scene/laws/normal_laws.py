"""Laws across a contact that have a table of their own in a scene, ``contact.normal_law``.

A new one is a class here: what it says of itself are its keys.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Union

from pydantic import Field

from fenics_contact.scene.units.dimensions import STIFFNESS_OF_POWER
from fenics_contact.scene.values import Number, Value, scene_class


class NormalLawTable:
    """What all of them have: the kind by which results and messages name the law."""

    kind: str


@scene_class
class NormalCompliance(NormalLawTable):
    """Normal compliance: surfaces that give way, p = c d^m at a depth d (Oden and Martins 1985).

    >>> NormalCompliance(kind="normal compliance", coefficient=4e4, exponent=2).exponent
    2.0
    """

    kind: Annotated[Literal["normal compliance"], Field(description="which law it is")]
    coefficient: Annotated[Value, STIFFNESS_OF_POWER, Field(description="c ≥ 0")]
    exponent: Annotated[
        Number, Field(ge=1, description="m ≥ 1; 1 is a `winkler` foundation of stiffness c")
    ]

    def __post_init__(self) -> None:
        if isinstance(self.coefficient, float | int) and self.coefficient < 0:
            raise ValueError(f"coefficient = {self.coefficient} must be ≥ 0")


if TYPE_CHECKING:
    AnyNormalLaw = NormalLawTable
else:  # pydantic tries them one after the other
    AnyNormalLaw = Union[tuple(NormalLawTable.__subclasses__())]  # noqa: UP007
