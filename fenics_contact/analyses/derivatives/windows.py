"""Means of a derivative over a window: as wide as a cell at the edges of contact and of stick.

The kernel of the mean is the convolution of two boxes. Where both edges move, each box is as wide
as what moves one of them by a cell; else both are of the one that moves. What repeats from cell to
cell cancels. Where slopes change along the window by more than in proportion, their mean is off by
h²/12 times their second derivative, h being half its width: so a parabola is fitted to them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.analyses.derivatives.window_answers import WindowAnswer
from fenics_contact.common.arrays import Array

# Intervals between the answers of a window; and where an area jumps inside of them.
INTERVALS, INTERVALS_OF_AREAS = 8, 16
# Half of a window at most, over the size of the number.
_WIDEST = 0.25
# Where no edge moves, over the same.
_STILL = 0.01
# The first look is so wide, over the same; and so many looks find how fast the edges move.
_FIRST, _LOOKS = 0.02, 12
# Cells that the faster edge is to move by, in a look that tells how fast.
_FEWEST, _MOST = 0.7, 3.0

# Cells that an edge moves by in the widest window, from which it moves at all.
_MOVES = 0.05

# Answer at a place, None where there is none; collective.
Answers = Callable[[float], WindowAnswer | None]
# Cells that each edge moves between two answers; collective.
Moved = Callable[[WindowAnswer, WindowAnswer], Array]


@dataclass(frozen=True)
class Window:
    """Where answers are asked for, and what of the mean is of each interval between them.

    Attributes:
        places: Increasing, the number itself in the middle, (intervals + 1,).
        shares: Of each interval, 1 in all, (intervals,).
        is_narrow: Whether it is narrower than a cell, though edges move: a wider one would change
            the number by too much.
    """

    places: Array
    shares: Array
    is_narrow: bool = False

    @classmethod
    def of_boxes(
        cls,
        middle: float,
        first: float,
        second: float,
        intervals: int = INTERVALS,
        is_narrow: bool = False,
    ) -> Window:
        """The window of two boxes.

        Args:
            middle: The number.
            first: Width of one box.
            second: Width of the other.
            intervals: Between its answers.
            is_narrow: As the attribute.
        """
        half, a, b = (first + second) / 2, first / 2, second / 2
        offsets = np.linspace(-half, half, intervals + 1)
        ramps = [np.maximum(offsets + s, 0.0) ** 2 / 2 for s in (a + b, a - b, b - a, -a - b)]
        below = (ramps[0] - ramps[1] - ramps[2] + ramps[3]) / (4 * a * b)
        return cls(middle + offsets, np.diff(below), is_narrow)

    @property
    def middles(self) -> Array:
        """Middles of the intervals (unit of the number)."""
        return np.asarray(0.5 * (self.places[1:] + self.places[:-1]))

    def mean(self, values: Sequence[float]) -> tuple[float, float]:
        """Mean derivative, and how far the slopes of intervals are off what changes steadily.

        For quantities that jump inside the window, such as areas.

        Args:
            values: Of the answers at the places.
        """
        slopes = np.diff(values) / np.diff(self.places)
        return float(self.shares @ slopes), float(np.abs(self._unsteady(slopes, 1)).max())

    def slope(self, values: Sequence[float]) -> tuple[float, float]:
        """Derivative in the middle, and the spread, of a quantity that is smooth but for cells.

        Args:
            values: Of the answers at the places.
        """
        slopes = np.diff(values) / np.diff(self.places)
        found, spread = self.at_middle(slopes)
        # Over an interval of width w, x² is in the mean w²/12 larger than in the middle.
        of_intervals = self._fit(slopes, 2)[2] * (2 / len(slopes)) ** 2 / 12
        return found - float(of_intervals), spread

    def at_middle(self, slopes: Array | Sequence[float]) -> tuple[float, float]:
        """Derivative in the middle, and the spread, from those at the middles of the intervals.

        They may change steadily along it: that is fitted, and taken at the place in the middle.
        """
        found = np.asarray(slopes)
        residuals, fit = self._unsteady(found, 2), self._fit(found, 2)
        return float(fit[0]), float(np.abs(residuals).max())

    def _fit(self, slopes: Array, degree: int) -> Array:
        """Coefficients of the polynomial that fits slopes best, by shares, about the middle."""
        offsets = self._offsets
        weights = np.sqrt(self.shares)
        powers = np.vander(offsets, degree + 1, increasing=True)
        return np.asarray(np.linalg.lstsq(powers * weights[:, None], slopes * weights)[0])

    def _unsteady(self, slopes: Array, degree: int) -> Array:
        """Return the residuals of slopes from the polynomial that fits them best."""
        powers = np.vander(self._offsets, degree + 1, increasing=True)
        return np.asarray(slopes - powers @ self._fit(slopes, degree))

    @property
    def _offsets(self) -> Array:
        """Middles of the intervals, from -1 to 1."""
        half = 0.5 * (self.places[-1] - self.places[0])
        return np.asarray((self.middles - 0.5 * (self.places[-1] + self.places[0])) / half)


def find_window(
    answers: Answers, moved: Moved, middle: float, size: float, intervals: int = INTERVALS
) -> Window | None:
    """The window about a number; collective.

    Args:
        answers: With the number at a place.
        moved: How far edges move between answers.
        middle: The number.
        size: What changes of it are measured by, > 0.
        intervals: Between the answers of the window.

    Returns:
        None where no answers are to be had on both sides.
    """
    widest, half = _WIDEST * size, _FIRST * size
    cells: Array | None = None
    for _ in range(_LOOKS):
        below, above = answers(middle - half), answers(middle + half)
        if below is None or above is None:
            widest = min(widest, half / 2)
            half, cells = half / 4, None
            continue
        cells = moved(below, above)
        fastest = float(cells.max(initial=0.0))
        wanted = half * float(np.clip(1.5 / max(fastest, 1e-9), 0.05, 20.0))
        if _FEWEST <= fastest <= _MOST or (fastest < _FEWEST and half >= widest):
            break
        half = min(wanted, widest)
    if cells is None:
        return None
    boxes = sorted(2 * half / found for found in cells.tolist() if found > 0)
    moves = bool(boxes) and boxes[0] < 2 * widest / _MOVES
    boxes = [box for box in boxes if box <= 2 * widest]
    is_narrow = moves and not boxes
    boxes = boxes or [min(widest, _STILL * size)]
    first = min(boxes[0], widest)
    second = boxes[-1] if (first + boxes[-1]) / 2 <= widest else first
    return Window.of_boxes(middle, first, second, intervals, is_narrow)
