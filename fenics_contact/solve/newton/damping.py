"""Shorter steps where full ones go round in circles.

Full Newton steps on contact and friction together can come back, after a few of them, to points
that touch, stick and slip as before: seen where two contacts with friction share an edge, each of
which presses on the other's points as these slip. A few half steps lead out of the circle, and
full ones end the solve as fast as ever.
"""

from __future__ import annotations

from collections.abc import Sequence

# Steps in which the least imbalance so far is to halve at least.
_PATIENCE = 8
_PROGRESS = 0.5
# Steps from the adhesive start in which the imbalance tells nothing.
_FIRST = 3
# Share of a step, and how many such steps the first time; twice as many each time after.
_SHARE = 0.5
_FEWEST, _MOST = 2, 16


class Damping:
    """How much of each full step of one solve to take."""

    def __init__(self) -> None:
        self._left = 0
        self._next = _FEWEST
        self._last = 0  # damped step

    def share(self, imbalances: Sequence[float]) -> float:
        """Share of the step that comes now.

        Args:
            imbalances: Before every step of the solve so far, the present one last (force).
        """
        count = len(imbalances)
        if self._left == 0 and self._is_stuck(imbalances):
            self._left = self._next
            self._next = min(2 * self._next, _MOST)
        if self._left == 0:
            return 1.0
        self._left -= 1
        self._last = count
        return _SHARE

    def _is_stuck(self, imbalances: Sequence[float]) -> bool:
        """Whether the last full steps brought nothing."""
        if len(imbalances) <= max(self._last, _FIRST) + _PATIENCE:
            return False
        before, recent = imbalances[_FIRST:-_PATIENCE], imbalances[-_PATIENCE:]
        return min(recent) > _PROGRESS * min(before)
