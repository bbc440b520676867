"""Contact without friction: the start of every way to Coulomb friction (paper, Step 1).

It tells the pressures, and by them the ε of a contact whose ε is found, which follows in each load
step from its own pressures. Slip counts from the last accepted step, or from the start: in neither
case does a traction remember the ε of the steps before, so that each may have its own.

What friction alone holds would drift off without it. There contacts are glued along the surface,
and friction begins from what is glued. Glue holds all motions, so that a few Newton steps under
softer penalties tell which points touch: under its own, stiff penalty each step closes points that
the next one opens.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import TELLING, carries_more_than, is_open_or_carries
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.globalisation import PenaltyPath
from fenics_contact.solve.newton import Newton

logger = logging.getLogger(__name__)


def follow_pressure(contact: ContactSurface, imbalance: float, accuracy: float = TELLING) -> None:
    """Set ε to what the present pressure needs, if that is more than round-off; collective.

    Args:
        contact: Any; one whose ε is given keeps it.
        imbalance: That was accepted (force).
        accuracy: To which the pressures are to be known.
    """
    pressure = telling_pressure(contact, imbalance, accuracy)
    if contact.friction.regularisation.follows_pressure and pressure is not None:
        set_needed(contact, pressure)


def telling_pressure(
    contact: ContactSurface, imbalance: float, accuracy: float = TELLING
) -> Array | None:
    """The present pressure at the points, None where it is round-off (stress); collective.

    Args:
        contact: Any.
        imbalance: As of ``follow_pressure``.
        accuracy: Likewise.
    """
    tells = carries_more_than(contact, imbalance, accuracy)
    return contact.pressure() if tells else None


def set_needed(contact: ContactSurface, pressure: Array) -> None:
    """Set ε to what a pressure needs; collective.

    Args:
        contact: One whose ε is found.
        pressure: At its points (stress).
    """
    contact.friction.regularisation.set(_needed(contact, pressure))


def fits(contact: ContactSurface, too_large: float, too_small: float) -> bool:
    """Whether ε is that needed at the present pressure, but for factors; collective.

    Args:
        contact: Any; an ε that is given fits.
        too_large: Largest of ε over that needed.
        too_small: Largest of that needed over ε.
    """
    regularisation = contact.friction.regularisation
    if not regularisation.follows_pressure:
        return True
    needed, chosen = _needed(contact, contact.pressure()), regularisation.chosen
    fitting = needed <= too_small * chosen and chosen <= too_large * needed
    return regularisation.is_known and fitting


def _needed(contact: ContactSurface, pressure: Array) -> float:
    """The ε whose bias is below .1 % at a pressure, 0 without one; collective."""
    return contact.friction.regularisation.needed(contact.friction_term.bound_of(pressure))


# Stiffness of glue along the surface, over E/h: nothing is to have slipped yet. Along a curved
# surface, as of a pin in a hole, glue may carry what is to be pressure, so that nothing presses.
# Where points close by turns it is so soft there that it only holds what nothing else does.
_GLUE, _SOFT_GLUE = 1e4, 1e-2
# Length of the mean of unit normals from which a surface is flat.
_FLAT = 0.99
# Where glue holds what friction has to hold: factors by which penalties are softened on the way,
# Newton steps under each, the imbalance over the forces that is left under the softest, and share
# of a contact's force to which its pressures are to be known for ε.
_SOFTER, _STEPS = (30.0, 5.0), 3
_ROUGH, _ROUGHLY = 1e-3, 0.1
# Newton steps under glue up to which hardly a point opens or closes on the way.
_EASY = 3


def contact_without_friction(
    newton: Newton,
    tolerance: float | None = None,
    accuracy: float = TELLING,
    holds_what_slides: bool = False,
    is_held: bool = False,
) -> bool:
    """Solve without friction, with glue along contacts where friction has to hold; collective.

    Sets ε to what the pressures found need, and all points to stick.

    Args:
        newton: Goes on from its present state.
        tolerance: Of the solve, by default the scene's.
        accuracy: To which a contact's pressures are to be known if its ε is to follow from them.
        holds_what_slides: Glue also where an obstacle would stop a motion, but only after a way:
            what lies there tells nothing of the pressures under friction.
        is_held: As of ``Newton.run``.

    Returns:
        Whether glue was used.
    """
    problem = newton.problem
    rigid = RigidMotions(problem)
    is_glued = rigid.slides_on_coulomb or (holds_what_slides and rigid.slides_where_it_touches)
    before = newton.save()
    try:
        _solve(newton, tolerance, is_glued, is_held)
    except NotConvergedError as error:
        if is_glued or rigid.count == 0:
            raise
        logger.info("%s; next: with glue, as friction may hold what contact does not", error)
        newton.restore(before)
        is_glued = True
        _solve(newton, tolerance, is_glued)
    for contact in problem.coulomb:
        follow_pressure(contact, newton.limit, accuracy)
        contact.friction_term.tangent_state.stick_all()
    return is_glued


def _solve(newton: Newton, tolerance: float | None, is_glued: bool, is_held: bool = False) -> None:
    if is_glued:
        _glue(newton.problem, newton.closes_by_turns)
    else:
        for contact in newton.problem.coulomb:
            contact.friction_term.exert_nothing()
    newton.run(tolerance=tolerance, is_held=is_held)


def _glue(problem: Problem, is_soft: bool = False) -> None:
    """Glue Coulomb contacts along the surface where they press, or touch; collective.

    Args:
        problem: The problem.
        is_soft: Whether glue is soft along curved contacts.
    """
    touch = [_touches(contact) for contact in problem.coulomb]
    for contact, touches in zip(problem.coulomb, touch, strict=True):
        contact.friction_term.exert_nothing()
        glue = _SOFT_GLUE if is_soft and not _is_flat(contact) else _GLUE
        stiffness = glue * contact.moduli.combined / contact.facet_size
        contact.friction_term.glue(stiffness, _to_glue(contact, touches or not any(touch)))


@contextmanager
def glued_where_it_slides(problem: Problem) -> Iterator[bool]:
    """Glue inside, under softer penalties, where only friction holds something; collective.

    Friction of a bound that is not found yet would let it drift off.

    Yields:
        Whether there is glue.
    """
    if not RigidMotions(problem).slides_on_coulomb:
        yield False
        return
    bounds = [contact.friction.bound.copy() for contact in problem.coulomb]
    _glue(problem)
    try:
        with PenaltyPath(problem, _SOFTER).at_softest():
            yield True
    finally:
        for contact, bound in zip(problem.coulomb, bounds, strict=True):
            contact.friction_term.follow_law()
            contact.friction.set_bound(bound)


def near_friction(newton: Newton) -> None:
    """Go to near contact with friction, where friction alone holds bodies; collective.

    Glue tells the pressures, and by them ε; friction then begins where the step does, so that
    nothing drifts. Where points close by turns, it begins from those that touch under glue.

    Args:
        newton: Goes on from its present state.
    """
    contacts, start, before = newton.problem.coulomb, newton.save(), newton.steps
    path = PenaltyPath(newton.problem, _SOFTER)
    with path.at_softest():
        contact_without_friction(newton, _ROUGH, _ROUGHLY, is_held=True)
        limit = newton.limit
        if not all([is_open_or_carries(contact, limit, _ROUGHLY) for contact in contacts]):
            contact_without_friction(newton, is_held=True)
    is_easy = newton.steps - before <= _EASY
    if newton.closes_by_turns and not is_easy:
        newton.system.take(newton.system.state)  # under the contacts' own penalties
        return
    newton.restore(start)
    if is_easy:
        return
    for contact in contacts:
        contact.friction_term.follow_pressure()
    path.follow(partial(newton.take_steps, _STEPS))
    newton.system.take(newton.system.state)


def _is_flat(contact: ContactSurface) -> bool:
    """Whether normals are about the same everywhere; collective."""
    trace = contact.trace
    mean = total(contact.spaces.comm, trace.normals[trace.owned].sum(axis=0))
    count = total(contact.spaces.comm, float(trace.owned.sum()))
    return float(np.linalg.norm(mean)) > _FLAT * float(count)


def _touches(contact: ContactSurface) -> bool:
    """Whether points press now, or are closed before any motion; collective."""
    closed = RigidMotions.gap(contact) <= 0
    return largest(contact.spaces.comm, np.where(closed, 1.0, contact.pressure())) > 0


def _to_glue(contact: ContactSurface, all_else: bool) -> Flags:
    """Points that press as a solve begins; where none does, all or none; collective."""
    pressure = contact.pressure()
    if largest(contact.spaces.comm, pressure) > 0:
        return np.asarray(pressure > 0)
    return np.full(len(pressure), all_else)
