"""When Newton's method on contact and friction together is given up, so that another way comes."""

from __future__ import annotations

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.solve.coulomb.friction_scale import fits
from fenics_contact.solve.newton.failure import GIVEN_UP, GROWS
from fenics_contact.solve.newton.newton import Newton

# Of the ε that is needed over that which was guessed, beyond which Newton's method is not to go on
# for long: below it takes hardly more steps. Newton steps after which that is looked at.
_TOO_SMALL = 100.0
_LONG = 12
# So many imbalances, each of so many times the least forces of the solve, are far away from any
# answer: seen under a coefficient of 20 and more, where a point that comes to touch with a wrong
# slip is pulled by many times the pressure. A hundred steps did not lead back.
_MANY = 5
_FAR = 100.0


class GrowsError(NotConvergedError):
    """The force imbalance grew far beyond the forces: another way is to be taken."""


class Watch:
    """Looks at each Newton step of one solve on contact and friction together; collective.

    Attributes:
        grows: Whether the solve was given up because its imbalance grows.

    Args:
        newton: That solves.
        of_scale: Whether an ε that is much too small ends the solve.
        of_growth: Whether imbalances far beyond the forces do, as there are other ways.
    """

    def __init__(self, newton: Newton, of_scale: bool, of_growth: bool) -> None:
        self._newton, self._of_scale, self._of_growth = newton, of_scale, of_growth
        self._least = float("inf")
        self._far = 0
        self.grows = False

    def __call__(self, iteration: int) -> int:
        """PETSc's reason to give up where a Newton step would begin; 0 to go on.

        Args:
            iteration: Newton steps so far.
        """
        if self._of_growth and self._is_far():
            self.grows = True
            return GROWS
        is_long = iteration > 0 and iteration % _LONG == 0
        if self._of_scale and is_long and is_out_of_scale(self._newton):
            return GIVEN_UP
        return 0

    def _is_far(self) -> bool:
        imbalance = self._newton.imbalances[-1]
        self._least = min(self._least, max(self._newton.system.forces, imbalance))
        self._far += imbalance > _FAR * self._least
        return self._far >= _MANY


def is_out_of_scale(newton: Newton) -> bool:
    """Whether some ε is much less than what the present pressures need; collective."""
    scaled: list[ContactSurface] = [
        c for c in newton.problem.coulomb if c.friction.regularisation.is_known
    ]
    return not all([fits(contact, float("inf"), _TOO_SMALL) for contact in scaled])
