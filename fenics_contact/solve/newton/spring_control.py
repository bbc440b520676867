"""How stiff the springs are that keep steps of Newton's method short.

They start stiff enough for bodies of which contact holds hardly anything. Where steps bring little,
as where a small stiffness resists a motion that springs hold back, they are made softer, and where
the imbalance grows they are made stiffer (D. W. Marquardt, SIAM J. Appl. Math. 11 (1963) 431-441).
Near the answer they vanish with the imbalance, so that the last steps are those of Newton's method.
"""

from __future__ import annotations

from collections.abc import Sequence

# Stiffness over that of the body at the same dof. Rings of 4 to 20 rollers took fewer steps with
# the first than with a tenth of it; the softest is next to nothing.
_FIRST, _SOFTEST, _STIFFEST = 1e-3, 1e-9, 1e-2
_FACTOR = 10.0
# Of an imbalance over the one before: more than grows, and less than is brought down.
_GROWS, _FALLS = 3.0, 0.3
# Imbalance over the forces from which springs vanish with it.
_NEAR = 1e-3
# Imbalance over that at the start, and over the forces there, from which steps run far.
_FAR = 100.0


def run_far(imbalances: Sequence[float], forces: float) -> bool:
    """Whether steps went far beyond where contact holds a body, so that springs are wanted.

    Args:
        imbalances: Before every step of the solve so far, the present one last (force).
        forces: On the body at the start of the solve (force).
    """
    return imbalances[-1] > _FAR * max(imbalances[0], forces)


class SpringControl:
    """The springs of one solve."""

    def __init__(self) -> None:
        self._share = self._last = _FIRST

    @property
    def held_back(self) -> bool:
        """Whether springs that were more than next to nothing were in the last step."""
        return self._last > _FACTOR * _SOFTEST

    def release(self) -> None:
        """Leave next to nothing of the springs from now on."""
        self._share = 0.0

    def share(self, imbalances: Sequence[float], forces: float) -> float:
        """Stiffness of the springs in the step that comes now, over that of the body.

        Args:
            imbalances: Before every step of the solve so far, the present one last (force).
            forces: What an imbalance is small against (force).
        """
        *earlier, present = imbalances
        if earlier and present > _GROWS * earlier[-1]:
            self._share = min(self._share * _FACTOR, _STIFFEST)
        elif earlier and present > _FALLS * earlier[-1]:
            self._share = max(self._share / _FACTOR, _SOFTEST)
        near = present / (_NEAR * forces) if forces > 0 else 1.0
        self._last = max(self._share * min(near, 1.0), _SOFTEST)
        return self._last
