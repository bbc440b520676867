"""Sizes of the cells of the next mesh, from the errors of the cells of the last one.

An error that is of order p in the energy norm makes of a cell of size h, in d dimensions, a share
C h^(2p + d) of its square. Over all meshes of so many cells its sum is least where all cells have
the same (as many cells as C's d/(2p + d)-th power says), so the sizes are

    h_new = h (t/η²)^(1/(2p + d))

with the error squared η² of each cell, and one number t from the cells wanted. Where the error is
far above the mean, it is taken for that at a singular point, which falls slower with the size.
Arrays only, on one rank.
"""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from fenics_contact.common.arrays import Array, Flags, Integers

# A cell becomes at most so many times smaller, or larger, from one mesh to the next.
FINER, COARSER = 8.0, 2.0
# Cells with an error squared of so many times the mean are taken to be at a singular point of
# displacements r^λ, with the λ of a bonded edge or a crack: there η² ~ h^(2λ).
SINGULAR, _EXPONENT = 4.0, 0.5
# Largest slope of the sizes: neighbours then differ by less than half.
_SLOPE = 0.5
# Rounds in which the cells lost or won by that are made up for.
_ROUNDS = 6


def _parts(*parts: tuple[tuple[int, int], ...]) -> Array:
    """From pairs of corners, in the middle of which each part has a corner."""
    number = len(parts[0])
    unit = np.eye(number)
    return np.array([[(unit[a] + unit[b]) / 2 for a, b in part] for part in parts])


# Vertices of a cell in dolfinx's order, around it where it is flat, and its edges.
_AROUND = {"triangle": (0, 1, 2), "quadrilateral": (0, 1, 3, 2), "tetrahedron": (0, 1, 2, 3)}
_EDGES = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quadrilateral": ((0, 1), (1, 3), (3, 2), (2, 0)),
    "tetrahedron": ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)),
}
# Measure of the equilateral cell with edges of length 1.
_UNIT = {"triangle": np.sqrt(3) / 4, "quadrilateral": 1.0, "tetrahedron": np.sqrt(2) / 12}


