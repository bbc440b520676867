"""Pydantic's list of errors of a scene, as one sentence."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from fenics_contact.scene.messages.hints import of_key, of_value

_IN_A_FILE = {
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "string_type": "a text, in quotes",
    "string_too_short": "a text that is not empty",
    "finite_number": "a finite number",
    "dataclass_type": "a table",
    "tuple_type": "a list",
    "mapping_type": "a table",
    "dict_type": "a table",
    "none_required": "left out",
}
_IN_PYTHON = _IN_A_FILE | {
    "bool_type": "True or False",
    "string_type": "a text",
    "dataclass_type": "a {class_name}",
    "dataclass_exact_type": "a {class_name}",
    "mapping_type": "a dictionary",
    "dict_type": "a dictionary",
    "none_required": "None",
    "callable_type": "a function",
}


def sentence(
    error: ValidationError, data: Mapping[str, Any], table: type, names: Sequence[str] = ()
) -> str:
    """Return what is wrong first, in one sentence: key, value, accepted values.

    Args:
        error: Of pydantic.
        data: What the user gave, by keys.
        table: The class that it is to be.
        names: In Python, its keys in the order of arguments; there, functions are welcome.
    """
    every: list[Any] = [
        problem | {"loc": _by_name(problem["loc"], names)}
        for problem in error.errors(include_url=False)
    ]
    problems = [p for p in every if names or not _beside_the_point(p)] or every
    unknown = [p for p in problems if p["type"] == "unexpected_keyword_argument"]
    first = (unknown or problems)[0]
    path = _known_path(first["loc"], data)
    key = written(path)
    if unknown:
        return f"unknown key '{key}'{of_key(first['loc'], _value_at(path, data), table)}"
    if first["type"] == "unexpected_positional_argument":
        return f"too many values: it has {len(names)} keys, {', '.join(names)}"
    if first["type"] == "multiple_argument_values":
        return f"{key} is given twice"
    # A value of several possible types fails once for each: say them together.
    value = _value_at(path, data)
    same = [p for p in problems if _known_path(p["loc"], data) == path]
    if same[0]["type"] == "missing":
        return f"the key '{written([*path, same[0]['loc'][-1]])}' is missing"
    words = _IN_PYTHON if names else _IN_A_FILE
    messages = " or ".join(dict.fromkeys(_plain(problem, words) for problem in same))
    if same[0]["type"] == "value_error":
        return f"{key}: {messages}" if key else messages
    if first["loc"][-1] == "[key]":
        return f"unknown key '{key}': must be {messages}{of_value(str(path[-1]), same)}"
    hint = "" if names else of_value(value, same, key)
    return f"{key} = {_shown(value)}: must be {messages}{hint}"


def _by_name(location: tuple[Any, ...], names: Sequence[str]) -> tuple[Any, ...]:
    """A location whose first step is an argument's name, not its number."""
    if location and isinstance(location[0], int) and location[0] < len(names):
        return (names[location[0]], *location[1:])
    return location


def _beside_the_point(problem: Any) -> bool:
    """No function fits in a file, and a table is not a failed number."""
    is_table = isinstance(problem["input"], dict)
    return problem["type"] == "callable_type" or (problem["type"] == "float_type" and is_table)


def _shown(value: object) -> str:
    """A value, in so many words at the most."""
    return "a function" if callable(value) else reprlib.Repr(maxstring=60, maxother=60).repr(value)


def _plain(problem: Any, words: Mapping[str, str]) -> str:
    """Pydantic's message in this project's words, to follow 'must be'."""
    if problem["type"] in ("too_short", "too_long"):
        limit, number = next(item for item in problem["ctx"].items() if item[0].endswith("_length"))
        return f"of {'at least' if limit.startswith('min') else 'at most'} {number} entries"
    message: str = words.get(problem["type"], problem["msg"])
    message = message.format(**problem.get("ctx", {})) if problem["type"] in words else message
    for prefix in ("Value error, ", "Input should be "):
        message = message.removeprefix(prefix)
    return message


def _value_at(path: Sequence[Any], data: Any) -> Any:
    for step in path:
        data = data[step]
    return data


def _known_path(location: tuple[Any, ...], data: Any) -> list[Any]:
    """The part of pydantic's location that exists in the user's data."""
    path: list[Any] = []
    for step in location:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            continue  # the name of a type that was tried, or a missing key
        path.append(step)
    return path


def written(path: Sequence[object]) -> str:
    """A location as users write it: ``contact[0].pressure``."""
    text = ""
    for step in path:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else str(step)
    return text
