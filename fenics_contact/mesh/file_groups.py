"""Groups that files and scenes make of parts, what files leave out, and cells that overlap.

Each file is examined on its own, after reading; what two of them have in one place shows only once
they are put together.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.mesh.neighbours import Finding, Neighbours
from fenics_contact.mesh.readers.element_kinds import NAMES, dimension_of_name
from fenics_contact.mesh.sides_by_angle import ANGLE
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.scene.scene import MeshSource

_BOUNDARY_PARTS = {2: "curve", 3: "surface"}
# What follows a name of points, or of edges in space, that something else has, too.
_SLENDER = (".points", ".edges")
_BODY = "body"  # the whole body's group, where the file names none


# Begin and end of a straight piece of an edge, the same of a point (length).
Piece = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class PartTags:
    """Tags of the parts of a file.

    Attributes:
        dimension: Of the body.
        body: Part of the body → tags of its cells.
        boundary: Part of the boundary → tags of its facets.
        outside: Part of the boundary → how many of its facets are no sides of cells.
        places: Dimension and part of points, and of edges in space → their pieces, as of ``Group``.
    """

    dimension: int
    body: Mapping[int, set[int]]
    boundary: Mapping[int, set[int]]
    outside: Mapping[int, int]
    places: Mapping[tuple[int, int], Sequence[Piece]]

    def group(self, dimension: int, parts: Iterable[int], centre: Sequence[float] = ()) -> Group:
        """The group of some parts of the body, or of its boundary.

        Args:
            dimension: That of the body, or one less.
            parts: Their numbers.
            centre: Where they are, for messages.
        """
        members = self.body if dimension == self.dimension else self.boundary
        tags = {tag for part in parts for tag in members.get(part, ())}
        lost = 0
        if dimension < self.dimension:
            lost = sum(self.outside.get(part, 0) for part in parts)
        return Group(dimension, tuple(sorted(tags)), lost, tuple(centre))

    def numbered_places(self) -> dict[str, Group]:
        """Points, and edges in space, by what they are and their number, such as ``point 3``."""
        kinds = ("point", "edge")
        return {
            f"{kinds[dimension]} {part}": self.of_places(dimension, [part])
            for dimension, part in self.places
        }

    def of_places(self, dimension: int, parts: Iterable[int]) -> Group:
        """The group of some points, or of some edges in space.

        Args:
            dimension: 0 or 1.
            parts: Their numbers.
        """
        pieces = [piece for part in parts for piece in self.places.get((dimension, part), ())]
        return Group(dimension, (), places=tuple(dict.fromkeys(pieces)))


def named_groups(
    key: str, source: MeshSource, description: Mapping[str, Any], tags: PartTags
) -> tuple[dict[str, Group], dict[str, Group], dict[str, Group]]:
    """Groups by name (of the file, of the scene, the whole body), by number, and all sides.

    Args:
        key: Of the mesh in the scene, for messages: ``mesh``, or ``mesh[1]``.
        source: The scene's mesh, with the groups that it names.
        description: Of the process that has read the file.
        tags: Of its parts.

    Raises:
        InputError: Two groups have one name, or the scene names a part that is not there.
    """
    where = f"{key}.file = '{source.file}'"
    groups: dict[str, Group] = {}
    numbers: dict[str, Group] = {}
    has_boundaries = False
    for found in sorted(description["groups"], key=lambda group: group["dimension"]):
        if found["dimension"] < tags.dimension - 1:
            continue
        has_boundaries |= found["dimension"] < tags.dimension and found["tag"] > 0
        group = tags.group(found["dimension"], found["parts"])
        name = found["name"] or str(found["tag"])
        groups[name] = _joined(where, name, groups.get(name), group)
        if found["tag"]:
            numbers.setdefault(str(found["tag"]), group)
    if description.get("whole") or all(
        group.dimension < tags.dimension for group in groups.values()
    ):
        groups.setdefault(_BODY, tags.group(tags.dimension, tags.body))
    for found in description["groups"]:
        if found["name"] and found["dimension"] < tags.dimension - 1:
            name = found["name"]
            while name in groups:
                name += _SLENDER[found["dimension"]]
            groups[name] = tags.of_places(found["dimension"], found["parts"])
    sides = {
        str(part["tag"]): tags.group(tags.dimension - 1, [part["tag"]], part["centre"])
        for part in description["parts"]
        if part["dimension"] == tags.dimension - 1
    }
    for name, parts in source.groups.items():
        if name in groups:
            raise InputError(f"{key}.groups.{name}: {where} has a group of that name already")
        for part in parts:
            if str(part) not in sides:
                raise InputError(
                    f"{key}.groups.{name}: {where} has no "
                    f"{_BOUNDARY_PARTS[tags.dimension]} {part}; "
                    f"it has: {', '.join(sides) or 'none'}"
                )
        groups[name] = tags.group(tags.dimension - 1, parts)
    by_number = numbers if has_boundaries else sides
    # Cuts leave surfaces their numbers, but not points and edges.
    if not description.get("lists_once") and not description.get("is_cut"):
        by_number = by_number | tags.numbered_places()
    return groups, by_number, sides


def _joined(where: str, name: str, first: Group | None, second: Group) -> Group:
    """Two groups of one name as one."""
    if first is None:
        return second
    if first.dimension != second.dimension:
        if name.isdigit():  # unnamed groups: a number is first of all the boundary's
            return first
        raise InputError(
            f"{where}: calls a boundary and a part of the body '{name}': give each its own name"
        )
    return Group(
        first.dimension,
        tuple(sorted({*first.tags, *second.tags})),
        first.outside + second.outside,
    )


# How files name the sides of cells, by their kind.
_SURFACES = {
    "inp": "*SURFACE or *NSET",
    "bdf": "BSURFS, or shells (CQUAD4, CTRIA3) with a property of their own on the sides of solids",
    "med": "groups of faces or of nodes; in the plane of edges",
    "msh": "physical groups of surfaces; in the plane of curves",
    "vtu": "cells of one dimension less, numbered by integer cell data",
    "xdmf": "cells of one dimension less, numbered by integer cell data",
}


def no_surface(kind: str, found: Sequence[str]) -> str:
    """A sentence, without its full stop, on a file that names no surface.

    Args:
        kind: Of the file, such as ``bdf``.
        found: Names of the sides that were found instead.
    """
    named = found[0] if len(found) == 1 else f"{found[0]} to {found[-1]}"
    return (
        f"names no surface; its boundary is parted where it turns by more than {ANGLE:g}°, and its "
        f"sides are called {named} (`fenics-contact look` shows them); for others, add to the "
        f"file: {_SURFACES[kind]}"
    )


def left_out(
    read: Mapping[str, Any],
    description: Mapping[str, Any],
    dimension: int,
    facet_kind: int,
    are_sides: Flags,
) -> tuple[str, ...]:
    """A sentence, without its full stop, on elements that are neither cells nor sides of cells.

    Of Gmsh's files only those that stand in groups count: it saves lines and surfaces of its own.

    Args:
        read: Arrays of the process that has read the mesh.
        description: Its description.
        dimension: Of the model.
        facet_kind: Gmsh's type of the sides of the cells.
        are_sides: Whether each element of this type is a side of a cell.
    """
    counts: Counter[str] = Counter()
    for name, chosen in _elements(read, description, dimension).items():
        if int(name) == facet_kind:
            chosen = chosen & ~are_sides
        numbers = read[f"numbers_{name}"][chosen]
        kinds = read.get(f"kinds_{name}", np.full(len(chosen), int(name)))[chosen]
        for kind in np.unique(kinds):  # in the file; one of them may be several triangles here
            called = NAMES.get(int(kind)) or description["types"][name]
            counts[called] += len(np.unique(numbers[kinds == kind]))
    if not counts:
        return ()
    named = " and ".join(f"{count} of the type {name}" for name, count in counts.items())
    return (
        f"elements that are no sides of the cells are left out: {named}; only cells of dimension "
        f"{dimension} are solved, so that shells, membranes, beams and trusses resist nothing here",
    )


def _elements(
    read: Mapping[str, Any], description: Mapping[str, Any], dimension: int
) -> dict[str, Flags]:
    """Flags of the elements below the model's dimension that count, by Gmsh's type."""
    if description.get("lists_once"):
        return {
            name: read[f"numbers_{name}"] > 0
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
        name: np.isin(read[f"parts_{name}"], named)
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
