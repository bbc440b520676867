"""Reading of mesh files: their lines, the files that they include, and the mesh that was found."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.mesh.geometry.process_room import RefusedError
from fenics_contact.mesh.readers.element_kinds import (
    CORNERS,
    EDGES,
    NAMES,
    NOT_GIVEN,
    SIDES,
    corner_keys,
    dimension_of,
    shape_of,
)

# Gmsh's types of points and of straight edges.
_POINT, _LINE = 15, 1
_MOST = 1000  # files, each time that one is included


class Line(NamedTuple):
    """A line, without its end; what messages call its file, and its number there."""

    text: str
    file: str
    number: int

    def error(self, words: str) -> RefusedError:
        """Return the error of this line."""
        return RefusedError(f"{self.file}, line {self.number}: {words}")


class FileLines:
    """Reads a file and what it includes.

    Args:
        key: Of the file in the scene, for messages: ``mesh.file``.
        name: Of the file in the scene, for messages.
        path: The file.
    """

    def __init__(self, key: str, name: str, path: Path) -> None:
        self._key, self._name, self._path = key, name, path
        self._allowed = path.parent.resolve()
        self._open: list[Path] = []
        self._count = 0

    def error(self, words: str) -> RefusedError:
        """Return the error of the file as a whole."""
        return RefusedError(f"{self._key} = '{self._name}': {words}")

    def lines(self) -> Iterator[Line]:
        """Yield the lines of the file itself."""
        return self._lines(self._path, self._name)

    def included(self, line: Line, name: str) -> Iterator[Line]:
        """Lines of a file that a line names, which its folder holds, or one below.

        Args:
            line: The one that names it.
            name: As it is there: relative to the folder of the scene's file.
        """
        path = self._path.parent / name
        said = f"the included file '{name}'"
        if Path(name).is_absolute() or not path.resolve().is_relative_to(self._allowed):
            raise line.error(f"{said} is outside the folder of the mesh, which it may not read")
        if not os.path.isfile(path):
            raise line.error(f"there is no file '{name}' in the folder of the mesh to include")
        self._count += 1
        if path.resolve() in self._open or self._count > _MOST:
            raise line.error(f"{said} includes itself, or more than {_MOST} files are included")
        return self._lines(path, name)

    def _lines(self, path: Path, name: str) -> Iterator[Line]:
        self._open.append(path.resolve())
        with path.open(encoding="utf-8", errors="replace") as file:
            where = f"{self._key} = '{name}'"
            for number, text in enumerate(file, 1):
                yield Line(text.rstrip("\r\n"), where, number)
        self._open.pop()


def require_whole(where: str, path: Path) -> None:
    """Refuse a file that cannot be read, or that refers to another one."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            outside = _outside(h5py, file)
            file.visititems(lambda name, found: outside.extend(_outside(h5py, found)))
    except (OSError, RuntimeError, ValueError) as error:
        said = " ".join(str(error).split())
        raise RefusedError(f"{where}: is no sound HDF5 file ({said})") from None
    if outside:
        raise RefusedError(
            f"{where}: '{outside[0]}' in it refers to another file, which a mesh may not; write "
            "all into one file"
        )


def _outside(h5py: Any, found: Any) -> list[str]:
    """Return the parts of a group or a data set that are kept in another file."""
    if isinstance(found, h5py.Dataset):
        return [found.name] if found.external or found.is_virtual else []
    links = {name: found.get(name, getlink=True) for name in found}
    own = (h5py.HardLink, h5py.SoftLink)
    return [f"{found.name}/{name}" for name, link in links.items() if not isinstance(link, own)]


