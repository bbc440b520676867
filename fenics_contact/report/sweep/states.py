"""The contact states of a sweep as its page holds them: thinned out, rounded and packed."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.report.sweep.files import ContactStates
from fenics_contact.report.sweep.shapes import Shape, shape_of

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
