"""Elements and nodes of a mesh that is changed, and nodes in the middle of edges and faces."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.mesh.readers.element_kinds import NAMES, NOT_GIVEN, corner_keys


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements of one of Gmsh's types.

    Attributes:
        nodes: By their tags, (elements, nodes).
        parts: Part of each.
        numbers: The file's number of each; 0 of one that it does not have.
        kinds: Gmsh's type of each in the file.
    """

    nodes: Integers
    parts: Integers
    numbers: Integers
    kinds: Integers

    def with_nodes(self, nodes: Integers, parents: Integers | None = None) -> Elements:
        """Elements made of these.

        Args:
            nodes: Of each.
            parents: Which of these each is made of, as places; by default all are, in order.
        """
        rows = np.arange(len(self.nodes)) if parents is None else parents
        return Elements(nodes, self.parts[rows], self.numbers[rows], self.kinds[rows])

    def chosen(self, rows: Integers) -> Elements:
        """Some of the elements, by their places."""
        return self.with_nodes(self.nodes[rows], rows)


def joined(several: Sequence[Elements]) -> Elements:
    """Elements of one type, one after the other."""
    return Elements(
        *(
            np.concatenate([getattr(one, name) for one in several])
            for name in ("nodes", "parts", "numbers", "kinds")
        )
    )


def elements_of(read: Mapping[str, Any], kinds: Sequence[int]) -> dict[int, Elements]:
    """Elements of some of Gmsh's types, of those that there are.

    Args:
        read: Arrays of the process that has read the mesh.
        kinds: The types.
    """
    return {
        kind: Elements(
            read[f"nodes_{kind}"].astype(np.int64),
            read[f"parts_{kind}"].astype(np.int64),
            read[f"numbers_{kind}"].astype(np.int64),
            np.full(len(read[f"nodes_{kind}"]), kind),
        )
        for kind in kinds
        if f"nodes_{kind}" in read
    }


def replaced(
    read: Mapping[str, Any],
    description: Mapping[str, Any],
    old: Sequence[int],
    new: Mapping[int, Elements],
    nodes: Nodes,
) -> tuple[dict[str, Any], dict[str, Any]]:
    """A mesh with other elements in place of some, and the description of it.

    Args:
        read: Its arrays.
        description: Of it.
        old: Gmsh's types that are replaced.
        new: By Gmsh's type.
        nodes: Of the new mesh.
    """
    names = ("nodes", "parts", "numbers")
    gone = {f"{name}_{kind}" for kind in old for name in names}
    found = {name: array for name, array in read.items() if name not in gone}
    types = {name: called for name, called in description["types"].items() if int(name) not in old}
    for kind, elements in new.items():
        found |= {f"{name}_{kind}": getattr(elements, name) for name in (*names, "kinds")}
        types[str(kind)] = NAMES[kind]
    found |= {"node_tags": nodes.tags, "points": nodes.points}
    return found, dict(description) | {"types": types}


class Nodes:
    """Nodes of a mesh, to which more are added.

    Attributes:
        tags: Of each, (nodes,).
        points: Coordinates, (nodes, 3) (length).

    Args:
        read: Arrays of the mesh.
    """

    def __init__(self, read: Mapping[str, Any]) -> None:
        self.tags: Integers = read["node_tags"].astype(np.int64)
        self.points: Array = read["points"]
        self._sort()

    def _sort(self) -> None:
        self._order = np.argsort(self.tags)
        self._sorted = self.tags[self._order]

    def are_known(self, tags: Integers) -> Flags:
        """Whether there are such nodes."""
        return np.isin(tags, self.tags)

    def at(self, tags: Integers) -> Array:
        """Coordinates of nodes; of unknown ones those of some other."""
        places = np.minimum(np.searchsorted(self._sorted, tags), len(self.tags) - 1)
        return np.asarray(self.points[self._order[places]])

    def added(self, points: Array) -> Integers:
        """Add nodes, and return their tags."""
        start = int(self.tags.max(initial=0)) + 1
        tags = np.arange(start, start + len(points))
        self.tags = np.concatenate([self.tags, tags])
        self.points = np.concatenate([self.points, points])
        self._sort()
        return tags


class Middles:
    """Nodes in the middle of edges and faces, each known by its corners in any order.

    Args:
        nodes: Of the mesh.
    """

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._keys = np.zeros(0, dtype=np.uint64)
        self._middles = np.zeros(0, dtype=np.int64)

    def add(self, corners: Integers, middles: Integers) -> None:
        """Add some; of those that are known already, or given twice, the first counts.

        Args:
            corners: Tags, (edges or faces, corners).
            middles: Tag of the node in the middle of each, or ``NOT_GIVEN``.
        """
        given = middles != NOT_GIVEN
        every = np.concatenate([self._keys, corner_keys(corners[given])])
        self._keys, first = np.unique(every, return_index=True)
        self._middles = np.concatenate([self._middles, middles[given]])[first]

    def find(self, corners: Integers) -> Integers:
        """The node in the middle of each, ``NOT_GIVEN`` where none is known.

        Args:
            corners: Tags, (edges or faces, corners).
        """
        if len(self._keys) == 0:
            return np.full(len(corners), NOT_GIVEN)
        wanted = corner_keys(corners)
        place = np.minimum(np.searchsorted(self._keys, wanted), len(self._keys) - 1)
        return np.where(self._keys[place] == wanted, self._middles[place], NOT_GIVEN)

    def of(self, corners: Integers, rule: Callable[[Integers], Array] | None = None) -> Integers:
        """The node in the middle of each; where none is known one is added.

        Args:
            corners: Tags, (edges or faces, corners).
            rule: Coordinates of nodes that are added, from their places among these; by default
                halfway between the corners.
        """
        missing = np.flatnonzero(self.find(corners) == NOT_GIVEN)
        _, first = np.unique(corner_keys(corners[missing]), return_index=True)
        chosen = np.sort(missing[first])
        if len(chosen):
            points = rule(chosen) if rule else self._nodes.at(corners[chosen]).mean(axis=1)
            self.add(corners[chosen], self._nodes.added(points))
        return self.find(corners)
