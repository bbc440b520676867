"""Scenes to other processes and to files: with functions, where these can be pickled."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import sys
from collections.abc import Iterator, Mapping
from typing import Any, SupportsIndex

# These pickle any function, once they are loaded.
_BY_VALUE = ("cloudpickle", "dill")


def picklable(self: Any, protocol: SupportsIndex) -> str | tuple[Any, ...]:
    """What ``pickle`` takes of an object of a scene, as its ``__reduce_ex__``.

    Args:
        self: The object.
        protocol: Of ``pickle``.

    Raises:
        PicklingError: A function in it cannot be pickled.
    """
    if not any(name in sys.modules for name in _BY_VALUE):
        for field in dataclasses.fields(self):
            for function in _functions(getattr(self, field.name)):
                _require_picklable(function, f"{type(self).__name__}.{field.name}")
    return object.__reduce_ex__(self, protocol)


def _functions(value: Any) -> Iterator[Any]:
    """Those in a value; other objects of the scene look after their own."""
    if isinstance(value, tuple | list):
        for entry in value:
            yield from _functions(entry)
    elif isinstance(value, Mapping):
        yield from _functions(list(value.values()))
    elif callable(value) and not dataclasses.is_dataclass(value):
        yield value


def _require_picklable(function: Any, where: str) -> None:
    try:
        pickle.dumps(function)
    except Exception as error:
        name = getattr(function, "__qualname__", type(function).__name__)
        raise pickle.PicklingError(
            f"{where} is a function that cannot be pickled, {name}: define it by def at the top "
            "of a module, not by lambda or within a function"
        ) from error


def copied(self: Any) -> Any:
    """What ``copy.copy`` makes of an object, which need not be one that can be pickled.

    Args:
        self: The object.
    """
    return _with(self, vars(self))


def deeply_copied(self: Any, memo: dict[int, Any]) -> Any:
    """What ``copy.deepcopy`` makes of it.

    Args:
        self: The object.
        memo: Of ``copy``.
    """
    return _with(self, copy.deepcopy(vars(self), memo))


def _with(self: Any, values: Mapping[str, Any]) -> Any:
    made = object.__new__(type(self))
    vars(made).update(values)
    return made
