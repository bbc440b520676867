"""Keys that are added to the tables of scenes at run time, as a new kind of load brings one."""

from __future__ import annotations

import copy
import dataclasses
from typing import Any

from pydantic.dataclasses import rebuild_dataclass

from fenics_contact.scene.keys.reference import keys_of
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.table import forget_dimensions

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
