"""Parts of the tables of users' own laws: parameters, a formula, or a class of a module."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from fenics_contact.scene.laws.formula import FUNCTIONS, Formula
from fenics_contact.scene.values import Number

#: The kind of a law of a user's own: the name of its class.
ClassName = Annotated[str, Field(pattern=r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$")]
Parameters = Annotated[
    Mapping[str, Number],
    Field(description="name → number, in the scene's units; such as `{ c = 2e4 }`"),
]
#: What a formula may have, for descriptions of keys.
LANGUAGE = (
    "+ - * / ^, brackets, numbers, parameters and `sqrt`, `exp`, `ln`, `min`, `max`; it is read, "
    "and never run as Python"
)


def require_formula(
    key: str, text: str, parameters: Mapping[str, float], zero: Mapping[str, float]
) -> None:
    """See that a formula is one, has all parameters, and is 0 where it has to be.

    Args:
        key: That has the formula.
        text: Of the formula.
        parameters: That it is given.
        zero: Its variables, at which it must be 0.

    Raises:
        ValueError: It is not.
    """
    for name in parameters:
        if not name.isidentifier() or name in zero or name in FUNCTIONS:
            raise ValueError(f"parameters: '{name}' is no name that a formula could use")
    formula = Formula(text, (*zero, *parameters))
    for name in parameters:
        if name not in formula.used:
            raise ValueError(f"parameters.{name} does not stand in the formula")
    if found := formula.number({**zero, **parameters}):
        first = next(iter(zero))
        raise ValueError(f"{key} = '{text}' is {found:g} at {first} = 0, not 0")
