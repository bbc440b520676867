"""Decides what the cells of a mesh become, so that all are of one type and order.

A mesh whose cells are of one type and order, which dolfinx has, keeps them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.common.errors import InputError
from fenics_contact.mesh.cell_checks import undefined_node
from fenics_contact.mesh.readers.element_kinds import (
    CORNERS,
    EDGES,
    NAMES,
    NOT_GIVEN,
    dimension_of,
    dimension_of_name,
    order_of,
    shape_of,
)
from fenics_contact.mesh.subdivision.elements import (
    Elements,
    Middles,
    Nodes,
    elements_of,
    joined,
    replaced,
)
from fenics_contact.mesh.subdivision.orders import KIND_OF, of_order
from fenics_contact.mesh.subdivision.outer_faces import (
    check_against_triangles,
    outer_faces,
    volume_added,
)
from fenics_contact.mesh.subdivision.simplices import SIMPLEX, edge_keys, subdivided

_CALLED = {"Triangle": "triangles", "Tetrahedron": "tetrahedra"}
_ONE_PLACE = 1e-6  # distance of nodes, over the length of an edge
_TOLD = 1e-9  # change of volume, over the whole, from which it is told


@dataclass(frozen=True)
class Form:
    """Shapes and order of the cells of a model.

    Attributes:
        shapes: Of the cells as they are read.
        order: The largest of their orders.
    """

    shapes: frozenset[str]
    order: int

    @property
    def is_kept(self) -> bool:
        """Whether cells keep their shape."""
        return len(self.shapes) == 1 and not self.shapes & {"Prism", "Pyramid"}


def form_of(read: Mapping[str, Any], description: Mapping[str, Any], dimension: int) -> Form | None:
    """Shapes and order of the cells of a mesh; None without cells, or with cells of other types.

    Args:
        read: Arrays of the process that has read the mesh.
        description: Its description.
        dimension: Of the model.
    """
    parts = body_parts(description, dimension)
    found = []
    for name, called in description["types"].items():
        if f"parts_{name}" not in read or dimension_of_name(called) != dimension:
            continue
        if np.isin(read[f"parts_{name}"], parts).any():
            found.append(int(name))
    if not found or not set(found) <= set(NAMES):
        return None
    return Form(frozenset(map(shape_of, found)), max(map(order_of, found)))


def common_form(forms: Iterable[Form | None]) -> Form | None:
    """Common shapes and order of the cells of several meshes; None where one mesh has no form.

    Args:
        forms: Of the meshes.
    """
    every = list(forms)
    known = [form for form in every if form is not None]
    if len(known) < len(every):
        return None
    return Form(frozenset().union(*(form.shapes for form in known)), max(f.order for f in known))


def body_parts(description: Mapping[str, Any], dimension: int) -> list[int]:
    """Parts that make the body: all, or those in physical groups of Gmsh's if there are some.

    Args:
        description: Of the process that has read the mesh.
        dimension: Of the model.
    """
    every = [p["tag"] for p in description["parts"] if p["dimension"] == dimension]
    if description.get("whole"):
        return every
    grouped = {p for g in description["groups"] if g["dimension"] == dimension for p in g["parts"]}
    return sorted(grouped) or every


def uniform(
    where: str,
    read: Mapping[str, Any],
    description: Mapping[str, Any],
    dimension: int,
    form: Form | None = None,
) -> tuple[Mapping[str, Any], Mapping[str, Any], tuple[str, ...]]:
    """A mesh whose cells are of one type and order, and sides of cells that fit them.

    Cells of order 1 beside those of order 2 get nodes in the middle of their edges, serendipity
    cells those in the middle of faces and cells. If they are of several shapes, or prisms or
    pyramids, all are cut into tetrahedra, in the plane into triangles.

    Args:
        where: What begins a message: the file.
        read: Arrays of the process that has read the mesh.
        description: Its description.
        dimension: Of the model.
        form: Of all cells of the model; by default that of these.

    Returns:
        Both as they are now, and notes without the full stop. Where some cells have no type that is
        known, all is left as it was.

    Raises:
        InputError: Cells use nodes that there are not, or do not fit together.
    """
    own = form_of(read, description, dimension)
    if own is None:
        return read, description, ()
    change = _Change(where, read, description, dimension, form or own)
    return change.made() if change.is_wanted() else (read, description, ())


class _Change:
    """Makes a mesh uniform; its arguments are those of ``uniform``."""

    def __init__(
        self,
        where: str,
        read: Mapping[str, Any],
        description: Mapping[str, Any],
        dimension: int,
        form: Form,
    ) -> None:
        self._where, self._read, self._description = where, read, description
        self._dimension, self._form = dimension, form
        self._kinds = [
            kind
            for kind in map(int, description["types"])
            if kind in NAMES and dimension_of(kind) in (dimension - 1, dimension)
        ]
        parts, self._elements = body_parts(description, dimension), elements_of(read, self._kinds)
        for kind, every in self._elements.items():
            if dimension_of(kind) == dimension:
                mine = np.flatnonzero(np.isin(every.parts, parts))
                self._elements[kind] = every.with_nodes(every.nodes[mine], mine)
        self._nodes = Nodes(read)
        self._middles = Middles(self._nodes)

    def is_wanted(self) -> bool:
        """Whether an element changes."""
        shapes = {*self._form.shapes, *map(shape_of, self._elements)}
        final = {KIND_OF[shape][self._form.order] for shape in shapes}
        is_cut = not self._form.is_kept or (
            self._form.shapes == {SIMPLEX[self._dimension]} and "Quadrilateral" in shapes
        )
        return (
            is_cut
            or not set(self._elements) <= final
            or any((elements.nodes == NOT_GIVEN).any() for elements in self._elements.values())
        )

    def made(self) -> tuple[Mapping[str, Any], Mapping[str, Any], tuple[str, ...]]:
        """Arrays and description of the mesh of simplices, and sentences on what was changed."""
        self._check_nodes()
        ready = of_order(self._elements, self._form.order, self._nodes, self._middles)
        cells, sides = (
            {kind: one for kind, one in ready.items() if dimension_of(kind) == dimension}
            for dimension in (self._dimension, self._dimension - 1)
        )
        notes = self._words_on_orders()
        if not self._form.is_kept:
            self._check_middles()
            before, cells = cells, self._cut(cells)
            notes += self._words_on_cut(before, cells)
        if sides and set(map(shape_of, cells)) == {SIMPLEX[3]}:
            edges = edge_keys(*next(iter(cells.items())))
            cut = [subdivided(kind, one, self._middles, edges) for kind, one in sides.items()]
            sides = {KIND_OF[SIMPLEX[2]][self._form.order]: joined(cut)}
        read, description = replaced(
            self._read, self._description, self._kinds, {**cells, **sides}, self._nodes
        )
        return read, description, tuple(notes)

    def _check_nodes(self) -> None:
        """All nodes of cells are there."""
        for kind, elements in self._elements.items():
            if dimension_of(kind) == self._dimension:
                known = self._nodes.are_known(elements.nodes) | (elements.nodes == NOT_GIVEN)
                if not known.all():
                    row, column = np.argwhere(~known)[0]
                    raise undefined_node(
                        self._where, elements.numbers[row], elements.nodes[row, column]
                    )

    def _check_middles(self) -> None:
        """Cells that share an edge have one place for the node in its middle."""
        for kind, elements in self._elements.items():
            shape = shape_of(kind)
            if dimension_of(kind) != self._dimension or order_of(kind) == 1:
                continue
            ends, first = np.array(EDGES[shape]), CORNERS[shape]
            pairs = elements.nodes[:, ends].reshape(-1, 2)
            own = elements.nodes[:, first : first + len(ends)].ravel()
            chosen = self._middles.find(pairs)
            apart = np.linalg.norm(self._nodes.at(own) - self._nodes.at(chosen), axis=1)
            long = np.linalg.norm(np.diff(self._nodes.at(pairs), axis=1)[:, 0], axis=1)
            bad = (own != NOT_GIVEN) & (apart > _ONE_PLACE * long)
            if bad.any():
                place = int(np.argmax(bad))
                raise InputError(
                    f"{self._where}: the edge between the nodes {pairs[place, 0]} and "
                    f"{pairs[place, 1]} has two nodes in its middle, at different places: "
                    f"{own[place]} (of the element {elements.numbers[place // len(ends)]}) and "
                    f"{chosen[place]}; merge them"
                )

    def _cut(self, cells: Mapping[int, Elements]) -> dict[int, Elements]:
        """Simplices in place of all cells."""
        simplices = [
            self._turned(subdivided(kind, one, self._middles)) for kind, one in cells.items()
        ]
        found = {KIND_OF[SIMPLEX[self._dimension]][self._form.order]: joined(simplices)}
        if self._dimension == 3:
            faces = outer_faces(cells, {1: 4, 2: 9}[self._form.order])
            check_against_triangles(self._where, faces, edge_keys(*next(iter(found.items()))))
        return found

    def _turned(self, simplices: Elements) -> Elements:
        """Simplices whose determinants are positive where most of a part's cells are turned alike.

        A file may list prisms the other way round than hexahedra.
        """
        corners = self._nodes.at(simplices.nodes[:, : self._dimension + 1])[..., : self._dimension]
        signs = np.sign(np.linalg.det(corners[:, 1:] - corners[:, :1]))
        _, part = np.unique(simplices.parts, return_inverse=True)
        is_turned = (np.bincount(part, signs) < 0)[part]
        nodes = simplices.nodes.copy()
        nodes[is_turned] = nodes[is_turned][:, _mirrored(nodes.shape[1], self._dimension)]
        return simplices.with_nodes(nodes)

    def _words_on_orders(self) -> list[str]:
        """A note where cells of both orders are in one mesh."""
        orders = {
            order_of(kind) for kind in self._elements if dimension_of(kind) == self._dimension
        }
        if len(orders) == 1:
            return []
        return [
            "has cells of order 1 and 2: all have order 2 here, those of order 1 with the nodes in "
            "the middle of edges that their neighbours have, or halfway"
        ]

    def _words_on_cut(
        self, before: Mapping[int, Elements], cells: Mapping[int, Elements]
    ) -> list[str]:
        """A note on what became of the cells."""
        simplex = SIMPLEX[self._dimension]
        kinds = np.concatenate([one.kinds for one in before.values()])
        if set(map(shape_of, before)) == {simplex}:
            return []
        types = " and ".join(
            f"{count:,} of the type {NAMES[int(kind)]}"
            for kind, count in zip(*np.unique(kinds, return_counts=True), strict=True)
        )
        ((_, made),) = cells.items()
        corners = len(np.unique(made.nodes[:, : self._dimension + 1]))
        on_edges = [
            corners + len(np.unique(np.concatenate([edge_keys(*item) for item in some.items()])))
            for some in (before, cells)
        ]
        first, then, fewest = (f"{self._dimension * n:,}" for n in (*on_edges, corners))
        words = (
            f"its cells ({types}) are subdivided into {len(made.nodes):,} {_CALLED[simplex]}, as "
            "all cells of a model are of one type; with displacements of degree 2 its unknowns "
            f"grow from {first} (at the corners and edges of the file's cells) to {then}, "
            f"with those of degree 1 they stay {fewest}"
        )
        return [words + self._words_on_volume(before, made)]

    def _words_on_volume(self, before: Mapping[int, Elements], made: Elements) -> str:
        if self._dimension == 2:  # edges stay as they are
            return ""
        at = self._nodes.at(made.nodes[:, :4])
        whole = np.abs(np.linalg.det(at[:, 1:] - at[:, :1])).sum() / 6
        faces = outer_faces(before, {1: 4, 2: 9}[self._form.order])
        change = volume_added(faces, self._middles, self._nodes) / (whole or 1.0)
        if abs(change) < _TOLD:
            return ""
        return (
            f"; faces on the boundary that are not plane change the volume by {100 * change:+.2g} %"
        )


def _mirrored(count: int, dimension: int) -> Integers:
    """Places of a simplex's nodes once its first two corners have changed places.

    Args:
        count: Of its nodes.
        dimension: Of the simplex.
    """
    corners = np.array([1, 0, *range(2, dimension + 1)])
    if count == dimension + 1:
        return corners
    edges = [frozenset(edge) for edge in EDGES[SIMPLEX[dimension]]]
    turned = [frozenset(corners[list(edge)].tolist()) for edge in EDGES[SIMPLEX[dimension]]]
    return np.array([*corners, *(dimension + 1 + edges.index(edge) for edge in turned)])
