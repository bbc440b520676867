"""The kinds that a load of a scene may be of: what the value is under the key that it is given by.

What a load of a kind does to a body is a class in ``problem/loads``.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from fenics_contact.scene.values import (
    Kinematics,
    Profile,
    Value,
)


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


@dataclass(frozen=True)
class LoadKind:
    """A kind of loads, as the mark of its key in the annotations of ``Load``.

    The value is a number, a profile or a function of the place, or a list with one of these per
    axis. A kind whose value is a table, or to which the load is not proportional, overrides this.

    Attributes:
        words: Name of the kind in results, such as ``body force``.
        measured_by: Name of the quantity that tells how large a small change of the value is,
            such as ``max_contact_pressure``.
        keys: Of a kind that several keys give together: these, the first of which names it. Each
            has the mark, and the value is a mapping of those that are given.
        needs: Of these keys, those of which one must be given.
    """

    words: str
    measured_by: str
    keys: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()

    def words_of(self, value: Any) -> str:
        """Return the name of a load in results."""
        return self.words

    def require(self, value: Any) -> None:
        """Refuse a value that contradicts itself.

        Raises:
            ValueError: In words.
        """

    def require_model(self, value: Any, kinematics: Kinematics, key: str) -> None:
        """Refuse a value that a kinematic model cannot have.

        Args:
            value: As a scene gives it.
            kinematics: Such as ``axisymmetric``.
            key: Of the value, such as ``load[0].traction``; of several keys that of the load.

        Raises:
            ValueError: In words that begin with the key.
        """

    def components(self, value: Any) -> tuple[Value, ...]:
        """Return the components of a value, one of them where it has no direction."""
        return value if isinstance(value, tuple) else (value,)

    def vectors(self, value: Any, key: str) -> dict[str, tuple[Value, ...]]:
        """Return the lists in a value that need an entry per axis of the model, by their keys.

        Args:
            value: As a scene gives it.
            key: Its own, such as ``load[0].traction``; of several keys that of the load.
        """
        return {key: value} if isinstance(value, tuple) else {}

    def times(self, value: Any, factor: float) -> Any:
        """Return the value of a load that is a multiple of a given one."""
        return times(value, factor)

    def slopes(self, value: Any, names: Sequence[str]) -> tuple[Value, ...] | None:
        """Return the derivatives of the components by one number of a value.

        Args:
            value: As a scene gives it.
            names: The rest of the number's key, such as ``["1"]`` for the second component; empty
                for the value itself.

        Returns:
            None where there is no derivative by that number.
        """
        if not isinstance(value, tuple):
            slope = slope_of(value, names)
            return None if slope is None else (slope,)
        place = int(names[0])
        slope = slope_of(value[place], names[1:])
        zeros: list[Value] = [0.0] * len(value)
        return None if slope is None else (*zeros[:place], slope, *zeros[place + 1 :])


def kinds_of(table: Any) -> dict[str, LoadKind]:
    """Return the kinds whose marks the keys of a table have, by the keys that name them.

    Args:
        table: The class of the loads of a scene.
    """
    return {
        mark.keys[0] if mark.keys else name: mark
        for name, field in table.__pydantic_fields__.items()
        for mark in field.metadata
        if isinstance(mark, LoadKind)
    }
