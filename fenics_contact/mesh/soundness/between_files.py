"""Cells of several mesh files that lie against each other or in each other.

Each file is examined on its own, after reading; what two of them have in one place shows only once
they are put together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.mesh.soundness.neighbours import Finding, Neighbours


@dataclass(eq=False)
class BetweenFiles(Neighbours):
    """Looks at pairs of cells that are of different files.

    Attributes:
        names: Of the files.
        file_of_cell: Which file each cell is of, as a place among these.
    """

    names: list[str]
    file_of_cell: Integers

    def __post_init__(self) -> None:
        super().__post_init__()
        self._pieces = self.file_of_cell

    def findings(self) -> Iterator[Finding]:
        """Faults of cells of two files, one of a kind: the same cells, seams and overlaps."""
        yield from self._in_one_place()
        yield from self._seams()
        yield from self._overlaps()

    def _one(self, cell: int) -> str:
        return f"{super()._one(cell)} of '{self.names[self.file_of_cell[cell]]}'"

    def _both(self, cell: int, other: int) -> str:
        first, second = sorted((cell, other), key=lambda one: int(self.file_of_cell[one]))
        return f"{self._one(first)} and {self._one(second)}"

    def _are_compared(self, cells: Integers, others: Integers) -> Flags:
        return np.asarray(self.file_of_cell[cells] != self.file_of_cell[others])
