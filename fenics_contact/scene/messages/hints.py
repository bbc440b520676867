"""Hints on what an unknown key or a refused value of a scene was meant to be."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fenics_contact.common.wording.suggestions import nearest, question
from fenics_contact.scene.messages.number_slips import meant_number
from fenics_contact.scene.messages.usual_names import meant_key, meant_value

_TRUTHS = {"true": "true", "yes": "true", "on": "true", "false": "false", "no": "false"}
_TRUTHS["off"] = "false"


def of_key(location: Sequence[Any], value: object, table: type) -> str:
    """Return what an unknown key was meant to be, and the keys that its table accepts.

    Args:
        location: Of pydantic, from the class ``table`` to the key.
        value: What the key was given.
        table: Class of the scene, or of a part of it.
    """
    from fenics_contact.scene.keys.reference import keys_of  # reads off classes that use this

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
    from fenics_contact.scene.keys.reference import keys_of
    from fenics_contact.scene.values import Profile

    for step in location:
        tables = next((k.tables for k in keys_of(table) if k.name == step), ()) or (table,)
        table = next((t for t in tables if t.__name__ in location), tables[0])
        table = Profile if step == Profile.__name__ else table
    return table


def _places_of(key: str) -> list[str]:
    """Where a scene has a key, in words."""
    from fenics_contact.scene.keys.reference import keys_of
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
