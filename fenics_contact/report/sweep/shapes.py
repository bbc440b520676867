"""Where contact points lie, as it is drawn: along a line, over a plane, or in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra, minimum_spanning_tree
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Integers

_NEIGHBOURS = 4
# Of the points of a line, where it is drawn through the nearest ones, hardly one has three.
_MOST_FORKS = 0.05
_FLAT = 1e-3  # thickness over extent of what counts as a plane
_ALONG_AXIS = 0.9999


@dataclass(frozen=True)
class Shape:
    """How contact points are drawn.

    Attributes:
        order: The points in the order in which they are drawn.
        positions: A row of coordinates for every axis of the drawing, in this order (length).
        labels: What its axes are called.
        breaks: Where a line is interrupted: numbers of points, in this order, that begin a piece.
        tangents: Unit vectors along a line, in this order, (points, 3); None of a surface.
        normal: Of a surface in space, on the whole; None of others.
    """

    order: Integers
    positions: Array
    labels: tuple[str, ...]
    breaks: Integers
    tangents: Array | None
    normal: Array | None = None


def shape_of(points: Array, kinematics: str | None) -> Shape:
    """How the points of a contact are drawn.

    Args:
        points: Undeformed, (points, 3).
        kinematics: Of the model; None where it is not known, and seen from the points.
    """
    letters = "rzθ" if kinematics == "axisymmetric" else "xyz"
    if kinematics != "3D" and not points[:, 2].any():
        pieces = _pieces(points)
        if kinematics is not None or _is_line(pieces):
            return _line(points, pieces, letters)
    return _surface(points, letters)


@dataclass(frozen=True)
class _Pieces:
    """Connected pieces of points, as each lies beside its nearest."""

    tree: csr_matrix
    number: int
    piece: Integers


def _pieces(points: Array) -> _Pieces:
    count = len(points)
    near = min(_NEIGHBOURS + 1, count)
    distances, others = cKDTree(points).query(points, k=near)
    distances, others = distances.reshape(count, near), others.reshape(count, near)
    # A distance of 0 would be no connection.
    least = 1e-12 * max(float(np.ptp(points, axis=0).max()), 1.0)
    own = np.repeat(np.arange(count), near - 1)
    weights = np.maximum(distances[:, 1:].ravel(), least)
    graph = csr_matrix((weights, (own, others[:, 1:].ravel())), shape=(count, count))
    tree = minimum_spanning_tree(graph.maximum(graph.T))
    number, piece = connected_components(tree, directed=False)
    return _Pieces(tree, number, piece.astype(np.int64))


def _is_line(pieces: _Pieces) -> bool:
    ends = np.concatenate(pieces.tree.nonzero())
    forks = np.bincount(ends, minlength=len(pieces.piece)) > 2
    return bool(forks.mean() < _MOST_FORKS)


def _line(points: Array, pieces: _Pieces, letters: str) -> Shape:
    axis = int(np.argmax(np.ptp(points, axis=0)))
    found = [_ordered(points, pieces, number, axis) for number in range(pieces.number)]
    found.sort(key=lambda piece: points[piece[0], axis].min())
    order = np.concatenate([indices for indices, _ in found])
    breaks = np.cumsum([len(indices) for indices, _ in found])[:-1]
    tangents = np.concatenate([_tangents(points[indices]) for indices, _ in found])
    coordinate = points[order, axis]
    if all((np.diff(points[indices, axis]) >= 0).all() for indices, _ in found):
        label, position = letters[axis], coordinate
    else:  # it turns back, as around a pin
        label, lengths, position = "arc length s", 0.0, np.zeros(0)
        for _, along in found:
            position = np.append(position, lengths + along)
            lengths += float(along[-1])
    return Shape(order, position[None], (label,), breaks, tangents)


def _ordered(points: Array, pieces: _Pieces, number: int, axis: int) -> tuple[Integers, Array]:
    """The points of a piece from one end to the other, and their arc lengths from the first."""
    own = np.flatnonzero(pieces.piece == number)
    inner = pieces.tree[own][:, own]
    far = np.argmax(dijkstra(inner, directed=False, indices=0))
    along = dijkstra(inner, directed=False, indices=far)
    order = np.argsort(along, kind="stable")
    if points[own[order[-1]], axis] < points[own[order[0]], axis]:
        along, order = along.max() - along, order[::-1]
    return own[order], along[order]


def _tangents(points: Array) -> Array:
    """From each point's neighbour before it to the one behind it."""
    if len(points) == 1:
        return np.array([[1.0, 0.0, 0.0]])
    behind = np.minimum(np.arange(len(points)) + 1, len(points) - 1)
    before = np.maximum(np.arange(len(points)) - 1, 0)
    steps = points[behind] - points[before]
    lengths = np.linalg.norm(steps, axis=1, keepdims=True)
    return np.asarray(steps / np.where(lengths > 0, lengths, 1.0))


def _surface(points: Array, letters: str) -> Shape:
    order, none = np.arange(len(points)), np.zeros(0, dtype=np.int64)
    centred = points - points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(centred, full_matrices=False)
    if len(points) < 3 or sizes[-1] > _FLAT * sizes[0]:
        normal = axes[-1]
        return Shape(order, points.T, tuple(letters), none, None, normal)
    normal = axes[2]
    across = int(np.argmax(np.abs(normal)))
    if abs(normal[across]) > _ALONG_AXIS:
        rest = [axis for axis in range(3) if axis != across]
        labels = (letters[rest[0]], letters[rest[1]])
        return Shape(order, points[:, rest].T, labels, none, None)
    labels = ("along the surface", "across, along the surface")
    return Shape(order, (centred @ axes[:2].T).T, labels, none, None)
