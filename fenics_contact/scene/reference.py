"""Reference of the keys of a scene, read off the classes, and keys that are added to these.

Reference of the keys of a scene, read off the classes: for ``docs/scene.md`` and for hints.
``python docs/make_scene.py`` writes the page.
"""

from __future__ import annotations

import copy
import dataclasses
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from annotated_types import Ge, Gt, Le, Lt
from pydantic.dataclasses import rebuild_dataclass
from pydantic.fields import FieldInfo

from fenics_contact.scene.given_keys import key_of
from fenics_contact.scene.laws.law_tables import TablesByKind
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import description_of, dimension_of
from fenics_contact.scene.units.table import forget_dimensions
from fenics_contact.scene.values import OneOf, PathFunction, PositionFunction, Profile

Mark = typing.TypeVar("Mark")


@dataclass(frozen=True)
class Key:
    """One key of a scene: its name, what it takes, its default and its meaning."""

    name: str
    accepts: str
    default: str
    description: str
    tables: tuple[type, ...]
    is_list: bool


def keys_of(table: type) -> list[Key]:
    """The keys that a scene class accepts, in order."""
    hints = typing.get_type_hints(table, include_extras=True)
    said = {name: description_of(field) for name, field in _fields(table).items()}
    return [
        dataclasses.replace(_key(field, hints[field.name], said), name=key_of(table, field.name))
        for field in dataclasses.fields(table)
    ]


def measured_by(key: str, *tables: type) -> str:
    """Return the dimension of a key's numbers, such as ``stress``; empty for a pure number.

    Args:
        key: Of one of the tables.
        tables: Scene classes, the first of which that has the key says it.
    """
    fields = next((found for table in tables if key in (found := _fields(table))), {})
    dimension = dimension_of(fields[key]) if fields else None
    return "" if dimension is None else dimension.words


def _fields(table: Any) -> dict[str, FieldInfo]:
    fields: dict[str, FieldInfo] = table.__pydantic_fields__
    return fields


def _key(field: Any, hint: Any, said: Mapping[str, str]) -> Key:
    plain, _ = _unwrap(hint)
    tables = tuple(c for c in _classes(hint) if c is not Profile)
    return Key(
        name=field.name,
        accepts=_accepted(hint),
        default=_default(field),
        description=said[field.name],
        tables=tables,
        is_list=typing.get_origin(plain) is tuple,
    )


def _unwrap(hint: Any) -> tuple[Any, list[Any]]:
    """Split an annotated type into the bare type and its annotations."""
    information: list[Any] = []
    while typing.get_origin(hint) is typing.Annotated:
        hint, *more = typing.get_args(hint)
        information += more
    return hint, information


def _marked(information: list[Any], mark: type[Mark]) -> Mark | None:
    """Return the annotation of a type that is of a class, if there is one."""
    return next((found for found in information if isinstance(found, mark)), None)


def _classes(hint: Any) -> list[type]:
    """Scene classes inside a type."""
    hint, information = _unwrap(hint)
    if by_kind := _marked(information, TablesByKind):
        return list(by_kind.tables)
    if dataclasses.is_dataclass(hint):
        return [typing.cast(type, hint)]
    return [found for part in typing.get_args(hint) for found in _classes(part)]


def _default(field: Any) -> str:
    default = field.default
    if isinstance(default, FieldInfo):
        factory = default.default_factory
        if factory is None:
            return "required"
        return "none" if factory is dict else "see below"
    if default is dataclasses.MISSING:
        return "required" if field.default_factory is dataclasses.MISSING else "none"
    if default in ((), None, ""):
        return "none"
    return f"`{default!r}`".replace("'", '"')


def _accepted(hint: Any) -> str:
    """Return in words which values a key takes."""
    plain, information = _unwrap(hint)
    origin, parts = typing.get_origin(plain), typing.get_args(plain)
    if origin is typing.Literal:
        return " or ".join(f'`"{word}"`' for word in parts)
    if origin in (typing.Union, types.UnionType):
        unsaid = (type(None), PositionFunction, PathFunction)
        words = [_accepted(part) for part in parts if part not in unsaid]
        return " or ".join(dict.fromkeys(words))
    if origin is tuple:
        return f"list of {_accepted(parts[0])}".replace("list of table", "list of tables")
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return f"table of name = {_accepted(parts[1])}"
    if dataclasses.is_dataclass(plain):
        return "a profile" if plain is Profile else "table"
    if _marked(information, TablesByKind):
        return "table"
    if choices := _marked(information, OneOf):
        return " or ".join(f'`"{word}"`' for word in choices.names())
    name = {float: "number", int: "whole number", str: "text", bool: "`true` or `false`"}[plain]
    return name + _bounds(information)


