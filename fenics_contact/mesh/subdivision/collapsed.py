"""Cells with corners that coincide are read as the cells that they are: wedges, pyramids and so on.

Programs without wedges and pyramids of their own write these as hexahedra that name a node several
times, and triangles on them as quadrilaterals. Which cell is meant is decided by the faces that are
left: a face of which two corners are one is a triangle, and one of which only two are left is an
edge. In the plane quadrilaterals stay as they are, and are refused: there a wrong number of a node
could not be told from a triangle that is meant.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.mesh.readers.element_kinds import (
    CORNERS,
    EDGES,
    NAMES,
    SIDE_CORNERS,
    dimension_of,
    order_of,
    shape_of,
)
from fenics_contact.mesh.subdivision.elements import Elements, Nodes, elements_of, joined, replaced

# Gmsh's types by shape and order, without nodes in the middle of faces.
_KINDS = {
    **{("Triangle", 1): 2, ("Triangle", 2): 9, ("Tetrahedron", 1): 4, ("Tetrahedron", 2): 11},
    **{("Prism", 1): 6, ("Prism", 2): 18, ("Pyramid", 1): 7, ("Pyramid", 2): 19},
}
# Types that may be collapsed, and have no nodes in the middle of faces that would be lost.
_MAY_COLLAPSE = (3, 16, 5, 17, 6, 18, 7, 19)
# The shape by how many triangles and quadrilaterals bound it.
_BOUNDED = {(2, 3): "Prism", (4, 1): "Pyramid", (4, 0): "Tetrahedron"}


def without_collapsed(
    read: Mapping[str, Any], description: Mapping[str, Any]
) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
    """A mesh in space whose cells and sides name no corner twice, as far as they are known ones.

    Args:
        read: Arrays of the process that has read the mesh.
        description: Of it.

    Returns:
        Arrays and description, with a sentence on cells that were changed under ``changed``. What
        is left of collapsed cells is refused by ``cell_checks``, and by ``outer_faces`` what does
        not meet the cells beside it, since a number of a node is wrong.
    """
    if description["dimension"] < 3:
        return read, description
    there = [kind for kind in map(int, description["types"]) if f"nodes_{kind}" in read]
    elements = elements_of(read, [kind for kind in there if kind in _MAY_COLLAPSE])
    left: dict[int, list[Elements]] = {}
    made: dict[int, list[Elements]] = {}
    counts: dict[tuple[int, int], int] = {}
    for kind, every in elements.items():
        found, is_kept = _meant_elements(kind, every)
        left[kind] = [every.chosen(np.flatnonzero(is_kept))]
        for new, one in found:
            made.setdefault(new, []).append(one)
            counts[kind, new] = counts.get((kind, new), 0) + len(one.nodes)
    if not made:
        return read, description
    for kind, one in elements_of(read, [kind for kind in made if kind not in elements]).items():
        left[kind] = [one]
    kinds = sorted({*left, *made})
    whole = {kind: joined([*left.get(kind, []), *made.get(kind, [])]) for kind in kinds}
    whole = {kind: one for kind, one in whole.items() if len(one.nodes)}
    read, description = replaced(read, description, kinds, whole, Nodes(read))
    words = [
        f"{count:,} of the type {NAMES[old]} are {NAMES[new]}"
        for (old, new), count in sorted(counts.items())
        if dimension_of(old) == 3
    ]
    said = f"cells that name a corner several times are read as what they are: {', '.join(words)}"
    return read, dict(description) | {"changed": [said] if words else []}


def _meant_elements(kind: int, every: Elements) -> tuple[list[tuple[int, Elements]], Flags]:
    """Elements that collapsed ones are, with their types; and which elements stay as they are."""
    corners = every.nodes[:, : CORNERS[shape_of(kind)]]
    in_order = np.sort(corners, axis=1)
    collapsed = np.flatnonzero((in_order[:, 1:] == in_order[:, :-1]).any(axis=1))
    kept = np.ones(len(corners), dtype=bool)
    if len(collapsed) == 0:
        return [], kept
    first = np.argmax(corners[collapsed][:, :, None] == corners[collapsed][:, None, :], axis=2)
    patterns, inverse = np.unique(first, axis=0, return_inverse=True)
    found = []
    for number, pattern in enumerate(patterns.tolist()):
        meant = _meant(kind, pattern)
        if meant is None:
            continue
        new, places = meant
        rows = collapsed[inverse.reshape(-1) == number]
        kept[rows] = False
        found.append((new, every.with_nodes(every.nodes[rows][:, places], rows)))
    return found, kept


def _meant(kind: int, pattern: Sequence[int]) -> tuple[int, Integers] | None:
    """Gmsh's type of the element that a collapsed one is, and the places of its nodes in that one.

    Args:
        kind: Gmsh's type of the collapsed one.
        pattern: Of each corner, the first one that is the same node.

    Returns:
        None where it is no element of another type.
    """
    if dimension_of(kind) == 2:
        ring = _ring(pattern)
        shape, corners = ("Triangle", ring) if len(ring) == len({*ring}) == 3 else ("", [])
    else:
        shape, corners = _solid([_ring([pattern[c] for c in s]) for s in _sides(kind)])
    if not shape:
        return None
    order, places = order_of(kind), list(corners)
    if order == 2:
        ends = [frozenset(pattern[corner] for corner in edge) for edge in EDGES[shape_of(kind)]]
        for one, other in EDGES[shape]:
            pair = frozenset((corners[one], corners[other]))
            if pair not in ends:
                return None
            places.append(len(pattern) + ends.index(pair))
    return _KINDS[shape, order], np.array(places)


def _sides(kind: int) -> Sequence[tuple[int, ...]]:
    return SIDE_CORNERS[shape_of(kind)]


def _ring(corners: Sequence[int]) -> list[int]:
    """Corners of a face in their order, each pair of neighbours that are one node as one."""
    return [
        corner
        for place, corner in enumerate(corners)
        if corner != corners[place - 1]  # that before the first one is the last
    ]


def _solid(faces: Sequence[list[int]]) -> tuple[str, list[int]]:
    """The shape that some faces bound, and its corners in Gmsh's order; empty if it is none.

    Args:
        faces: Corners of each, in the order in which they turn about a normal into the cell.
    """
    faces = [face for face in faces if len(face) > 2]
    flat, nodes = [len(face) for face in faces], {corner for face in faces for corner in face}
    shape = _BOUNDED.get((flat.count(3), flat.count(4)), "")
    distinct = {frozenset(face) for face in faces}
    if not shape or len(nodes) != CORNERS[shape] or len(distinct) < len(faces):
        return "", []
    if any(len({*face}) < len(face) for face in faces):
        return "", []
    base = next(face for face in faces if len(face) == (4 if shape == "Pyramid" else 3))
    opposite = nodes - {*base}
    if shape != "Prism":
        return shape, [*base, *opposite]
    edges = {
        frozenset(pair) for face in faces for pair in zip(face, [*face[1:], face[0]], strict=True)
    }
    above = [[far for far in opposite if frozenset((near, far)) in edges] for near in base]
    if any(len(each) != 1 for each in above):
        return "", []
    return shape, [*base, *(each[0] for each in above)]
