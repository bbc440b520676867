"""Guesses about bodies of a file: those that look like bolts, and pieces that can be taken off.

Pieces that can be taken off: contacts open in some rigid motion and close nowhere. With friction
all other motions are resisted. The motion that opens most is found by linear programming: maximise
the sum of the openings, where none may be negative.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.optimize import linprog

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.survey.facing import Pair
from fenics_contact.mesh.survey.survey import FoundSurface, Survey

_MOST = 300  # points of a pair that are looked at
_OPEN = 1e-6  # of motions of at most 1


def loose_pieces(found: Survey, pairs: Sequence[Pair], held: Collection[int]) -> set[int]:
    """Pieces that move apart from another at a contact, in the motion that opens most.

    Args:
        found: Bodies and surfaces.
        pairs: The contacts.
        held: Pieces that a support holds.
    """
    count = max((piece for body in found.bodies for piece in body.pieces), default=-1) + 1
    ends = [_pieces(found, pair) for pair in pairs]
    rows = [_openings(found, pair, both, count) for pair, both in zip(pairs, ends, strict=True)]
    if not rows:
        return set()
    every = np.concatenate(rows)
    free = [1.0, 1, 1, 1, 1, 1] if found.dimension == 3 else [1.0, 1, 0, 0, 0, 1]
    limits = np.concatenate([np.array(free) * (piece not in held) for piece in range(count)])
    bounds = np.column_stack([-limits, limits])
    best = linprog(-every.mean(axis=0), A_ub=-every, b_ub=np.zeros(len(every)), bounds=bounds)
    opened = [both for row, both in zip(rows, ends, strict=True) if (row @ best.x).max() > _OPEN]
    return {piece for both in opened for piece in both} - set(held)


def _pieces(found: Survey, pair: Pair) -> tuple[int, int]:
    return found.surfaces[pair.first[0]].piece, found.surfaces[pair.second[0]].piece


def _openings(found: Survey, pair: Pair, pieces: tuple[int, int], count: int) -> Array:
    """Openings by unit motions of all pieces at points of a pair, (points, 6 pieces)."""
    sides = [[found.surfaces[n] for n in side] for side in (pair.first, pair.second)]
    smaller = int(sum(s.measure for s in sides[1]) < sum(s.measure for s in sides[0]))
    places = np.concatenate([s.triangles.reshape(-1, 3) for s in sides[smaller]])
    normals = np.concatenate([np.repeat(s.normals, 3, axis=0) for s in sides[smaller]])
    step = max(1, len(places) // _MOST)
    places, normals = places[::step] / found.size, normals[::step]
    rows = np.zeros((len(places), 6 * count))
    for side, sign in ((smaller, -1), (1 - smaller, 1)):
        first = 6 * pieces[side]
        rows[:, first : first + 3] = sign * normals
        rows[:, first + 3 : first + 6] = sign * np.cross(places, normals)
    return rows


_PARALLEL = 1 - 1e-9  # cosine
_ALIKE = 1e-6  # of places, over the diagonal of all
_MIDDLE = 0.3, 0.7  # of the length between the shoulders: where a bolt may be cut


@dataclass(frozen=True)
class Bolt:
    """A body that looks like a bolt.

    Attributes:
        body: Its index.
        axis: Unit vector along it, (3,).
        between: Two places along the axis, from the origin, in the middle of its shank (length).
        area: Of the shank's section.
    """

    body: int
    axis: tuple[float, ...]
    between: tuple[float, float]
    area: float


def bolts(found: Survey, pairs: Sequence[Pair]) -> list[Bolt]:
    """Bodies whose plane shoulders press others together, with a cylinder from one to the other.

    Args:
        found: Bodies and surfaces.
        pairs: Surfaces that face each other.
    """
    touching: dict[int, set[int]] = {}
    for pair in pairs:
        for body, side in zip(pair.bodies, (pair.first, pair.second), strict=True):
            touching.setdefault(body, set()).update(side)
    looked = (_bolt(found, body, sorted(places)) for body, places in sorted(touching.items()))
    return [bolt for bolt in looked if bolt is not None]


def _bolt(found: Survey, body: int, places: Sequence[int]) -> Bolt | None:
    shoulders = [s for s in (found.surfaces[n] for n in places) if s.shape.kind == "plane"]
    near = _ALIKE * found.size
    for shank, axis in _shanks(found, body):
        ends = [(float(s.normals[0] @ axis), float(s.triangles[0, 0] @ axis)) for s in shoulders]
        for (one, start), (other, end) in itertools.permutations(ends, 2):
            reach = shank.triangles.reshape(-1, 3) @ axis
            spans = reach.min() <= start + near and end - near <= reach.max()
            if one >= _PARALLEL and other <= -_PARALLEL and start + near < end and spans:
                first, last = (start + share * (end - start) for share in _MIDDLE)
                radius = shank.shape.radius or 0.0
                return Bolt(body, tuple(axis.tolist()), (first, last), pi * radius**2)
    return None


def _shanks(found: Survey, body: int) -> Iterator[tuple[FoundSurface, Array]]:
    """Round surfaces of a body that bulge outwards, and their axes."""
    for surface in found.surfaces:
        if surface.bodies == (body,) and surface.shape.kind == "cylinder" and surface.is_outward:
            yield surface, np.array(surface.shape.axis)
