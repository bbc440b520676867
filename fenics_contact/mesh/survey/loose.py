"""Pieces that can be taken off: contacts open in some rigid motion and close nowhere.

With friction all other motions are resisted. The motion that opens most is found by linear
programming: maximise the sum of the openings, where none may be negative.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from scipy.optimize import linprog

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.survey.facing import Pair
from fenics_contact.mesh.survey.survey import Survey

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
