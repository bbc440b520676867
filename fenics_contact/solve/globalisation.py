"""Ways of Newton's method from afar: searches along steps, springs, penalties that harden.

A search along a Newton step goes to where the energy's slope along it vanishes. One by bracketing
never goes beyond the step, and always ends near the zero. Secants ask for a few tries at most, and
are for where steps follow that correct each other.

Steps are shorter where full ones go round in circles. Full Newton steps on contact and friction
together can come back, after a few of them, to points that touch, stick and slip as before: seen
where two contacts with friction share an edge, each of which presses on the other's points as
these slip. A few half steps lead out of the circle, and full ones end the solve as fast as ever.

Springs keep steps of Newton's method short where contact alone holds a body. They start stiff
enough for bodies of which contact holds hardly anything. Where steps bring little, as where a
small stiffness resists a motion that springs hold back, they are made softer, and where the
imbalance grows they are made stiffer (D. W. Marquardt, SIAM J. Appl. Math. 11 (1963) 431-441).
Near the answer they vanish with the imbalance, so that the last steps are those of Newton's
method.

Contact is found under a soft penalty first, which is then hardened step by step. Where bodies bend
far more easily than their surfaces give way, Newton's method with the stiff penalty goes on point
by point: each step is cut where the next point closes, and hundreds of points have to change one
after the other. Under a penalty as soft as the bodies themselves many change in each step, and
every harder one begins near its answer (path-following: M. Hintermüller, K. Kunisch, SIAM J.
Optim. 17 (2006) 159-187).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions

# Derivative at the end over that at the start, from which it has vanished; and from
# which secants are content.
_FLAT = 0.1
_NEARLY_FLAT = 0.5
_MOST_SECANTS = 5
_SHORTEST, _LONGEST = 0.05, 2.0
_MOST_TRIALS = 80
# Ratio of the slopes at the ends from which they are alike.
_ALIKE = 10.0


def share_of_step(slope_at: Callable[[float], float]) -> float:
    """Share of a step up to which energy falls, at most the whole; a bracket that shrinks.

    Secants alone go to and fro without end where a soft body meets a stiff penalty: on one side
    of the point where it closes the slope is nearly even, on the other side it is a million times
    steeper. So the interval is halved until its ends are alike, and then cut by false position,
    with the end that stays weighted down (the Illinois rule: M. Dowell, P. Jarratt, BIT 11 (1971)
    168-174).

    Args:
        slope_at: Derivative of the energy along the step, at a share of it.

    Returns:
        The share, > 0; 1 where energy falls all the way, or does not fall at the start.
    """
    low, high = 0.0, 1.0
    first = at_low = slope_at(low)
    at_high = slope_at(high)
    if first >= 0 or at_high <= -_FLAT * first:
        return high
    last = 0.0
    for _ in range(_MOST_TRIALS):
        share = (low * at_high - high * at_low) / (at_high - at_low)
        if at_high > -_ALIKE * first or not low < share < high:
            share = 0.5 * (low + high)
        found = slope_at(share)
        if abs(found) <= -_FLAT * first:
            return share
        weight = 0.5 if found * last > 0 else 1.0
        if found > 0:
            high, at_high, at_low = share, found, weight * at_low
        else:
            low, at_low, at_high = share, found, weight * at_high
        last = found
    return high  # where what closes is seen by the next step


def search_by_secants(slope_at: Callable[[float], float], slope: float) -> float:
    """Secants for a zero of the energy's derivative along a step, from the whole step.

    Args:
        slope_at: Derivative of the energy along the step, at a share of it.
        slope: At its start.

    Returns:
        The share that was tried last; it may be more than 1.
    """
    near, near_slope = 0.0, slope
    share, found = 1.0, slope_at(1.0)
    for _ in range(_MOST_SECANTS):
        if abs(found) <= _NEARLY_FLAT * abs(slope) or found == near_slope:
            break
        following = share - found * (share - near) / (found - near_slope)
        near, near_slope = share, found
        share = min(max(following, _SHORTEST), _LONGEST)
        found = slope_at(share)
    return share


# Full steps are best from the adhesive start with the primal-dual tangent, where searches only
# cost steps or stall in round-off. One-sided contact needs a search on the energy: for a point
# along the step where its derivative vanishes, which takes no difference of nearly equal energies.
FULL_STEPS: dict[str, Any] = {"snes_linesearch_type": "basic"}
# Its absolute tolerance would be in the user's units, and end a solve behind our back.
ENERGY_SEARCH: dict[str, Any] = {
    "snes_linesearch_type": "cp",
    "snes_linesearch_max_it": 3,
    "snes_linesearch_atol": 1e-300,
}
# Where that does not come near enough to the point, as with very flat cells, or with a slender
# body that would bend far through an obstacle: steps are cut before they are taken.
THOROUGH_SEARCH = dict(FULL_STEPS)

# Newton steps of the energy search at the most; and how many of them are to bring the imbalance
# to which share of the least before.
QUICK = 50
_LATELY, _FALLS = 5, 0.1
# Newton steps under each of several softer penalties: the next one begins where they end.
ON_THE_WAY = 4


def comes_no_nearer(imbalances: Sequence[float]) -> bool:
    """Whether the last steps of a search brought nothing, as where most of them are cut short.

    Args:
        imbalances: Before every step of the solve so far, the present one last (force).
    """
    if len(imbalances) <= 2 * _LATELY:
        return False
    return min(imbalances[-_LATELY:]) > _FALLS * min(imbalances[:-_LATELY])


# Steps in which the least imbalance so far is to halve at least.
_PATIENCE = 8
_PROGRESS = 0.5
# Steps from the adhesive start in which the imbalance tells nothing.
_UNTOLD = 3
# Share of a step, and how many such steps the first time; twice as many each time after.
_SHARE = 0.5
_FEWEST, _MOST = 2, 16


class StepDamping:
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
        if len(imbalances) <= max(self._last, _UNTOLD) + _PATIENCE:
            return False
        before, recent = imbalances[_UNTOLD:-_PATIENCE], imbalances[-_PATIENCE:]
        return min(recent) > _PROGRESS * min(before)


# Stiffness over that of the body at the same dof. Rings of 4 to 20 rollers took fewer steps with
# the first than with a tenth of it; the softest is next to nothing.
_FIRST, _SOFTEST, _STIFFEST = 1e-3, 1e-9, 1e-2
_FACTOR = 10.0
# Of an imbalance over the one before: more than grows, and less than is brought down.
_GROWS, _BROUGHT_DOWN = 3.0, 0.3
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
        elif earlier and present > _BROUGHT_DOWN * earlier[-1]:
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
        factors: By which penalties are softened one after the other; by default they begin as soft
            as a slender body.
    """

    def __init__(self, problem: Problem, factors: Sequence[float] = ()) -> None:
        self._problem, self._factors = problem, factors
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
        for factor in self._factors:
            self._soften(factor)
            yield
        if self._factors:
            return
        most = max((_most(contact) for contact in self._contacts), default=1.0)
        while most > 1:
            for contact, factor in zip(self._contacts, self._own, strict=True):
                contact.normal.penalty.soften(factor * max(min(most, _most(contact)), 1.0))
            yield
            most /= _HARDER

    @contextmanager
    def at_softest(self) -> Iterator[None]:
        """Have the first of the given factors inside, then the contacts' own penalties."""
        self._soften(self._factors[0])
        try:
            yield
        finally:
            self.harden()

    def _soften(self, by: float) -> None:
        for contact, factor in zip(self._contacts, self._own, strict=True):
            contact.normal.penalty.soften(factor * by)

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
        self._soften(1.0)


def _most(contact: ContactSurface) -> float:
    """Factor by which a contact's penalty is softened at first; collective."""
    stiffness = _SOFTEST_PENALTY * contact.moduli.combined / contact.trace.extent()
    return 1 / (stiffness * contact.penalty_parameter)