# Corners of the parts that a cell is cut into, by its own: (parts, corners, corners of the cell).
_SPLIT = {
    "triangle": _parts(
        ((0, 0), (0, 1), (0, 2)),
        ((0, 1), (1, 1), (1, 2)),
        ((0, 2), (1, 2), (2, 2)),
        ((0, 1), (1, 2), (0, 2)),
    ),
    "quadrilateral": _parts(
        ((0, 0), (0, 1), (0, 2), (0, 3)),
        ((0, 1), (1, 1), (1, 2), (0, 2)),
        ((0, 2), (1, 2), (2, 2), (2, 3)),
        ((0, 3), (0, 2), (2, 3), (3, 3)),
    ),
    "tetrahedron": _parts(
        ((0, 0), (0, 1), (0, 2), (0, 3)),
        ((0, 1), (1, 1), (1, 2), (1, 3)),
        ((0, 2), (1, 2), (2, 2), (2, 3)),
        ((0, 3), (1, 3), (2, 3), (3, 3)),
        ((0, 1), (0, 2), (0, 3), (1, 3)),
        ((0, 1), (0, 2), (1, 2), (1, 3)),
        ((0, 2), (0, 3), (1, 3), (2, 3)),
        ((0, 2), (1, 2), (1, 3), (2, 3)),
    ),
}
# How often, and how far below the mean of the corners a size in the middle has to be for it.
_CUTS, _LINEAR = 4, 0.8


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of a mesh of one type, without their curvature.

    Attributes:
        cell: Such as ``triangle``.
        points: Of the vertices, (vertices, dimension) (length).
        vertices: Of each cell in dolfinx's order, (cells, corners).
    """

    cell: str
    points: Array
    vertices: Integers

    @property
    def dimension(self) -> int:
        """Dimension of the cells."""
        return int(self.points.shape[1])

    def sizes(self) -> Array:
        """Edge of the equilateral cell of the same measure, of each (length)."""
        corners = self.points[self.vertices[:, list(_AROUND[self.cell])]]
        edges = corners[:, 1:] - corners[:, :1]
        if self.cell == "tetrahedron":
            measure = np.abs(np.linalg.det(edges)) / 6
        else:
            turned = edges[:, :-1, 0] * edges[:, 1:, 1] - edges[:, :-1, 1] * edges[:, 1:, 0]
            measure = np.abs(turned.sum(axis=1)) / 2
        return np.asarray((measure / _UNIT[self.cell]) ** (1 / self.dimension))

    def edges(self) -> Integers:
        """Pairs of vertices, each once."""
        pairs = self.vertices[:, np.array(_EDGES[self.cell])].reshape(-1, 2)
        return np.unique(np.sort(pairs, axis=1), axis=0)

    def part(self, chosen: Flags) -> tuple[Cells, Integers]:
        """Some of the cells with their own vertices only, and which vertices these are."""
        used, vertices = np.unique(self.vertices[chosen], return_inverse=True)
        shape = (int(chosen.sum()), self.vertices.shape[1])
        return Cells(self.cell, self.points[used], vertices.reshape(shape)), used


@dataclass(frozen=True, eq=False)
class SizeField:
    """Sizes of cells to be made, linear between the vertices of cells that there are.

    Attributes:
        cell: Shape of the cells to be made.
        points: Vertices of each cell, (cells, corners, 3) (length).
        sizes: At these, (cells, corners) (length).
        parts: Gmsh's number of the body that each cell is of, (cells,); bodies that touch have
            sizes of their own so. None where all sizes are of all bodies.
    """

    cell: str
    points: Array
    sizes: Array
    parts: Integers | None = None

    @staticmethod
    def of(cells: Cells, sizes: Array, parts: Integers | None = None) -> SizeField:
        """From the sizes at the vertices of cells, (vertices,), and the cells' bodies."""
        around = cells.vertices[:, list(_AROUND[cells.cell])]
        points = np.zeros((*around.shape, 3))
        points[:, :, : cells.dimension] = cells.points[around]
        return SizeField(cells.cell, points, sizes[around], parts)

    def finer_at(self, places: Array, wanted: Array) -> SizeField:
        """One that follows smaller sizes at places also inside the cells, which it cuts there.

        Args:
            places: (places, dimension) (length).
            wanted: At each place; sizes grow from there (length).
        """
        if len(places) == 0:
            return self
        from scipy.spatial import cKDTree

        tree = cKDTree(places)

        def at(points: Array) -> Array:
            away, nearest = tree.query(points[..., : places.shape[1]])
            return np.asarray(wanted[nearest] + _SLOPE * away)

        points, sizes = self.points, np.minimum(self.sizes, at(self.points))
        cells = np.arange(len(points))
        for _ in range(_CUTS):
            middle = points.mean(axis=1)
            cut = at(middle) < _LINEAR * sizes.mean(axis=1)
            children = np.einsum("kij,njx->nkix", _SPLIT[self.cell], points[cut])
            between = np.einsum("kij,nj->nki", _SPLIT[self.cell], sizes[cut])
            shape = (-1, *points.shape[1:])
            points = np.concatenate([points[~cut], children.reshape(shape)])
            between = np.minimum(between, at(children)).reshape(-1, points.shape[1])
            sizes = np.concatenate([sizes[~cut], between])
            cells = np.concatenate([cells[~cut], np.repeat(cells[cut], len(_SPLIT[self.cell]))])
        parts = None if self.parts is None else self.parts[cells]
        return SizeField(self.cell, points, sizes, parts)

    def as_bytes(self) -> bytes:
        """An ``.npz`` for ``gmsh_process``."""
        buffer = io.BytesIO()
        parts = np.zeros(0, dtype=np.int64) if self.parts is None else self.parts
        np.savez(buffer, points=self.points, sizes=self.sizes, parts=parts)
        return buffer.getvalue()


