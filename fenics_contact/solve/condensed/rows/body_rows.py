"""The rows that a condensed body keeps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from fenics_contact.solve.condensed.rows.groups import GivenRows, RowGroup
from fenics_contact.solve.condensed.rows.row import RowMaker

_T = TypeVar("_T")


class BodyRows:
    """Rows by name, each made when an answer asks for it first; collective.

    Attributes:
        maker: Makes them.
        given: Those of what scenes give.

    Args:
        maker: Makes them.
    """

    def __init__(self, maker: RowMaker) -> None:
        self.maker, self.given = maker, GivenRows(maker)
        self._groups: dict[str, RowGroup] = {}
        self._found: dict[str, Any] = {}

    def group(self, name: str, is_portable: bool = True) -> RowGroup:
        """The rows of a name, kept.

        Args:
            name: Of the rows.
            is_portable: Whether their keys mean the same on any number of ranks.
        """
        return self._groups.setdefault(name, RowGroup(self.maker, is_portable))

    def once(self, name: str, make: Callable[[], _T]) -> _T:
        """What is worked out for rows of this body, once.

        Args:
            name: Of it.
            make: Works it out.
        """
        if name not in self._found:
            self._found[name] = make()
        kept: _T = self._found[name]
        return kept

    @property
    def groups(self) -> Mapping[str, RowGroup]:
        """All rows that are kept, by name, but those of what is given."""
        return self._groups
