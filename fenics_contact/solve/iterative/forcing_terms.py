"""How exactly the linear system of each Newton step is solved.

Few digits are asked for far from the answer, and more as the imbalance falls (S. C. Eisenstat and
H. F. Walker, SIAM J. Sci. Comput. 17 (1996) 16-32).
"""

from __future__ import annotations

# Share of the forces that the first linear solve leaves; later ones leave this times the last
# reduction to this power.
_FIRST = 0.03
# Between bodies nothing is settled before a step. What the imbalance does says little as long as it
# is more than a share of the forces: the solve leaves as much. Later ones start with fewer.
_FAR, _FAR_BETWEEN_BODIES = 0.01, 0.1
_FIRST_BETWEEN_BODIES = 0.01
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
        self._between_bodies = between_bodies
        self._first = _FIRST_BETWEEN_BODIES if between_bodies else _FIRST
        self._is_nonlinear = is_nonlinear
        self._before = 0.0
        self.stagnates = False

    def next(self, imbalance: float, enough: float, forces: float) -> float:
        """Forcing term of the next linear solve.

        Args:
            imbalance: At present (force).
            enough: At which Newton's method ends (force).
            forces: What the imbalance is small against (force).
        """
        before, self._before = self._before, imbalance
        self.stagnates = imbalance > _GAIN * before > 0
        last = _BELOW_TOLERANCE * enough / imbalance
        if not self._is_nonlinear:
            return last
        share = self._first
        if self._between_bodies and imbalance > _FAR * forces:
            share = _FAR_BETWEEN_BODIES
        elif self.stagnates:
            share = _AFTER_STAGNATION
        elif before > 0:
            share = min(_FACTOR * (imbalance / before) ** _POWER, self._first)
        return max(share, last)