def next_sizes(cells: Cells, squared: Array, order: int, number: float) -> Array:
    """Sizes at the vertices, for a mesh of so many cells.

    Args:
        cells: Of the last mesh.
        squared: Their errors squared, ≥ 0, (cells,).
        order: Of the error in the energy norm: the degree of the displacements.
        number: Of cells wanted; it may be missed where no cell may become that much smaller.

    Returns:
        At each vertex (length).
    """
    old = cells.sizes()
    exponent = 1 / (2 * order + cells.dimension)
    floor = 1e-12 * max(float(squared.max(initial=0.0)), np.finfo(float).tiny)
    shares = np.maximum(squared, floor) ** -exponent
    excess = np.maximum(squared / (SINGULAR * max(squared.mean(), floor)), 1.0)
    shares *= excess ** (exponent - 1 / (2 * _EXPONENT))
    edges, wanted = cells.edges(), number
    sizes = np.zeros(len(cells.points))
    for _ in range(_ROUNDS):
        at_cells = _with_number(old, shares, cells.dimension, wanted)
        sizes = graded(cells.points, edges, _at_vertices(cells, at_cells))
        found = expected_number(cells, sizes)
        if abs(found / number - 1) < 0.02:
            break
        wanted *= number / found
    return sizes


def finer_at(cells: Cells, sizes: Array, places: Array, wanted: Array) -> Array:
    """Sizes at the vertices that are no larger than wanted at some places, and grow from there.

    Args:
        cells: Of the last mesh.
        sizes: At the vertices (length).
        places: Such as those that an edge of contact passes, (places, dimension) (length).
        wanted: At each place (length).
    """
    if len(places) == 0:
        return sizes
    from scipy.spatial import cKDTree

    away, nearest = cKDTree(places).query(cells.points)
    return np.asarray(np.minimum(sizes, wanted[nearest] + _SLOPE * away))


def expected_number(cells: Cells, sizes: Array) -> float:
    """How many cells a mesh of these sizes at the vertices is to have."""
    around = cells.vertices[:, list(_AROUND[cells.cell])]
    new = sizes[around] @ _inside(cells.cell).T
    return float(((cells.sizes()[:, None] / new) ** cells.dimension).mean(axis=1).sum())


def _inside(cell: str) -> Array:
    """Points spread over a cell, by its corners: the middles of the parts of its parts."""
    parts = _SPLIT[cell]
    twice = np.einsum("aij,bjk->abik", parts, parts).reshape(-1, *parts.shape[1:])
    return np.asarray(twice.mean(axis=1))


def _with_number(old: Array, shares: Array, dimension: int, number: float) -> Array:
    """Sizes c h shares within their bounds, with c from the number of cells; by bisection."""

    def sizes(logarithm: float) -> Array:
        ratio = np.clip(np.exp(logarithm) * shares / shares.max(), 1 / FINER, COARSER)
        return np.asarray(old * ratio)

    low, high = -np.log(FINER) - 1, np.log(COARSER * shares.max() / shares.min()) + 1
    for _ in range(60):
        middle = (low + high) / 2
        if ((old / sizes(middle)) ** dimension).sum() > number:
            low = middle
        else:
            high = middle
    return sizes(high)


def _at_vertices(cells: Cells, at_cells: Array) -> Array:
    """Geometric mean of the cells around each vertex."""
    corners = cells.vertices.reshape(-1)
    logarithms = np.repeat(np.log(at_cells), cells.vertices.shape[1])
    number = len(cells.points)
    sums = np.bincount(corners, logarithms, minlength=number)
    return np.asarray(np.exp(sums / np.bincount(corners, minlength=number)))


def graded(points: Array, edges: Integers, sizes: Array, slope: float = _SLOPE) -> Array:
    """The largest sizes below the given ones that grow by at most a slope along the edges.

    That is min over w of sizes(w) + slope × the way from w: shortest ways from a point that
    reaches each vertex by its size.
    """
    number = len(points)
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    source = np.full(number, number)
    rows = np.concatenate([edges[:, 0], edges[:, 1], source])
    columns = np.concatenate([edges[:, 1], edges[:, 0], np.arange(number)])
    weights = np.concatenate([slope * lengths, slope * lengths, sizes])
    ways = coo_array((weights, (rows, columns)), shape=(number + 1, number + 1)).tocsr()
    return np.asarray(dijkstra(ways, indices=number)[:number])
