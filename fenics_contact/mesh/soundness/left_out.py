"""Parts of mesh files that are left out or missing, and cells of several files that overlap.

Cells of several mesh files that lie against each other or in each other. Each file is examined on
its own, after reading; what two of them have in one place shows only once they are put together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.mesh.readers.element_kinds import dimension_of_name
from fenics_contact.mesh.soundness.neighbours import Finding, Neighbours

# How files name the sides of cells, by their kind.
_SURFACES = {
    "inp": "*SURFACE or *NSET",
    "bdf": "BSURFS, or shells (CQUAD4, CTRIA3) with a property of their own on the sides of solids",
    "med": "groups of faces or of nodes; in the plane of edges",
    "msh": "physical groups of surfaces; in the plane of curves",
    "vtu": "cells of one dimension less, numbered by integer cell data",
    "xdmf": "cells of one dimension less, numbered by integer cell data",
}


def no_surface(kind: str) -> str:
    """A sentence, without its full stop, on a file that names no surface.

    Args:
        kind: Of the file, such as ``bdf``.
    """
    return (
        "names no surface, so that no contact, support or load can be put on one; add them to the "
        f"file: {_SURFACES[kind]}"
    )


def left_out(
    read: Mapping[str, Any],
    description: Mapping[str, Any],
    dimension: int,
    facet_kind: int,
    outside: Mapping[int, int],
) -> tuple[str, ...]:
    """A sentence, without its full stop, on elements that are neither cells nor sides of cells.

    Of Gmsh's files only those that stand in groups count: it saves lines and surfaces of its own.

    Args:
        read: Arrays of the process that has read the file.
        description: Its description.
        dimension: Of the model.
        facet_kind: Gmsh's type of the sides of the cells.
        outside: Part of the boundary → how many of its facets are no sides of cells.
    """
    counts: dict[str, int] = {}
    for name, parts in _elements(read, description, dimension).items():
        kind = int(name)
        if kind == facet_kind:
            count = sum(outside.get(int(part), 0) for part in np.unique(parts))
        else:
            count = len(parts)
        if count:
            counts[description["types"][name]] = count
    if not counts:
        return ()
    named = " and ".join(f"{count} of the type {name}" for name, count in counts.items())
    return (
        f"elements that are no sides of the cells are left out: {named}; only cells of dimension "
        f"{dimension} are solved, so that shells, membranes, beams and trusses resist nothing here",
    )


def _elements(
    read: Mapping[str, Any], description: Mapping[str, Any], dimension: int
) -> dict[str, Integers]:
    """Parts of the elements below the model's dimension by Gmsh's type, of those that count."""
    if description.get("lists_once"):
        return {
            name: read[f"parts_{name}"][read[f"numbers_{name}"] > 0]
            for name, called in description["types"].items()
            if dimension_of_name(called) in range(1, dimension)
        }
    named = [
        part
        for group in description["groups"]
        if group["dimension"] == dimension - 1
        for part in group["parts"]
    ]
    return {
        name: read[f"parts_{name}"][np.isin(read[f"parts_{name}"], named)]
        for name, called in description["types"].items()
        if dimension_of_name(called) == dimension - 1
    }


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
