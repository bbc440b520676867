"""Easier problems on the way to an answer: springs that vanish and penalties that harden.

How stiff the springs are that keep steps of Newton's method short. They start stiff enough for
bodies of which contact holds hardly anything. Where steps bring little, as where a small stiffness
resists a motion that springs hold back, they are made softer, and where the imbalance grows they
are made stiffer (D. W. Marquardt, SIAM J. Appl. Math. 11 (1963) 431-441). Near the answer they
vanish with the imbalance, so that the last steps are those of Newton's method.

Contact found under a soft penalty first, which is then hardened step by step. Where bodies bend
far more easily than their surfaces give way, Newton's method with the stiff penalty goes on point
by point: each step is cut where the next point closes, and hundreds of points have to change one
after the other. Under a penalty as soft as the bodies themselves many change in each step, and
every harder one begins near its answer (path-following: M. Hintermüller, K. Kunisch, SIAM J.
Optim. 17 (2006) 159-187).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions

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


# Softest penalty, over the stiffness E/L of a body as long as the contact: leaves a hundred times
# as long as thick bend by a hundred thousandth of it.
_SOFTEST_PENALTY = 1e-6
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
    stiffness = _SOFTEST_PENALTY * contact.moduli.combined / contact.trace.extent()
    return 1 / (stiffness * contact.penalty_parameter)
