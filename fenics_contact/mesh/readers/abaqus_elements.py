"""Elements of an Abaqus file by their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.mesh.readers.element_kinds import dimension_of
from fenics_contact.mesh.readers.file_lines import Line

_NONE: Integers = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements by Gmsh's type.

    Attributes:
        nodes: Of each element, shape (elements, nodes).
        numbers: Of each element.
        are_shells: Whether its sides are its faces.
    """

    nodes: dict[int, Integers]
    numbers: dict[int, Integers]
    are_shells: dict[int, Flags]

    @property
    def dimension(self) -> int:
        """The largest of all."""
        return max(map(dimension_of, self.nodes), default=0)

    def rows(self, numbers: Integers) -> dict[int, Integers]:
        """Gmsh's type → rows of elements by their numbers; types without any are left out."""
        found = {
            kind: np.flatnonzero(np.isin(of_kind, numbers))
            for kind, of_kind in self.numbers.items()
        }
        return {kind: rows for kind, rows in found.items() if len(rows)}


class Blocks:
    """Elements as they come in."""

    def __init__(self) -> None:
        self._blocks: list[tuple[Line, Integers, int, Integers, bool]] = []

    def add(
        self, line: Line, numbers: Sequence[int], kind: int, nodes: Any, are_shells: bool
    ) -> None:
        """Add elements of one type.

        Args:
            line: Of their keyword.
            numbers: Of the elements.
            kind: Gmsh's type; 0 of what is no cell nor facet.
            nodes: Shape (elements, nodes).
            are_shells: Whether their sides are their faces.
        """
        found = np.array(numbers, dtype=np.int64)
        self._blocks.append((line, found, kind, np.asarray(nodes, np.int64), are_shells))

    def numbers(self) -> Integers:
        """Return the numbers of all elements, in order.

        Raises:
            RefusedError: Two elements have the same.
        """
        numbers = np.sort(np.concatenate([_NONE, *(block[1] for block in self._blocks)]))
        doubled = numbers[1:][numbers[1:] == numbers[:-1]]
        for line, found, *_ in self._blocks if len(doubled) else ():
            if np.isin(doubled[0], found):
                raise line.error(f"the element {doubled[0]} is defined twice")
        return numbers

    def joined(self) -> Elements:
        """All cells and facets, by type."""
        nodes, numbers, are_shells = {}, {}, {}
        for kind in dict.fromkeys(block[2] for block in self._blocks if block[2]):
            of_kind = [block for block in self._blocks if block[2] == kind]
            numbers[kind] = np.concatenate([block[1] for block in of_kind])
            nodes[kind] = np.concatenate([block[3] for block in of_kind])
            are_shells[kind] = np.repeat(
                [block[4] for block in of_kind], [len(block[1]) for block in of_kind]
            )
        return Elements(nodes, numbers, are_shells)
