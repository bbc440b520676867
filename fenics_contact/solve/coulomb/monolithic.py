"""Contact and friction at once: Newton's method on the whole, the bound μ p too.

Its tangent is not symmetric, as Coulomb friction has no energy. It starts from the adhesive start,
all points stuck, with full steps; where friction alone holds bodies, from near the answer, and
steps under which the imbalance would grow are cut.
"""

from __future__ import annotations

import logging

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import carries_more_than, is_open_or_carries
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.coulomb.without_friction import (
    contact_without_friction,
    fits,
    follow_pressure,
    near_friction,
)
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.newton_failure import GIVEN_UP, GROWS

logger = logging.getLogger(__name__)

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
        """PETSc's reason to give up where a Newton step would begin; 0 to go on."""
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


# Imbalance over the forces where only the pressures are wanted from which ε follows. Its bias is
# below .1 %, so an error of it in ε counts a thousandth.
_SCALE_TOLERANCE = 1e-6
# To which the pressures are to be known where a system solves less exactly than that.
_SCALE_ACCURACY = 0.1
# Of ε over that which the answer needs, beyond which a step is solved again: its bias stays below
# .1 %, also where steps add up.
_TOO_LARGE = 3.0
_RESCALINGS = 3
# Shares of the coefficient on the way to all of it: from below or, where only friction holds a
# body, from above, as less of it holds nothing.
_RISING = (0.25, 0.5, 0.75, 1.0)
_FALLING = (4.0, 2.0, 1.4, 1.2, 1.1, 1.05, 1.02, 1.01, 1.005, 1.002, 1.001, 1.0)


def solve_coupled(newton: Newton, of_scale: bool = False, of_growth: bool = False) -> None:
    """From the present displacements and ε; collective.

    Args:
        newton: On a problem with Coulomb contacts.
        of_scale: Whether an ε that is much too small ends the solve.
        of_growth: Whether an imbalance far beyond the forces does, as there are other ways.

    Raises:
        NotConvergedError: As ``Newton.run``; a ``giving_up.GrowsError`` where the imbalance grew
            far beyond the forces.
    """
    watch = Watch(newton, of_scale, of_growth)
    is_held = is_held_by_friction(newton.problem)
    for contact in newton.problem.coulomb:
        contact.friction_term.tangent_state.stick_all()
        contact.friction_term.follow_pressure()
    try:
        newton.run(search_energy=False, hopeless=watch, is_held=is_held)
    except NotConvergedError as error:
        raise (GrowsError(*error.args) if watch.grows else error) from None


def monolithic(newton: Newton, start: Array, of_growth: bool = False) -> None:
    """Find ε, from the step before or from contact without friction, and solve; collective.

    Args:
        newton: On a problem with Coulomb contacts.
        start: The state to start from, as ``Newton.save`` gave it.
        of_growth: As of ``solve_coupled``.
    """
    contacts = newton.problem.coulomb
    pressing = [_presses(contact) for contact in contacts]  # others get theirs once they touch
    known = [
        one.friction.regularisation.is_known or not p
        for one, p in zip(contacts, pressing, strict=True)
    ]
    if all(known) and any(contact.friction.regularisation.is_known for contact in contacts):
        try:
            solve_coupled(newton, of_scale=True, of_growth=of_growth)
            return
        except GrowsError:
            raise
        except NotConvergedError as error:
            if not is_out_of_scale(newton):
                raise
            logger.info("%s; next: with the regularisation that this step needs", error)
            newton.restore(start)
    if is_held_by_friction(newton.problem):
        try:
            near_friction(newton)
            solve_coupled(newton, of_growth=of_growth)
            return
        except NotConvergedError as error:
            logger.info("%s; next: from where the step began", error)
            newton.restore(start)
    _find_scale(newton)
    if not newton.softened:
        newton.restore(start)
    solve_coupled(newton, of_growth=of_growth)


def is_held_by_friction(problem: Problem) -> bool:
    """Whether friction of other bodies alone holds one, which is at rest; collective."""
    is_candidate = problem.between_bodies and not problem.inertia.moves
    return is_candidate and RigidMotions(problem).slides_on_coulomb


def _presses(contact: ContactSurface) -> bool:
    """Whether it does now, at any point; collective."""
    return largest(contact.spaces.comm, contact.pressure()) > 0


def _find_scale(newton: Newton) -> None:
    """Set ε from contact without friction, solved as exactly as that needs; collective."""
    rough = newton.system.scale_tolerance
    if rough is not None:
        contact_without_friction(newton, rough, _SCALE_ACCURACY, holds_what_slides=True)
        contacts = newton.problem.coulomb
        limit = newton.limit
        if all([is_open_or_carries(contact, limit, _SCALE_ACCURACY) for contact in contacts]):
            return
    contact_without_friction(newton, _SCALE_TOLERANCE, holds_what_slides=True)


def continuation(newton: Newton, start: Array) -> None:
    """Solve monolithically with the coefficient brought up or down in steps; collective."""
    shares = _FALLING if RigidMotions(newton.problem).slides_on_coulomb else _RISING
    for share in shares:
        for contact in newton.problem.coulomb:
            contact.friction_term.use_share(share)
        if share == shares[0]:
            monolithic(newton, start)
        else:
            newton.run(search_energy=False)


def fit_scale(newton: Newton) -> None:
    """Set ε of contacts for which it is too large, and solve with it; collective.

    They carry much less than in the last step, or only came to touch on the way.
    """
    for _ in range(_RESCALINGS):
        limit = newton.limit
        late = [
            contact
            for contact in newton.problem.coulomb
            if not fits(contact, _TOO_LARGE, np.inf) and carries_more_than(contact, limit)
        ]
        if not late:
            return
        for contact in late:
            follow_pressure(contact, limit)
        if RigidMotions(newton.problem).slides_on_coulomb:
            _solve_afresh(newton)
        else:
            solve_coupled(newton)


def _solve_afresh(newton: Newton) -> None:
    """Solve with a smaller ε where friction alone holds bodies; collective.

    Nothing but friction takes the creep back, by one ε a step of Newton's method, so that it is
    quicker from contact without friction. Where that is too far away, from the present answer.
    """
    contacts, start = newton.problem.coulomb, newton.save()
    scales = [contact.friction.regularisation.chosen for contact in contacts]
    try:
        _find_scale(newton)
        solve_coupled(newton)
        return
    except NotConvergedError as error:
        logger.info("%s; next: from the answer with the larger regularisation", error)
    newton.restore(start)
    for contact, scale in zip(contacts, scales, strict=True):
        contact.friction.regularisation.recall(scale, contact.friction.regularisation.is_known)
    solve_coupled(newton)
