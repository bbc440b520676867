"""Cells that lie against each other or in each other, and share no nodes there.

A mesh whose nodes were not merged looks whole, and is torn: nothing carries a force from a cell to
its neighbour. Bodies in contact look the same, so that what a file names as a surface is meant.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import basix
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.mesh.cell_checks import vertex_keys
from fenics_contact.mesh.tagged_mesh import Group

# Distances over the size of a cell: of nodes in one place, and of a node on a side.
_ONE_PLACE, _ON_SIDE = 1e-4, 1e-6
_MERGE = "merge the nodes that lie in one place"
_NEAREST = 4  # cells that are looked at for another's middle
# Of points on an outer facet: how many along an edge, in how many cells they are looked for, and
# how far inside they must be, over the cell's size.
_ALONG, _AROUND, _INSIDE = 5, 20, 1e-3
_CHUNK = 50_000  # points that are looked at together: bounds the memory
# Kinds of facets by their corners.
_FACETS = {
    2: basix.CellType.interval,
    3: basix.CellType.triangle,
    4: basix.CellType.quadrilateral,
}


@dataclass(frozen=True)
class Finding:
    """A finding on the neighbours of cells.

    Attributes:
        words: A sentence, without its full stop.
        is_wrong: Whether no mesh can mean it.
    """

    words: str
    is_wrong: bool


def connected_pieces(corners: Integers, count: int) -> Integers:
    """The connected piece of each cell, by number in the cells' order.

    Args:
        corners: Of each cell, as places among the points.
        count: Of all points.
    """
    rows = np.repeat(corners[:, 0], corners.shape[1])
    links = (np.ones(rows.size), (rows, corners.ravel()))
    _, of_point = connected_components(coo_array(links, shape=(count, count)), directed=False)
    found = of_point[corners[:, 0]]
    _, first, inverse = np.unique(found, return_index=True, return_inverse=True)
    return np.asarray(np.argsort(np.argsort(first))[inverse])


@dataclass(eq=False)
class Neighbours:
    """Looks for such cells in a mesh.

    Attributes:
        cell: Kind of the cells, such as ``tetrahedron``.
        points: Nodes, shape (nodes, dimension) (length).
        cells: Nodes of each cell in dolfinx's order.
        tags: Part of each cell.
        elements: By which number the file knows each cell.
        facets: Nodes of each facet of a group, in dolfinx's order.
        facet_tags: Part of each.
        groups: Of facets, that the file or the scene names.
    """

    cell: str
    points: Array
    cells: Integers
    tags: NDArray[Any]
    elements: Integers
    facets: Integers
    facet_tags: NDArray[Any]
    groups: list[Group]

    def __post_init__(self) -> None:
        kind = getattr(basix.CellType, self.cell)
        self._places = np.array(basix.topology(kind)[-2])
        self._corners = self.cells[:, : len(basix.geometry(kind))]
        self._at = self.points[self._corners]
        self._middles = self._at.mean(axis=1)
        self._sizes = np.linalg.norm(np.ptp(self._at, axis=1), axis=1)
        apart = np.linalg.norm(self._at - self._middles[:, None], axis=-1)
        self._radii = apart.max(axis=1)
        self._pieces = connected_pieces(self._corners, len(self.points))
        facets = self._corners[:, self._places]
        keys = vertex_keys(facets, len(self.points))
        _, inverse, counts = np.unique(keys, return_inverse=True, return_counts=True)
        outer = (counts[inverse] == 1).reshape(keys.shape)
        self._owner = np.nonzero(outer)[0]
        self._outer, self._keys = facets[outer], keys[outer]

    def findings(self) -> Iterator[Finding]:
        """All of them, one of a kind at the most."""
        yield from self._in_one_place()
        yield from self._seams()
        yield from self._misfits()
        yield from self._crossings()
        yield from self._overlaps()
        yield from self._hinges()

    @cached_property
    def _tree(self) -> Any:
        """Search tree of the cells' middles."""
        return cKDTree(self._middles)

    @cached_property
    def _nearest(self) -> tuple[Array, Integers]:
        """Distances to the middles of the nearest cells, each its own first, and these cells."""
        count = min(1 + _NEAREST, len(self._middles))
        distances, cells = self._tree.query(self._middles, k=count)
        return distances.reshape(-1, count), cells.reshape(-1, count)

    def _in_one_place(self) -> Iterator[Finding]:
        """Cells with one middle: the same one twice, with nodes of its own."""
        if len(self._middles) < 2:
            return
        distances, cells = self._nearest
        same = np.flatnonzero(distances[:, 1] < _ONE_PLACE * self._sizes)
        if len(same):
            row = same[0]
            other = cells[row, 1] if cells[row, 1] != row else cells[row, 0]
            place = self._place(self._middles[row])
            yield Finding(
                f"{self._both(row, other)} lie in one place, at {place}, each "
                f"with nodes of its own ({len(same)} cells are such): the same body is there "
                "twice; remove one of the two",
                True,
            )

    def _seams(self) -> Iterator[Finding]:
        """Facets in one place, of cells on both sides, that nothing names."""
        first, second = self._facets_in_one_place()
        named = self._named
        unnamed = ~(named[first] | named[second])
        unnamed &= self._are_compared(self._owner[first], self._owner[second])
        one, two = self._owner[first[unnamed]], self._owner[second[unnamed]]
        is_one_body = (self._pieces[one] == self._pieces[two]) | (self.tags[one] == self.tags[two])
        for is_wrong in (True, False):
            chosen = np.flatnonzero(is_one_body == is_wrong)
            if len(chosen) == 0:
                continue
            row, other = one[chosen[0]], two[chosen[0]]
            place = self._place(self.points[self._outer[first[unnamed][chosen[0]]]].mean(axis=0))
            words = (
                f"{self._both(row, other)} lie against each other at {place}, and share no nodes "
                f"there ({len(chosen)} such facets)"
            )
            if is_wrong:
                words += (
                    f": {_MERGE}; or, where bodies or the sides of a crack touch there, name their "
                    "facets as a surface"
                )
            else:
                words += (
                    ", nor does a surface name their facets: they are not connected there, and no "
                    "contact can be; where they are one body, merge these nodes"
                )
            yield Finding(words, is_wrong)
            return

    def _facets_in_one_place(self) -> tuple[Integers, Integers]:
        """Places of outer facets that have the same corners by their coordinates, once each."""
        at = self.points[self._outer]
        middles, sizes = at.mean(axis=1), np.linalg.norm(np.ptp(at, axis=1), axis=1)
        distances, found = cKDTree(middles).query(middles, k=2)
        own = np.arange(len(middles))
        other = np.where(found[:, 1] == own, found[:, 0], found[:, 1])
        chosen = np.flatnonzero((distances[:, 1] < _ONE_PLACE * sizes) & (own < other))
        other = other[chosen]
        apart = np.linalg.norm(at[chosen][:, :, None] - at[other][:, None], axis=-1).min(axis=2)
        same = (apart < _ONE_PLACE * sizes[chosen][:, None]).all(axis=1)
        return chosen[same], other[same]

    @cached_property
    def _named(self) -> Flags:
        """Flags of outer facets in a group, except groups of all facets of a piece."""
        keys = vertex_keys(self.facets[:, : self._outer.shape[1]], len(self.points))
        piece = self._pieces[self._owner]
        all_of_piece = np.bincount(piece)
        found = np.zeros(len(self._keys), dtype=bool)
        for group in self.groups:
            members = np.isin(self._keys, keys[np.isin(self.facet_tags, group.tags)])
            count = np.bincount(piece[members], minlength=len(all_of_piece))
            if not (count == all_of_piece).any():
                found |= members
        return found

    def _misfits(self) -> Iterator[Finding]:
        """Nodes of the boundary in a cell of the same piece, or on its side, that has them not."""
        nodes = np.unique(self._outer)
        outer_cells = np.unique(self._owner)
        near = cKDTree(self.points[nodes]).query_ball_point(
            self._middles[outer_cells], self._radii[outer_cells]
        )
        cells = np.repeat(outer_cells, [len(found) for found in near])
        candidates = nodes[np.concatenate(near).astype(np.int64)]
        piece_of_node = np.full(len(self.points), -1)
        piece_of_node[self._corners] = self._pieces[:, None]
        keep = piece_of_node[candidates] == self._pieces[cells]
        at = np.linalg.norm(self._at[cells] - self.points[candidates][:, None], axis=-1)
        keep &= (at > _ONE_PLACE * self._sizes[cells][:, None]).all(axis=1)
        cells, candidates = cells[keep], candidates[keep]
        depth = self._depths(cells, self.points[candidates])
        is_named = np.isin(candidates, self._outer[self._named])
        inside = depth > np.where(is_named, 1e-2, -_ON_SIDE)
        if inside.any():
            place = self._place(self.points[candidates[inside][0]])
            yield Finding(
                f"the node at {place} lies in the element {self.elements[cells[inside][0]]}, or on "
                f"a side of it, and is none of its nodes ({inside.sum()} such nodes): cells "
                "overlap, or do not fit together; mend the mesh",
                True,
            )

    def _crossings(self) -> Iterator[Finding]:
        """Outer facets that run through a cell of the same piece."""
        kind = _FACETS[self._outer.shape[1]]
        lattice = basix.create_lattice(kind, _ALONG, basix.LatticeType.equispaced, False)
        shapes = basix.create_element(basix.ElementFamily.P, kind, 1).tabulate(0, lattice)[
            0, :, :, 0
        ]
        points = np.einsum("sn,fnd->fsd", shapes, self.points[self._outer])
        owner = np.repeat(self._owner, len(lattice))
        points = points.reshape(-1, points.shape[2])
        count = min(_AROUND, len(self._middles))
        near = self._tree.query(points, k=count)[1].reshape(-1)
        owner, points = np.repeat(owner, count), np.repeat(points, count, axis=0)
        keep = (near != owner) & (self._pieces[near] == self._pieces[owner])
        keep &= np.linalg.norm(points - self._middles[near], axis=1) < self._radii[near]
        near, owner, points = near[keep], owner[keep], points[keep]
        inside = self._depths(near, points) > _INSIDE
        if inside.any():
            first, second = self.elements[owner[inside][0]], self.elements[near[inside][0]]
            place = self._place(points[inside][0])
            yield Finding(
                f"a side of the element {first} runs through the element {second} at {place}: "
                "cells overlap; mend the mesh",
                True,
            )

    def _overlaps(self) -> Iterator[Finding]:
        """Cells whose middle lies in a cell of another piece."""
        if self._pieces.max(initial=0) == 0:
            return
        _, found = self._nearest
        own = np.repeat(np.arange(len(found)), found.shape[1])
        other = found.reshape(-1)
        keep = self._pieces[own] != self._pieces[other]
        own, other = own[keep], other[keep]
        inside = self._depths(other, self._middles[own]) > _ONE_PLACE
        if inside.any():
            first, second = self._one(own[inside][0]), self._one(other[inside][0])
            yield Finding(
                f"the middle of {first} lies in {second}, of another body "
                f"({inside.sum()} such cells): the bodies overlap by more than half a cell",
                False,
            )

    def _hinges(self) -> Iterator[Finding]:
        """Nodes, in space edges, by which alone cells hang together.

        Four outer facets meet there, where two meet everywhere else on the boundary.
        """
        kind = _FACETS[self._outer.shape[1]]
        ends = np.array(basix.topology(kind)[-2])  # of a facet: its corners, in space its edges
        ridges = self._outer[:, ends]
        keys = vertex_keys(ridges, len(self.points))
        _, first, counts = np.unique(keys, return_index=True, return_counts=True)
        many = np.flatnonzero(counts > 2)
        if len(many):
            place = self._place(
                self.points[ridges.reshape(-1, ends.shape[1])[first[many[0]]]].mean(0)
            )
            what = "a node" if self.points.shape[1] == 2 else "an edge"
            yield Finding(
                f"cells hang together by {what} alone at {place} ({len(many)} such places): they "
                "turn about it as about a hinge; join them by a side, or take them apart",
                False,
            )

    def _depths(self, cells: Integers, points: Array) -> Array:
        """How far points are inside cells, over their size; what facets are not plane by is off."""
        found = [np.zeros(0)]
        for start in range(0, len(cells), _CHUNK):
            chosen = slice(start, start + _CHUNK)
            found.append(self._depths_at_once(cells[chosen], points[chosen]))
        return np.concatenate(found)

    def _depths_at_once(self, cells: Integers, points: Array) -> Array:
        at = self._at[cells][:, self._places]
        origin = at.mean(axis=2)
        if points.shape[1] == 2:
            along = at[:, :, 1] - at[:, :, 0]
            normals = np.stack([along[..., 1], -along[..., 0]], axis=-1)
        else:  # diagonals of four corners in dolfinx's order, two sides of a triangle
            last = at.shape[2] - 1
            normals = np.cross(at[:, :, last] - at[:, :, 0], at[:, :, 2] - at[:, :, 1])
        normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)
        inwards = np.einsum("cfd,cfd->cf", normals, self._middles[cells][:, None] - origin)
        normals *= np.sign(inwards)[..., None]
        warp = np.abs(np.einsum("cfd,cfnd->cfn", normals, at - origin[:, :, None])).max(axis=(1, 2))
        depth = np.einsum("cfd,cfd->cf", normals, points[:, None] - origin).min(axis=1)
        return np.asarray((depth - 2 * warp) / self._sizes[cells])

    def _one(self, cell: int) -> str:
        """A cell in words."""
        return f"the element {self.elements[cell]}"

    def _both(self, cell: int, other: int) -> str:
        """Two cells in words."""
        first, second = sorted((int(self.elements[cell]), int(self.elements[other])))
        return f"the elements {first} and {second}"

    def _are_compared(self, cells: Integers, others: Integers) -> Flags:
        """Whether each pair of cells is compared, (pairs,); all of them here."""
        return np.ones(len(cells), dtype=bool)

    def _place(self, point: Array) -> str:
        return f"({', '.join(f'{value:g}' for value in point)})"
