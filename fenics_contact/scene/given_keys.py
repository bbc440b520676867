"""Keys of a scene that do not have their defaults, and keys that a resumed run may change."""

from __future__ import annotations

import dataclasses
from typing import Any, Final


@dataclasses.dataclass(frozen=True)
class _FreeAtResume:
    """The type of the mark below."""


#: A mark in the annotation of a key, ``Annotated[Integer, FREE_AT_RESUME]``: a run may be resumed
#: with another value. Such keys say how an answer is computed, what is asked of it, or how long
#: load steps go on; the state that was saved does not depend on them.
FREE_AT_RESUME: Final = _FreeAtResume()


def given_keys(table: Any) -> dict[str, Any]:
    """Return the values that are not the defaults of their keys, by the names of the keys.

    Args:
        table: Of a scene class, or any other dataclass; keys without a default are always given.
    """
    values = {field.name: getattr(table, field.name) for field in dataclasses.fields(table)}
    defaults = {name: default_of(table, name) for name in values}
    return {name: value for name, value in values.items() if value != defaults[name]}


def key_of(table: type, name: str) -> str:
    """Key by which a scene file gives an attribute: ``from`` of one that is called ``from_``.

    Args:
        table: A scene class, or any other dataclass.
        name: Of the attribute.
    """
    described = getattr(table, "__pydantic_fields__", {}).get(name)
    return getattr(described, "alias", None) or name


def is_free_at_resume(table: Any, key: str) -> bool:
    """Whether a run may be resumed with another value of a key.

    Args:
        table: Of a scene class, or any other dataclass.
        key: Name of one of its keys.
    """
    field = getattr(type(table), "__pydantic_fields__", {}).get(key)
    return field is not None and FREE_AT_RESUME in field.metadata


def default_of(table: Any, key: str) -> Any:
    """The default of a key; of one that has none, what is no value of a scene.

    Args:
        table: Of a scene class, or any other dataclass.
        key: Name of one of its keys.
    """
    described = getattr(type(table), "__pydantic_fields__", {}).get(key)
    if described is not None:
        return described.get_default(call_default_factory=True)
    (field,) = (field for field in dataclasses.fields(table) if field.name == key)
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return field.default
