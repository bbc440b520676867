"""A whole contact surface with its mirror images: what lies within reach of each of its places.

Places are the nodes of the surface, by their numbers over all ranks, then the centres of facets
that are contact points. Every rank has all of them: of contact surfaces only.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import gather_rows
from fenics_contact.contact.surface.point_rule import AT_CENTRE
from fenics_contact.contact.surface.trace import Trace

# Over the extent of the surface: places nearer than that are one.
_SAME = 1e-8
# Rows of distances along a line that are made at a time: they are full.
_ROWS = 256

Pairs = tuple[Integers, Integers, Integers]  # rows, columns, and the copy that a column is of


class MirroredPlaces:
    """Places of a surface, and their copies behind planes of symmetry that the surface ends in.

    Attributes:
        mine: Places of this rank's contact points, (points,).
        coordinates: Of all places, (places, 3) (length).
        normals: Likewise, (places, components).
        nodes_of_places: Nodes that each place moves with, and their shares, (places, 1 or 6).
        signs: Of the mirror images along the axes, the surface itself first, (copies, 3).

    Args:
        trace: The contact points.
        reach: Distance up to which images count (length); collective.
    """

    def __init__(self, trace: Trace, reach: float) -> None:
        surface = trace.surface
        self._trace = trace
        nodes = surface.gathered(surface.coordinates)
        centres = gather_rows(surface.comm, trace.centres)
        self.coordinates = np.concatenate([nodes, centres])
        at_centres = gather_rows(surface.comm, trace.normals[len(trace.nodes) :])
        self.normals = np.concatenate([surface.gathered(trace.normals_at_nodes), at_centres])
        numbers = surface.numbers[trace.numbers].astype(np.int64)
        first = len(nodes) + _before_this_rank(trace)
        own = np.arange(first, first + len(trace.centres))
        self.mine: Integers = np.concatenate([numbers, own])
        self.nodes_of_places = self._nodes_of_places()
        self.signs, self._offsets = _images(trace, reach)
        self._same = self._identified()
        self._steps = self._neighbouring(own)

    def gathered(self, values: Array) -> Array:
        """Values at this rank's points, first axis points, at all places; 0 where is no point.

        Collective.
        """
        trace = self._trace
        at_nodes = trace.surface.gathered(trace.at_all_nodes(values[: len(trace.nodes)]))
        return np.concatenate(
            [at_nodes, gather_rows(trace.surface.comm, values[len(trace.nodes) :])]
        )

    def _nodes_of_places(self) -> tuple[Integers, Array]:
        """A node moves with itself, a centre with the nodes of its facet; collective."""
        trace, surface = self._trace, self._trace.surface
        count = surface.space.dofmap.index_map.size_global
        itself = np.arange(count)[:, None]
        if trace.nodal:
            return itself, np.ones((count, 1))
        facets = gather_rows(surface.comm, surface.numbers[surface.facet_nodes].astype(np.int64))
        width = facets.shape[1]
        nodes = np.concatenate([np.repeat(itself, width, axis=1), facets])
        shares = np.tile(AT_CENTRE, (len(nodes), 1))
        shares[:count] = np.eye(1, width)
        return nodes, shares

    def _copy(self, number: int) -> Array:
        """Coordinates of one of the copies, (places, 3)."""
        return np.asarray(self.signs[number] * self.coordinates + self._offsets[number])

    def _identified(self) -> Integers:
        """Numbers of the places of each copy, (copies, places); one in a plane is its own image."""
        places, size = len(self.coordinates), self._trace.extent()
        found = np.arange(len(self.signs) * places).reshape(len(self.signs), places)
        copies = [self._copy(number) for number in range(len(self.signs))]
        for number, copy in enumerate(copies):
            for earlier, other in enumerate(copies[:number]):
                same = np.abs(copy - other).max(axis=1, initial=0.0) <= _SAME * size
                found[number] = np.where(
                    same, np.minimum(found[number], found[earlier]), found[number]
                )
        return found

    def _neighbouring(self, own: Integers) -> csr_matrix:
        """Lengths of the straight lines between neighbours, over all copies; collective."""
        surface = self._trace.surface
        pieces = surface.numbers[self._trace.pieces.nodes].astype(np.int64)
        ends = [pieces[:, [a, b]] for a in range(pieces.shape[1]) for b in range(a)]
        if len(own):
            facets = surface.numbers[surface.facet_nodes].astype(np.int64)
            spokes = np.stack([np.repeat(own, facets.shape[1]), facets.ravel()], axis=1)
            ends.append(spokes)
        pairs = gather_rows(surface.comm, np.concatenate(ends))
        start, end = self.coordinates[pairs[:, 0]], self.coordinates[pairs[:, 1]]
        lengths = np.tile(np.linalg.norm(end - start, axis=1), len(self.signs))
        rows, columns = self._same[:, pairs[:, 0]].ravel(), self._same[:, pairs[:, 1]].ravel()
        _, once = np.unique(rows * self._same.size + columns, return_index=True)
        values = (lengths[once], (rows[once], columns[once]))
        return csr_matrix(coo_matrix(values, shape=(self._same.size,) * 2))

    def along_line(self, reach: float) -> tuple[Integers, Integers, Array]:
        """Places and images whose distance along the line of contact is below ``reach``.

        Returns:
            Rows, columns and distances; a column comes as often as it has images there.
        """
        rows, columns, distances = [], [], []
        places = len(self.coordinates)
        for start in range(0, places, _ROWS):
            chosen = np.arange(start, min(start + _ROWS, places))
            every = dijkstra(self._steps, directed=False, indices=chosen, limit=reach)
            found = every[:, self._same.ravel()]
            row, column = np.nonzero(found < reach)
            rows.append(chosen[row])
            columns.append(column % places)
            distances.append(found[row, column])
        return np.concatenate(rows), np.concatenate(columns), np.concatenate(distances)

    def straight(self, reach: float, axes: list[int]) -> Pairs:
        """Places and images of one connected part that a straight line below ``reach`` joins.

        Args:
            reach: Largest distance (length).
            axes: Along which it is measured.

        Returns:
            Rows, columns, and of which copy each column is.
        """
        from scipy.spatial import cKDTree  # a tenth of a second; few scenes need it

        _, parts = connected_components(self._steps, directed=False)
        tree = cKDTree(self.coordinates[:, axes])
        found = []
        for number in range(len(self.signs)):
            other = cKDTree(self._copy(number)[:, axes])
            near = tree.sparse_distance_matrix(other, reach, output_type="ndarray")
            together = parts[self._same[0, near["i"]]] == parts[self._same[number, near["j"]]]
            pairs = near[together]
            found.append(
                (
                    pairs["i"].astype(np.int64),
                    pairs["j"].astype(np.int64),
                    np.full(len(pairs), number),
                )
            )
        rows, columns, copies = (np.concatenate(part) for part in zip(*found, strict=True))
        return rows, columns, copies

    def images(self, columns: Integers, copies: Integers) -> tuple[Array, Array]:
        """Coordinates and normals of places of some copies, (pairs, 3) and (pairs, components)."""
        signs = self.signs[copies]
        normals = self.normals[columns]
        return (
            signs * self.coordinates[columns] + self._offsets[copies],
            signs[:, : normals.shape[1]] * normals,
        )


def _before_this_rank(trace: Trace) -> int:
    """How many centres the ranks before this one have; collective."""
    counts = gather_rows(trace.surface.comm, np.array([len(trace.centres)]))
    return int(counts[: trace.surface.comm.rank].sum())


def _images(trace: Trace, reach: float) -> tuple[Array, Array]:
    """Signs and offsets of a surface and its mirror images within reach, (copies, 3) each.

    Two planes that face each other mirror it again and again.
    """
    along: list[list[tuple[float, float]]] = [[(1.0, 0.0)] for _ in range(3)]
    planes = trace.symmetry.planes()
    for axis in range(3):
        stand = [at for on, at in planes if on == axis]
        if not stand:
            continue
        shifts, period = [0.0], 2 * (max(stand) - min(stand))
        if period > 0:
            most = int(np.ceil(reach / period)) + 1
            shifts = sorted((period * k for k in range(-most, most + 1)), key=abs)
        along[axis] = [(1.0, shift) for shift in shifts]
        along[axis] += [(-1.0, 2 * stand[0] + shift) for shift in shifts]
    every = np.array(list(product(*along)))
    return every[:, :, 0], every[:, :, 1]