def _bounds(information: list[Any]) -> str:
    words = []
    flat = [m for i in information for m in (i.metadata if isinstance(i, FieldInfo) else [i])]
    for limit in flat:
        if isinstance(limit, Gt):
            words.append(f"> {limit.gt:g}")
        elif isinstance(limit, Ge):
            words.append(f"≥ {limit.ge}")
        elif isinstance(limit, Lt):
            words.append(f"< {limit.lt:g}")
        elif isinstance(limit, Le):
            words.append(f"≤ {limit.le}")
    return f" {' and '.join(words)}" if words else ""


def render() -> str:
    """The reference page, in Markdown."""
    text = [
        "# Scene reference",
        "",
        "Generated from the code by `python docs/make_scene.py`; do not edit.",
        "",
        "A scene is a TOML file, or the same frozen dataclasses in Python. Unknown keys are",
        "errors. Units are yours, consistent; nothing is converted, unless the scene has `[units]`",
        "(see [Units](howto/units.md)): then a number may also be a text with a unit of what its",
        "key measures, which stands in brackets. Where a *profile* is accepted, a table varies the",
        "value along an axis, and Python also takes a function of the points (array of shape",
        "(3, n) in, n values out). In place of a load path, a table, Python also takes a function",
        "of the pseudo-time (a number in, its factor out).",
    ]
    text += _section("The scene", "top level", Scene)
    for key in keys_of(Scene):
        for table in key.tables:
            header = f"[[{key.name}]]" if key.is_list else f"[{key.name}]"
            text += _section(f"`{header}`", "a list" if key.is_list else "a table", table)
            for inner in keys_of(table):
                for of_inner in inner.tables:
                    title = f"`[{key.name}.{inner.name}]`{_of_kind(inner, of_inner)}"
                    text += _section(title, f"a table of the last {header}", of_inner)
    text += _section("A profile", "in place of a number", Profile)
    text += ["", "```toml", 'pressure = { along = "x", at = [0, 8], values = [100, 300] }', "```"]
    return "\n".join(text) + "\n"


def _of_kind(key: Key, table: type) -> str:
    """Return the kind by which a table of a key is told from its others; empty for the only one."""
    kind = next((one for one in keys_of(table) if one.name == "kind"), None)
    return f", kind = {kind.accepts}" if kind is not None and len(key.tables) > 1 else ""


def _section(title: str, subtitle: str, table: type) -> list[str]:
    document = (table.__doc__ or "").strip().splitlines()[0]
    lines = ["", f"## {title} ({subtitle})", "", document, ""]
    lines += ["| key | takes | default | meaning |", "|---|---|---|---|"]
    lines += [
        f"| `{k.name}` | {k.accepts} | {k.default} | {k.description} |" for k in keys_of(table)
    ]
    return lines


# Methods of a dataclass that are written out for its fields.
_WRITTEN_OUT = ("__dataclass_fields__", "__eq__", "__hash__", "__match_args__", "__repr__")


def add_key(table: type, name: str, annotation: Any) -> None:
    """Have a table of scenes accept one more key, which a scene may leave out.

    Files, Python, messages, units, the schema and the reference have it from then on.

    Args:
        table: A class of a scene, such as ``Load``.
        name: The key.
        annotation: Type of its value, which may be None, with its dimension and description.

    Raises:
        ValueError: The table has such a key.
    """
    fields = {field.name: copy.copy(field) for field in dataclasses.fields(table)}
    if name in fields:
        raise ValueError(f"{table.__name__} has a key '{name}'")
    table.__annotations__[name] = annotation
    _set_fields(table, {**fields, name: dataclasses.field(default=None)})


def remove_key(table: type, name: str) -> None:
    """Take out a key that was added."""
    fields = {field.name: copy.copy(field) for field in dataclasses.fields(table)}
    del fields[name], table.__annotations__[name]
    delattr(table, name)
    _set_fields(table, fields)


def _set_fields(table: Any, fields: dict[str, Any]) -> None:
    """Give a table other keys, and rebuild the validators of all tables that hold it."""
    holders = _holders(Scene, table)
    types = [(name, table.__annotations__[name], field) for name, field in fields.items()]
    like = dataclasses.make_dataclass(table.__name__, types, frozen=True)
    for name in _WRITTEN_OUT:
        setattr(table, name, like.__dict__[name])
    for name, field in fields.items():
        if field.default is not dataclasses.MISSING:
            setattr(table, name, field.default)
    for holder in holders:
        words_errors = holder.__init__  # of scene_class, which pydantic would replace
        rebuild_dataclass(holder, force=True)
        holder.__init__ = words_errors
        forget_dimensions(holder)


def _holders(part: Any, table: type) -> list[Any]:
    """Classes of a scene that hold a table, itself the first and the outermost the last.

    Args:
        part: The outermost class.
        table: The table that is sought.
    """
    if part is table:
        return [part]
    tables = dict.fromkeys(inner for key in keys_of(part) for inner in key.tables)
    found = [holder for inner in tables for holder in _holders(inner, table)]
    return [*dict.fromkeys(found), part] if found else []
