"""Contact found under a soft penalty first, which is then hardened step by step.

Where bodies bend far more easily than their surfaces give way, Newton's method with the
stiff penalty goes on point by point: each step is cut where the next point closes, and hundreds of
points have to change one after the other. Under a penalty as soft as the bodies themselves many
change in each step, and every harder one begins near its answer (path-following: M. Hintermüller,
K. Kunisch, SIAM J. Optim. 17 (2006) 159-187).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions

# Softest penalty, over the stiffness E/L of a body as long as the contact: leaves a hundred times
# as long as thick bend by a hundred thousandth of it.
_SOFTEST = 1e-6
# From one penalty to the next.
_HARDER = 30.0


class PenaltyPath:
    """Penalties of a problem's contacts, from soft ones to their own.

    Args:
        problem: The problem; contacts that stand for a give of their own are left as they are.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._contacts = [c for c in problem.contacts if c.is_one_sided and c.has_penalty]
        self._own = [contact.normal.penalty.softness for contact in self._contacts]

    @property
    def exists(self) -> bool:
        """Whether there is a penalty to soften, and supports hold all bodies; collective.

        Bodies that contact alone holds run far under a soft penalty, to where others touch.
        """
        return bool(self._contacts) and RigidMotions(self._problem).count == 0

    def softer(self) -> Iterator[None]:
        """Set penalties softer than their own, each harder than the one before; collective.

        Yields:
            Once for each, to be solved with.
        """
        most = max((_most(contact) for contact in self._contacts), default=1.0)
        while most > 1:
            for contact, factor in zip(self._contacts, self._own, strict=True):
                contact.normal.penalty.soften(factor * max(min(most, _most(contact)), 1.0))
            yield
            most /= _HARDER

    def follow(self, solve: Callable[[], None]) -> None:
        """Solve under each of the softer penalties; at the end contacts have their own; collective.

        Args:
            solve: Goes on from where it ended before.
        """
        try:
            for _ in self.softer():
                solve()
        finally:
            self.harden()

    def harden(self) -> None:
        """Set the contacts' own penalties again."""
        for contact, factor in zip(self._contacts, self._own, strict=True):
            contact.normal.penalty.soften(factor)


def _most(contact: ContactSurface) -> float:
    """Factor by which a contact's penalty is softened at first; collective."""
    stiffness = _SOFTEST * contact.moduli.combined / contact.trace.extent()
    return 1 / (stiffness * contact.penalty_parameter)
