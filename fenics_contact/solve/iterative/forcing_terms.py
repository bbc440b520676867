"""How exactly the linear system of each Newton step is solved.

Few digits are asked for far from the answer, and more as the imbalance falls (S. C. Eisenstat and
H. F. Walker, SIAM J. Sci. Comput. 17 (1996) 16-32).
"""

from __future__ import annotations

# Share of the forces that the first linear solve leaves; later ones leave this times the last
# reduction to this power.
_FIRST = 0.03
_FIRST_BETWEEN_BODIES = 0.01  # nothing is settled there before
_FACTOR, _POWER = 0.9, 1.5
# What is left after a step that has come to little: it is not to be for want of digits.
_AFTER_STAGNATION = 1e-3
# An imbalance that is not reduced to this share stagnates.
_GAIN = 0.5
# The last solve is to end the Newton steps.
_BELOW_TOLERANCE = 0.5


class ForcingTerms:
    """Shares of the forces that linear solves may leave, one after the other.

    Attributes:
        stagnates: Whether the imbalance has hardly fallen with the last step.

    Args:
        is_nonlinear: Whether anything is; else the first solve is the last.
        between_bodies: Whether there is contact between bodies.
    """

    def __init__(self, is_nonlinear: bool, between_bodies: bool) -> None:
        self._first = _FIRST_BETWEEN_BODIES if between_bodies else _FIRST
        self._is_nonlinear = is_nonlinear
        self._before = 0.0
        self.stagnates = False

    def next(self, imbalance: float, enough: float) -> float:
        """That of the next solve.

        Args:
            imbalance: At present (force).
            enough: At which Newton's method ends (force).
        """
        before, self._before = self._before, imbalance
        self.stagnates = imbalance > _GAIN * before > 0
        last = _BELOW_TOLERANCE * enough / imbalance
        if not self._is_nonlinear:
            return last
        share = self._first
        if self.stagnates:
            share = _AFTER_STAGNATION
        elif before > 0:
            share = min(_FACTOR * (imbalance / before) ** _POWER, self._first)
        return max(share, last)
