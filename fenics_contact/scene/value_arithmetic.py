"""Multiples and derivatives of values: numbers, profiles, functions of position, lists of these."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from fenics_contact.scene.values import Profile, Value


def times(value: Any, factor: float) -> Any:
    """Return a value of a scene times a factor.

    Args:
        value: A number, profile or function, or a list of these.
        factor: A number.

    >>> times((2.0, Profile(along="x", at=(0, 1), values=(3, 4))), 10)[1].values
    (30.0, 40.0)
    """
    if isinstance(value, tuple):
        return tuple(times(one, factor) for one in value)
    if isinstance(value, Profile):
        return dataclasses.replace(value, values=tuple(factor * one for one in value.values))
    if callable(value):
        return _product(value, factor)
    return factor * value


def _product(function: Callable[..., Any], factor: float) -> Callable[..., Any]:
    return lambda *places: factor * function(*places)


def slope_of(value: Value, names: Sequence[str]) -> Value | None:
    """Return the derivative of a value by one of its numbers, itself a value.

    Args:
        value: A number, a profile or a function.
        names: Empty for the number itself; of a number of a profile its key there.

    Returns:
        None where there is no such derivative.

    >>> profile = Profile(along="x", at=(0, 2, 4), values=(100, 300, 0))
    >>> slope_of(profile, ["values", "1"]).values
    (0.0, 1.0, 0.0)
    """
    if isinstance(value, float | int) and not names:
        return 1.0
    if isinstance(value, Profile) and len(names) == 2 and names[0] == "values":
        unit = tuple(float(number == int(names[1])) for number in range(len(value.values)))
        return dataclasses.replace(value, values=unit)
    return None