@dataclass(eq=False)
class FoundMesh:
    """Nodes, elements and groups of a file.

    Attributes:
        tags: The file's number of each node, shape (nodes,).
        points: Coordinates, shape (nodes, 3) (length).
        elements: Gmsh's type → nodes of each element by their numbers, in Gmsh's order.
        numbers: Gmsh's type → the file's number of each element.
        sets: Sets of elements: name → Gmsh's type → rows of ``elements``.
        surfaces: Sets of sides of cells: name → Gmsh's type → their nodes.
        node_sets: Sets of nodes by their numbers. They name the facets of the boundary all of whose
            nodes they hold; where these are none, the nodes, and in space the edges between them.
        kinematics: What plane elements are made for, if the file says it, such as ``axisymmetric``,
            and a type that says so, such as ``CAX4``.
    """

    tags: Integers
    points: Array
    elements: Mapping[int, Integers]
    numbers: Mapping[int, Integers]
    sets: Mapping[str, Mapping[int, Integers]] = field(default_factory=dict)
    surfaces: Mapping[str, Mapping[int, Integers]] = field(default_factory=dict)
    node_sets: Mapping[str, Integers] = field(default_factory=dict)
    kinematics: Mapping[str, str] = field(default_factory=dict)

    @property
    def dimension(self) -> int:
        """The largest of its elements."""
        return max((dimension_of(kind) for kind in self.elements), default=0)

    def answer(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Description and arrays; all cells are the body, whether a group names them or not.

        A name that stands for several things is that of the cells first, then of a surface, of the
        facets in a set of elements, and of a set of nodes. The later ones are ``NAME.surface``,
        ``NAME.facets`` and ``NAME.nodes``.
        """
        parts = _Parts(self.elements, self.numbers)
        for rows in self.sets.values():
            parts.split(rows)
        groups: dict[str, tuple[int, list[int]]] = {}
        for name, rows in self.sets.items():
            if self._has(rows, self.dimension) or not self._has(rows, self.dimension - 1):
                dimension = self._largest(rows)
                groups[name] = (dimension, parts.of(rows, dimension))
        for name, facets in self.surfaces.items():
            _add(groups, name, "surface", (self.dimension - 1, parts.added(facets)))
        for name, rows in self.sets.items():
            if self._has(rows, self.dimension - 1):
                found = parts.of(rows, self.dimension - 1)
                _add(groups, name, "facets", (self.dimension - 1, found))
        of_nodes: set[int] = set()
        for name, tags in self.node_sets.items():
            facets = self._facets_between(tags)
            if not facets and (places := self._places_of(tags)):
                dimension = max(map(dimension_of, places))
                _add(groups, name, "nodes", (dimension, parts.added(places)))
                continue
            added = parts.added(facets)
            of_nodes |= set(added)
            _add(groups, name, "nodes", (self.dimension - 1, added))
        return self._described(groups, parts, of_nodes), {
            "node_tags": self.tags,
            "points": self.points,
            **parts.arrays(),
        }

    def _described(
        self, groups: Mapping[str, tuple[int, list[int]]], parts: _Parts, of_nodes: set[int]
    ) -> dict[str, Any]:
        return {
            "dimension": self.dimension,
            "whole": True,
            "lists_once": True,
            "kinematics": dict(self.kinematics) if self.dimension == 2 else {},
            "groups": [
                {
                    "dimension": dimension,
                    "tag": 0,
                    "name": name,
                    "parts": found,
                    "of_nodes": bool(of_nodes & set(found)),
                }
                for name, (dimension, found) in groups.items()
            ],
            "parts": [
                {"dimension": self.dimension, "tag": part, "centre": []}
                for part in parts.all_of(self.dimension)
            ],
            "types": {kind: NAMES[kind] for kind in parts.nodes},
        }

    def _has(self, rows: Mapping[int, Integers], dimension: int) -> bool:
        return any(
            len(found) > 0 and dimension_of(kind) == dimension for kind, found in rows.items()
        )

    def _largest(self, rows: Mapping[int, Integers]) -> int:
        """The dimension of the largest elements of a set, that of the cells where it has none."""
        found = [dimension_of(kind) for kind, of_kind in rows.items() if len(of_kind)]
        return max(found, default=self.dimension)

    def _places_of(self, tags: Integers) -> dict[int, Integers]:
        """Nodes of cells of some numbers, and in space edges of straight cells between, by type.

        Where there are edges each node is one of no length, so that all are of one dimension.
        """
        nodes = np.intersect1d(tags, self._nodes_of_cells)
        if len(nodes) == 0:
            return {}
        between = self._edges[np.isin(self._edges, nodes).all(axis=1)]
        if self.dimension < 3 or len(between) == 0:
            return {_POINT: nodes[:, None]}
        return {_LINE: np.concatenate([np.stack([nodes, nodes], axis=1), between])}

    @cached_property
    def _nodes_of_cells(self) -> Integers:
        """Numbers of all nodes that cells have, sorted."""
        cells = [n for kind, n in self.elements.items() if dimension_of(kind) == self.dimension]
        return np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *map(np.ravel, cells)]))

    @cached_property
    def _edges(self) -> Integers:
        """Nodes at both ends of the edges of cells without nodes between, (edges, 2)."""
        found = [np.zeros((0, 2), dtype=np.int64)]
        for kind, nodes in self.elements.items():
            shape = shape_of(kind)
            if dimension_of(kind) == self.dimension and nodes.shape[1] == CORNERS[shape]:
                found.append(nodes[:, np.array(EDGES[shape])].reshape(-1, 2))
        return np.unique(np.sort(np.concatenate(found), axis=1), axis=0)

    def _facets_between(self, tags: Integers) -> dict[int, Integers]:
        """The facets of the boundary all of whose nodes have one of some numbers, by type."""
        known = np.append(tags, NOT_GIVEN)
        found = {
            kind: nodes[np.isin(nodes, known).all(axis=1)] for kind, nodes in self._boundary.items()
        }
        return {kind: nodes for kind, nodes in found.items() if len(nodes)}

    @cached_property
    def _boundary(self) -> dict[int, Integers]:
        return outer_sides(self.elements, self.elements, self.dimension)


def outer_sides(
    elements: Mapping[int, Integers], chosen: Mapping[int, Integers], dimension: int
) -> dict[int, Integers]:
    """Sides of some cells that no other cell has: their nodes, by Gmsh's type of the side.

    Args:
        elements: Gmsh's type → nodes of all elements.
        chosen: Of some of them.
        dimension: Of the cells; elements of others have no say.
    """
    every, mine = (_sides(of, dimension) for of in (elements, chosen))
    none = np.zeros(0, dtype=np.uint64)  # trusses alone have no sides
    keys, counts = np.unique(
        np.concatenate([none, *(_keys(side, nodes) for side, nodes in every.items())]),
        return_counts=True,
    )
    outer = keys[counts == 1]
    return {side: nodes[np.isin(_keys(side, nodes), outer)] for side, nodes in mine.items()}


def _sides(elements: Mapping[int, Integers], dimension: int) -> dict[int, Integers]:
    """Nodes of all sides of the cells of a dimension, by Gmsh's type of the side."""
    sides: dict[int, list[Integers]] = {}
    for kind, nodes in elements.items():
        for side, places in SIDES.get(kind, ()) if dimension_of(kind) == dimension else ():
            sides.setdefault(side, []).append(nodes[:, np.array(places)])
    return {side: np.concatenate(several) for side, several in sides.items()}


def _keys(side: int, nodes: Integers) -> NDArray[np.uint64]:
    """One number for each side, the same for sides with the same corners."""
    return corner_keys(nodes[:, : CORNERS[shape_of(side)]])


def _add(
    groups: dict[str, tuple[int, list[int]]], name: str, kind: str, group: tuple[int, list[int]]
) -> None:
    """A group under its name, or a longer one where that is taken."""
    while name in groups:
        name = f"{name}.{kind}"
    groups[name] = group


class _Parts:
    """Elements dealt out to numbered parts, of which each set has some as a whole.

    Attributes:
        nodes: Gmsh's type → nodes of its elements.

    Args:
        elements: The same, to begin with.
        numbers: Likewise, the file's number of each.
    """

    def __init__(self, elements: Mapping[int, Integers], numbers: Mapping[int, Integers]) -> None:
        self.nodes = dict(elements)
        self._numbers_of = dict(numbers)
        self._next = 1
        self._part = {}
        for kind, nodes in elements.items():
            self._part[kind] = np.full(len(nodes), self._new(), dtype=np.int64)

    def _new(self) -> int:
        self._next += 1
        return self._next - 1

    def split(self, rows: Mapping[int, Integers]) -> None:
        """Cut the parts so that some elements make parts of their own."""
        for kind, chosen in rows.items():
            part = self._part[kind]
            found, inverse = np.unique(part[np.unique(chosen)], return_inverse=True)
            fresh = np.array([self._new() for _ in found], dtype=np.int64)
            part[np.unique(chosen)] = fresh[inverse] if len(found) else part[:0]

    def of(self, rows: Mapping[int, Integers], dimension: int) -> list[int]:
        """Numbers of the parts that some elements of a dimension make."""
        return self._numbers(
            self._part[kind][chosen]
            for kind, chosen in rows.items()
            if dimension_of(kind) == dimension
        )

    def all_of(self, dimension: int) -> list[int]:
        """Numbers of all parts of a dimension."""
        return self._numbers(
            part for kind, part in self._part.items() if dimension_of(kind) == dimension
        )

    def _numbers(self, parts: Iterable[Integers]) -> list[int]:
        return sorted({int(number) for part in parts for number in np.unique(part)})

    def added(self, facets: Mapping[int, Integers]) -> list[int]:
        """The number of a part that is added: facets, by their nodes; as elements they have 0."""
        number = self._new()
        for kind, nodes in facets.items():
            before = self.nodes.get(kind, nodes[:0])
            self.nodes[kind] = np.concatenate([before, nodes])
            parts = np.full(len(nodes), number, dtype=np.int64)
            self._part[kind] = np.concatenate([self._part.get(kind, parts[:0]), parts])
            numbers = self._numbers_of.get(kind, parts[:0])
            self._numbers_of[kind] = np.concatenate([numbers, np.zeros_like(parts)])
        return [number]

    def arrays(self) -> dict[str, Integers]:
        """Return the arrays for ``from_gmsh``."""
        found = {f"nodes_{kind}": nodes for kind, nodes in self.nodes.items()}
        found |= {f"numbers_{kind}": numbers for kind, numbers in self._numbers_of.items()}
        return found | {f"parts_{kind}": part for kind, part in self._part.items()}
