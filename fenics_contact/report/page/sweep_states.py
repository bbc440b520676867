"""The contact states of a sweep as its page holds them: where points lie, and packed values."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra, minimum_spanning_tree
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.report.page.sweep_files import ContactStates

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
    """Connected pieces of a set of points, each joined to its nearest ones."""

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


# Entries that a page holds in 5 MB: nine bytes each.
_MOST_ENTRIES = 450_000
# Contact points of one state, where they are thinned out.
_FEWEST_POINTS = 400
_LARGEST, _NOTHING = 32_767, -32_768  # of 16 bits
FIELDS = ("contact pressure", "friction traction", "slip", "gap")
MEASURED = {
    "contact pressure": "stress",
    "friction traction": "stress",
    "slip": "length",
    "gap": "length",
}


@dataclass(frozen=True)
class _State:
    """A contact at a point of the grid.

    Attributes:
        point: Row of ``sweep.csv``.
        contact: Number of the contact.
        entries: Rows of the arrays of all states.
    """

    point: int
    contact: int
    entries: Integers


def packed_states(states: ContactStates | None, kinematics: str | None) -> dict[str, object]:
    """The states as a page holds them.

    Args:
        states: Those of the sweep; None where no point has an answer.
        kinematics: Of the model, if it is known.

    Returns:
        ``shapes`` (where contact points lie, each once), ``states`` (a row of point, contact,
        shape and the size of each field, by which its numbers are to be multiplied), the numbers
        of all states in this order by field as whole numbers of 16 bits, ``status`` of 8, and
        ``thinned``, what was left out, in a sentence; ``rough`` says of the contacts, by their
        numbers, whether friction acts anywhere.
    """
    packer = _Packer(kinematics)
    found = [] if states is None else list(_split(states))
    kept, every = _thinned(found)
    for state in kept:
        assert states is not None
        packer.add(state, states, every)
    return packer.packed() | {"thinned": _said(found, kept, every), "rough": _rough(states)}


def _rough(states: ContactStates | None) -> dict[int, bool]:
    """Whether a contact carries a force along the surface at any point of the sweep."""
    if states is None:
        return {}
    acts = np.any([states.numbers[f"traction_{axis}"] != 0 for axis in "xyz"], axis=0)
    return {int(n): bool(acts[states.contact == n].any()) for n in np.unique(states.contact)}


def _split(states: ContactStates) -> Iterator[_State]:
    """In the order of points and contacts."""
    order = np.lexsort((states.contact, states.point))
    both = np.column_stack([states.point, states.contact])[order]
    starts = np.flatnonzero(np.any(np.diff(both, axis=0, prepend=-1), axis=1))
    for entries in np.split(order, starts[1:]):
        yield _State(int(states.point[entries[0]]), int(states.contact[entries[0]]), entries)


def _thinned(found: list[_State]) -> tuple[list[_State], int]:
    """The states that a page holds, and which of their contact points: every so many."""
    total = sum(len(state.entries) for state in found)
    if total <= _MOST_ENTRIES:
        return found, 1
    largest = max(len(state.entries) for state in found)
    every = min(-(-total // _MOST_ENTRIES), max(1, largest // _FEWEST_POINTS))
    points = sorted({state.point for state in found})
    left = sum(-(-len(state.entries) // every) for state in found)
    kept = set(points[:: -(-left // _MOST_ENTRIES)])
    return [state for state in found if state.point in kept], every


def _said(found: list[_State], kept: list[_State], every: int) -> str:
    """Return in a sentence what was left out; empty where nothing was."""
    said = []
    if every > 1:
        said.append(f"one of {every} contact points")
    if len(kept) < len(found):
        points = [len({state.point for state in states}) for states in (kept, found)]
        said.append(f"the contact at {points[0]} of {points[1]} points of the sweep")
    return f"To stay small, this page has {' and '.join(said)}; states.npz has all." if said else ""


class _Packer:
    """States one after the other."""

    def __init__(self, kinematics: str | None) -> None:
        self._kinematics = kinematics
        self._shapes: list[tuple[Shape, dict[str, object]]] = []
        self._known: dict[bytes, int] = {}
        self._rows: list[list[float]] = []
        self._fields: dict[str, list[NDArray[np.int16]]] = {name: [] for name in FIELDS}
        self._status: list[NDArray[np.int8]] = []

    def add(self, state: _State, states: ContactStates, every: int) -> None:
        """Take a state in.

        Args:
            state: It.
            states: That it is of.
            every: Of so many contact points one is taken.
        """
        number = self._shape(states.vectors("", state.entries), every)
        shape = self._shapes[number][0]
        rows = state.entries[shape.order]
        row: list[float] = [state.point, state.contact, number]
        for name, values in _numbers(states, rows, shape).items():
            whole, size = _whole(values)
            self._fields[name].append(whole)
            row.append(size)
        self._rows.append(row)
        self._status.append(states.status[rows].astype(np.int8))

    def _shape(self, points: Array, every: int) -> int:
        """Number of the shape of contact points, which meshes of the same points share."""
        key = np.asarray(points, dtype="<f4").tobytes()
        if key not in self._known:
            shape = _every(shape_of(points, self._kinematics), every)
            drawn = {
                "positions": [_packed(axis.astype("<f4")) for axis in shape.positions],
                "labels": list(shape.labels),
                "breaks": shape.breaks.tolist(),
                "normal": None if shape.normal is None else shape.normal.tolist(),
            }
            self._known[key] = len(self._shapes)
            self._shapes.append((shape, drawn))
        return self._known[key]

    def packed(self) -> dict[str, object]:
        """All that was taken in."""
        fields = {
            name: _packed(np.concatenate(parts).astype("<i2")) if parts else ""
            for name, parts in self._fields.items()
        }
        status = _packed(np.concatenate(self._status)) if self._status else ""
        shapes = [drawn for _, drawn in self._shapes]
        return {"shapes": shapes, "states": self._rows, "fields": fields, "status": status}


def _every(shape: Shape, every: int) -> Shape:
    """A shape with one of so many points; of a surface at random, or stripes would be seen."""
    count = len(shape.order)
    if every == 1 or count <= _FEWEST_POINTS:
        return shape
    kept = np.arange(0, count, every)
    if shape.tangents is None:
        kept = np.sort(np.random.default_rng(0).choice(count, len(kept), replace=False))
    return Shape(
        order=shape.order[kept],
        positions=shape.positions[:, kept],
        labels=shape.labels,
        breaks=np.searchsorted(kept, shape.breaks),
        tangents=None if shape.tangents is None else shape.tangents[kept],
        normal=shape.normal,
    )


def _numbers(states: ContactStates, rows: Integers, shape: Shape) -> dict[str, Array]:
    """The fields of a state: of vectors the component along a line, over a surface the length."""
    found = {"contact pressure": states.numbers["contact_pressure"][rows]}
    for name, key in (("friction traction", "traction"), ("slip", "slip")):
        vectors = states.vectors(key, rows)
        if shape.tangents is None:
            found[name] = np.linalg.norm(vectors, axis=1)
        else:
            found[name] = np.sum(vectors * shape.tangents, axis=1)
    return found | {"gap": states.numbers["gap"][rows]}


def _whole(values: Array) -> tuple[NDArray[np.int16], float]:
    """Numbers as whole numbers of 16 bits, and the size of one; not a number as the least."""
    known: Flags = np.isfinite(values)
    largest = float(np.abs(values[known]).max(initial=0.0))
    size = largest / _LARGEST if largest > 0 else 1.0
    whole = np.full(len(values), _NOTHING, dtype=np.int16)
    whole[known] = np.rint(values[known] / size).astype(np.int16)
    return whole, size


def _packed(values: NDArray[np.generic]) -> str:
    return base64.b64encode(values.tobytes()).decode("ascii")
