"""Closed loops of force against displacement, and the work of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array

# The ends of a loop are this near to each other, over its extent, in displacement and in force.
_CLOSED = 1e-2
# Loops thinner than this, area over the box around them, are also drawn without what is elastic.
THIN = 0.1


@dataclass(frozen=True)
class Loop:
    """The last closed loop of a path.

    Attributes:
        first: Number of its first point.
        last: Of its last.
        x: Displacements (length).
        y: Forces.
    """

    first: int
    last: int
    x: Array
    y: Array

    @property
    def work(self) -> float:
        """∮ F du: of the drive, > 0 what it puts in (energy)."""
        return float(np.sum((self.y[1:] + self.y[:-1]) / 2 * np.diff(self.x)))

    @property
    def is_thin(self) -> bool:
        """Whether it looks like a line."""
        return bool(abs(self.work) < THIN * np.ptp(self.x) * np.ptp(self.y))

    @property
    def compliance(self) -> float:
        """Compliance of the straight line between the turning points (length/force)."""
        low, high = int(np.argmin(self.x)), int(np.argmax(self.x))
        return float((self.x[high] - self.x[low]) / (self.y[high] - self.y[low] or 1.0))


def last_loop(x: Array, y: Array) -> Loop | None:
    """The last part of a path that comes back to where it was; None where it never turned twice.

    Args:
        x: Displacements, (points,) (length).
        y: Forces, (points,).
    """
    turns = _turns(x)
    for start in reversed(turns[:-1]):
        for end in reversed([number for number in (*turns, len(x) - 1) if number > start + 2]):
            near = abs(x[end] - x[start]) < _CLOSED * np.ptp(x[start : end + 1])
            near &= abs(y[end] - y[start]) < _CLOSED * np.ptp(y[start : end + 1])
            if near:
                return Loop(start, end, x[start : end + 1], y[start : end + 1])
    return None


def _turns(x: Array) -> list[int]:
    """The points at which the direction changes, with the first one of what moves."""
    steps = np.diff(x)
    moving = np.flatnonzero(np.abs(steps) > 1e-9 * (np.ptp(x) or 1.0))
    if len(moving) == 0:
        return [0]
    signs = np.sign(steps[moving])
    changed = np.flatnonzero(signs[1:] != signs[:-1])
    return [int(moving[0]), *(int(number) for number in moving[changed + 1])]
