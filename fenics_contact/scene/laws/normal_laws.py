"""Laws across a contact that have a table of their own in a scene, ``contact.normal_law``.

A new one is a class here: what it says of itself are its keys.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field

from fenics_contact.scene.laws.law_tables import (
    LANGUAGE,
    ClassName,
    Parameters,
    TablesByKind,
    require_formula,
)
from fenics_contact.scene.units.dimensions import STIFFNESS_OF_POWER
from fenics_contact.scene.values import Number, Text, Value, scene_class


class NormalLawTable:
    """Base class of the tables of laws across a contact, which results name by ``kind``.

    Attributes:
        kind: By which results and messages name the law.
        fits_motion: Whether bodies in motion may have it.
    """

    kind: str
    fits_motion: ClassVar[bool] = False


@scene_class
class NormalCompliance(NormalLawTable):
    """Normal compliance: surfaces that give way, p = c d^m at a depth d (Oden and Martins 1985).

    >>> NormalCompliance(kind="normal compliance", coefficient=4e4, exponent=2).exponent
    2.0
    """

    fits_motion: ClassVar[bool] = True
    kind: Annotated[Literal["normal compliance"], Field(description="which law it is")]
    coefficient: Annotated[Value, STIFFNESS_OF_POWER, Field(description="c ≥ 0")]
    exponent: Annotated[
        Number, Field(ge=1, description="m ≥ 1; 1 is a `winkler` foundation of stiffness c")
    ]

    def __post_init__(self) -> None:
        if isinstance(self.coefficient, float | int) and self.coefficient < 0:
            raise ValueError(f"coefficient = {self.coefficient} must be ≥ 0")


@scene_class
class PressureFormula(NormalLawTable):
    """A pressure of your own: a formula of the depth d, which is read and never run as Python.

    >>> PressureFormula(kind="formula", pressure="c * d^1.5", parameters={"c": 2e4}).pressure
    'c * d^1.5'
    """

    kind: Annotated[Literal["formula"], Field(description="which law it is")]
    pressure: Annotated[
        Text, Field(description=f"the pressure at a depth `d` > 0, 0 at d = 0: {LANGUAGE}")
    ]
    parameters: Parameters = Field(default_factory=dict)

    def __post_init__(self) -> None:
        require_formula("pressure", self.pressure, self.parameters, {"d": 0.0})


@scene_class
class OwnNormalLaw(NormalLawTable):
    """A law of a module of yours, which the command line must allow: ``--laws MODULE``.

    >>> OwnNormalLaw(kind="my_laws:Springs", parameters={"k": 2e4}).kind
    'my_laws:Springs'
    """

    kind: Annotated[
        ClassName, Field(description="`MODULE:CLASS`, derived from `UserContactEnergy`")
    ]
    parameters: Parameters = Field(default_factory=dict)


#: All of them, of which there can be more later.
NORMAL_LAWS = TablesByKind(*NormalLawTable.__subclasses__())
if TYPE_CHECKING:
    AnyNormalLaw = NormalLawTable
else:
    AnyNormalLaw = Annotated[Any, NORMAL_LAWS]
