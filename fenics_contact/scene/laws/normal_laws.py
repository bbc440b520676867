"""Laws across a contact that have a table of their own in a scene, ``contact.normal_law``.

A new one is a class here: what it says of itself are its keys.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from fenics_contact.scene.laws.formula import FUNCTIONS, Formula
from fenics_contact.scene.laws.kinds import chosen_by_kind
from fenics_contact.scene.units.dimensions import STIFFNESS_OF_POWER
from fenics_contact.scene.values import Number, Text, Value, scene_class


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


@scene_class
class PressureFormula(NormalLawTable):
    """A pressure of your own: a formula of the depth d, which is read and never run as Python.

    >>> PressureFormula(kind="formula", pressure="c * d^1.5", parameters={"c": 2e4}).pressure
    'c * d^1.5'
    """

    kind: Annotated[Literal["formula"], Field(description="which law it is")]
    pressure: Annotated[
        Text,
        Field(
            description="the pressure at a depth `d` > 0, 0 at d = 0: + - * / ^, brackets, "
            'numbers, parameters and `sqrt`, `exp`, `ln`, `min`, `max`; such as `"c * d^1.5"`'
        ),
    ]
    parameters: Annotated[
        Mapping[str, Number],
        Field(description="name → number, in the scene's units; such as `{ c = 2e4 }`"),
    ] = Field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in self.parameters:
            if not name.isidentifier() or name == "d" or name in FUNCTIONS:
                raise ValueError(f"parameters: '{name}' is no name that a formula could use")
        formula = Formula(self.pressure, ("d", *self.parameters))
        for name in self.parameters:
            if name not in formula.used:
                raise ValueError(f"parameters.{name} does not stand in the formula")
        if at_zero := formula.number({"d": 0.0, **self.parameters}):
            raise ValueError(f"pressure = '{self.pressure}' is {at_zero:g} at d = 0, not 0")


@scene_class
class OwnNormalLaw(NormalLawTable):
    """A law of a module of yours, which the command line must allow: ``--laws MODULE``.

    >>> OwnNormalLaw(kind="my_laws:Springs", parameters={"k": 2e4}).kind
    'my_laws:Springs'
    """

    kind: Annotated[
        str,
        Field(
            pattern=r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$",
            description="`MODULE:CLASS`, derived from `OwnEnergy`",
        ),
    ]
    parameters: Annotated[
        Mapping[str, Number],
        Field(description="name → number, in the scene's units; such as `{ k = 2e4 }`"),
    ] = Field(default_factory=dict)


if TYPE_CHECKING:
    AnyNormalLaw = NormalLawTable
else:
    AnyNormalLaw = chosen_by_kind(*NormalLawTable.__subclasses__())
