"""A fixed point x = F(x) of arrays spread over the ranks, between bounds, by few evaluations of F.

Anderson's method (J. ACM 12 (1965) 547-560) combines earlier evaluations so that their residuals
F(x) − x cancel. Far from the answer these tell little of F, whose slope may be large and negative.
So a step is kept within a radius about the best x so far: where it led beyond the answer, it is
tried again with a quarter of its length, by evaluations from near there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total

_DEPTH = 10  # earlier evaluations that are combined
_NEAR = 8.0  # of the radius: how far from the best x an earlier evaluation still tells of F
_SHORTER, _LONGER = 0.25, 4.0  # of a step that led too far, and after one that did not
# Of the largest: parts of residuals' differences that are smaller are round-off of F.
_INDEPENDENT = 1e-10


@dataclass(frozen=True, eq=False)
class _Evaluation:
    """An evaluation of F at x.

    Attributes:
        at: x, this rank's entries, also those of others.
        residual: F(x) − x there, 0 where it points out of the bounds.
        size: Length of the residual over all ranks.
    """

    at: Array
    residual: Array
    size: float


class FixedPoint:
    """The way to a fixed point; collective.

    Args:
        comm: Of the arrays.
        owned: Entries of this rank's arrays that count here.
        highest: Upper bound of every entry; the lower one is 0.
        finds_nearest: Whether a fixed point near the first x is wanted also where F leads away
            from it; else another one is found then.
    """

    def __init__(
        self, comm: MPI.Comm, owned: Flags, highest: Array, finds_nearest: bool = False
    ) -> None:
        self._comm, self._owned, self._highest = comm, owned, highest
        self._finds_nearest = finds_nearest
        self._best: _Evaluation | None = None
        self._earlier: list[_Evaluation] = []
        self._radius = np.inf

    def next(self, at: Array, value: Array) -> Array:
        """Return where to evaluate F next; collective.

        Args:
            at: x of the last evaluation, within the bounds.
            value: F(x).
        """
        residual = value - at
        points_out = (at <= 0) & (residual < 0) | (at >= self._highest) & (residual > 0)
        residual = np.where(points_out, 0.0, residual)
        found = _Evaluation(at, residual, self._length(residual))
        self._judge(found)
        assert self._best is not None
        step = self._combined(self._best)
        length = self._length(step)
        if length > self._radius:
            step = step * (self._radius / length)
        return np.clip(self._best.at + step, 0.0, self._highest)

    def _judge(self, found: _Evaluation) -> None:
        """Take an evaluation as the best one, or shorten the step where it led too far."""
        best = self._best
        if best is None:
            self._best = found
            return
        length = self._length(found.at - best.at)
        if found.size > best.size and self._dot(found.residual, best.residual) <= 0:
            self._radius = _SHORTER * length
            self._keep(found)
            return
        if found.size > best.size and not self._finds_nearest:
            # Away from an answer that F leaves: towards another one, of which nothing is known yet.
            self._earlier, self._radius = [], np.inf
        else:
            self._keep(best)
            self._radius = max(self._radius, _LONGER * length)
        self._best = found

    def _keep(self, evaluation: _Evaluation) -> None:
        self._earlier = [*self._earlier[1 - _DEPTH :], evaluation]

    def _combined(self, best: _Evaluation) -> Array:
        """Anderson's step from the best x by earlier evaluations near it."""
        near = [
            one
            for one in self._earlier
            if 0 < self._length(one.at - best.at) <= _NEAR * self._radius
        ]
        changes = [best.residual - one.residual for one in near]
        sizes = [self._length(one) for one in changes]
        used = [number for number, size in enumerate(sizes) if size > 0]
        step = best.residual
        if not used:
            return step
        units = np.array([changes[n][self._owned] / sizes[n] for n in used])
        gram = np.asarray(total(self._comm, units @ units.T))
        right = np.asarray(total(self._comm, units @ best.residual[self._owned]))
        shares = np.linalg.lstsq(gram, right, rcond=_INDEPENDENT)[0]
        for share, n in zip(shares, used, strict=True):
            step = step - share / sizes[n] * (best.at - near[n].at + changes[n])
        return step

    def _dot(self, one: Array, other: Array) -> float:
        return float(total(self._comm, float(one[self._owned] @ other[self._owned])))

    def _length(self, values: Array) -> float:
        return float(np.sqrt(self._dot(values, values)))
