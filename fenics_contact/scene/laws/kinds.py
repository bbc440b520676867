"""Tables of which ``kind`` says what other keys they have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Union, get_args

from pydantic import Discriminator, Tag


def chosen_by_kind(*tables: Any) -> Any:
    """A key's type: one of some classes of scenes, whichever the ``kind`` that is given names.

    What is wrong with a table is then said of its own class, and not of all of them.

    Args:
        tables: The classes; the annotation of ``kind`` is a literal with its names, or in the
            last one a text, of a class of the user's own.
    """
    of_kind = {kind: table for table in tables for kind in _kinds(table)}
    own = next((table for table in tables if not _kinds(table)), None)
    words = ", ".join(f"'{kind}'" for kind in of_kind) + (", 'MODULE:CLASS'" if own else "")
    tagged = tuple(Annotated[table, Tag(table.__name__)] for table in tables)

    def named(value: Any) -> str | None:
        kind = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
        table = of_kind.get(kind, own if ":" in kind else None) if isinstance(kind, str) else None
        return None if table is None else table.__name__

    return Annotated[
        Union[tagged],  # noqa: UP007
        Discriminator(
            named,
            custom_error_type="kind",
            custom_error_message=f"a table whose kind is one of {words}",
        ),
    ]


def _kinds(table: Any) -> tuple[str, ...]:
    """The names that a class takes for its kind; none where it takes any."""
    found: tuple[str, ...] = get_args(table.__pydantic_fields__["kind"].annotation)
    return found
