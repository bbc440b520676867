"""Pydantic's list of errors of a scene as one sentence, with what a key was meant to be."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from fenics_contact.common.wording import nearest, question
from fenics_contact.scene.messages.usual_names import meant_key, meant_number, meant_value

_TRUTHS = {"true": "true", "yes": "true", "on": "true", "false": "false", "no": "false"}
_TRUTHS["off"] = "false"


def of_key(location: Sequence[Any], value: object, table: type) -> str:
    """Return what an unknown key was meant to be, and the keys that its table accepts.

    Args:
        location: Of pydantic, from the class ``table`` to the key.
        value: What the key was given.
        table: Class of the scene, or of a part of it.
    """
    from fenics_contact.scene.reference import keys_of  # reads off classes that use this

    inner = _class_at(location[:-1], table)
    key = str(location[-1])
    accepted = [known.name for known in keys_of(inner)]
    usual, elsewhere = meant_key(inner.__name__, key, value), _places_of(key)
    plurals = [word for word in accepted if word.rstrip("s") == key.rstrip("s")]
    if usual:
        hint = f" (did you mean {usual}?)"
    elif plurals:
        hint = question(key, plurals)
    elif len(elsewhere) == 1:
        hint = f" ({elsewhere[0]})"
    else:
        hint = question(key, accepted)
    return f"{hint}; accepted here: {', '.join(accepted)}"


def _class_at(location: Sequence[Any], table: type) -> type:
    """The class of the table at a location."""
    from fenics_contact.scene.reference import keys_of
    from fenics_contact.scene.values import Profile

    for step in location:
        tables = next((k.tables for k in keys_of(table) if k.name == step), ()) or (table,)
        table = next((t for t in tables if t.__name__ in location), tables[0])
        table = Profile if step == Profile.__name__ else table
    return table


def _places_of(key: str) -> list[str]:
    """Where a scene has a key, in words."""
    from fenics_contact.scene.reference import keys_of
    from fenics_contact.scene.scene import Scene

    def search(table: type, header: str, of: str) -> Iterator[str]:
        for known in keys_of(table):
            inner = f"{of}{known.name}"
            if known.name == key:
                yield f"write [{inner}]" if known.tables and of else f"it is a key of {header}"
            for below in known.tables:
                brackets = f"[[{inner}]]" if known.is_list and not of else f"[{inner}]"
                yield from search(below, brackets, f"{inner}.")

    top = "the scene itself, so it stands before the first [table]"
    return list(dict.fromkeys(search(Scene, top, "")))


def of_value(value: object, problems: Sequence[Any], key: str = "") -> str:
    """Return what a refused value was meant to be, as a question in brackets, or nothing.

    Args:
        value: As the file has it.
        problems: Of pydantic, one for each type that was tried.
        key: Where it stands; by default the value is a key itself.
    """
    kinds = {problem["type"] for problem in problems}
    if isinstance(value, str):
        return _of_text(value, problems, kinds)
    if kinds == {"tuple_type"} and isinstance(value, Mapping) and "." in key:
        return " (an entry for each axis; a table may be one of them, as in [{ … }, 0])"
    if kinds == {"tuple_type"} and isinstance(value, Mapping):
        return f" (write [[{key}]], also where there is one)"
    if kinds == {"dataclass_type"} and isinstance(value, list) and "[" not in key:
        return f" (there is one at most: write [{key}], not [[{key}]])"
    if kinds == {"tuple_type"} and not isinstance(value, list):
        return " (in brackets, as in [1, 2])"
    return ""


def _of_text(text: str, problems: Sequence[Any], kinds: set[str]) -> str:
    accepted = [
        word
        for problem in problems
        for word in re.findall(r"'([^']*)'", problem.get("ctx", {}).get("expected", ""))
    ]
    if near := meant_value(text, accepted) or next(iter(nearest(text, accepted)), ""):
        return f" (did you mean '{near}'?)"
    if kinds & {"float_type", "int_type"} and (number := meant_number(text)):
        return f" (did you mean the number {number}?)"
    if "bool_type" in kinds and (truth := _TRUTHS.get(text.casefold())):
        return f" (did you mean {truth}, without quotes?)"
    if kinds == {"tuple_type"}:
        return f' (did you mean ["{text}"]?)'
    return ""


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
    problems = _of_nearest_tables(problems, data)
    unknown = [p for p in problems if _is_unknown(p)]
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
    """No function fits in a file, and a table is not a failed number.

    A list that lacks only its wrong entries is not too short, as pydantic 2.10 has it.
    """
    kind, given = problem["type"], problem["input"]
    is_table = isinstance(given, dict)
    long_enough = kind == "too_short" and len(given) >= problem["ctx"]["min_length"]
    return kind == "callable_type" or (kind == "float_type" and is_table) or long_enough


def _of_nearest_tables(problems: Sequence[Any], data: Mapping[str, Any]) -> list[Any]:
    """Problems without those of tables that a value is not meant to be, where it may be several.

    It is meant to be the one that knows most of its keys, and of these the one that has the fewest
    problems.

    Args:
        problems: Of pydantic.
        data: What the user gave, by keys.
    """
    found: dict[Any, dict[str, list[Any]]] = {}
    for problem in problems:
        for path, name in _tables_tried(problem, data):
            found.setdefault(path, {}).setdefault(name, []).append(problem)
    left_out = []
    for tables in found.values():
        nearest_one = min(tables.values(), key=lambda of: (sum(map(_is_unknown, of)), len(of)))
        left_out += [one for of in tables.values() if of is not nearest_one for one in of]
    return [problem for problem in problems if not any(problem is one for one in left_out)]


def _tables_tried(problem: Any, data: Any) -> Iterator[tuple[tuple[Any, ...], str]]:
    """Where a value was taken for a table that has a problem, and the name of its class."""
    path: tuple[Any, ...] = ()
    location = problem["loc"]
    for number, step in enumerate(location):
        is_last = number == len(location) - 1
        try:
            data, path = data[step], (*path, step)
        except (KeyError, IndexError, TypeError):
            if isinstance(data, Mapping) and (not is_last or problem["type"] == "value_error"):
                yield path, step


def _is_unknown(problem: Any) -> bool:
    return bool(problem["type"] == "unexpected_keyword_argument")


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
