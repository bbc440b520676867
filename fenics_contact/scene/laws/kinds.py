"""Tables of which ``kind`` says what other keys they have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Union, get_args

from pydantic import Discriminator, GetCoreSchemaHandler, GetJsonSchemaHandler, Tag, TypeAdapter
from pydantic_core import core_schema


class TablesByKind:
    """Marks a key that takes a table of one of some classes, whichever its ``kind`` names.

    There can be more classes later. What is wrong with a table is said of its own class, and not of
    all of them.

    Args:
        tables: The classes; the annotation of ``kind`` is a literal with its names, or of one of
            them a text, of a class of the user's own.
    """

    def __init__(self, *tables: Any) -> None:
        self._tables = tables
        self._adapter: TypeAdapter[Any] | None = None

    @property
    def tables(self) -> tuple[Any, ...]:
        """All classes, that of a user's own laws last."""
        return tuple(sorted(self._tables, key=lambda table: not kinds_of(table)))

    def register(self, table: Any) -> None:
        """Accept tables of one more class.

        Args:
            table: A scene class, whose ``kind`` is a literal.

        Raises:
            ValueError: There is a table of this kind.
        """
        known = [kind for other in self._tables for kind in kinds_of(other)]
        if twice := [kind for kind in kinds_of(table) if kind in known]:
            raise ValueError(f"there is a table of the kind '{twice[0]}'")
        self._tables, self._adapter = (*self._tables, table), None

    def unregister(self, table: Any) -> None:
        """Take out a class that was registered."""
        self._tables = tuple(one for one in self._tables if one is not table)
        self._adapter = None

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self._made)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return handler(self._present.core_schema)

    def _made(self, value: Any) -> Any:
        return self._present.validate_python(value)

    @property
    def _present(self) -> TypeAdapter[Any]:
        """One of the present classes, by the kind that is given."""
        if self._adapter is None:
            self._adapter = TypeAdapter(_chosen_by_kind(self.tables))
        return self._adapter


def _chosen_by_kind(tables: tuple[Any, ...]) -> Any:
    of_kind = {kind: table for table in tables for kind in kinds_of(table)}
    own = next((table for table in tables if not kinds_of(table)), None)
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


def kinds_of(table: Any) -> tuple[str, ...]:
    """The names that a class takes for its kind; none where it takes any."""
    found: tuple[str, ...] = get_args(table.__pydantic_fields__["kind"].annotation)
    return found
