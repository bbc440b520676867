"""Contact without friction, from which all ways to Coulomb friction start (paper, Step 1)."""

from __future__ import annotations

import logging

import numpy as np

from fenics_contact.common.arrays import Flags
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import TELLING
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.coulomb.friction_scale import follow_pressure
from fenics_contact.solve.newton.newton import Newton

logger = logging.getLogger(__name__)

# Stiffness of glue along the surface, over E/h: nothing is to have slipped yet.
_GLUE = 1e4


def contact_without_friction(
    newton: Newton, tolerance: float | None = None, accuracy: float = TELLING
) -> bool:
    """Solve without friction, with glue along contacts where friction has to hold; collective.

    Sets ε to what the pressures found need, and all points to stick.

    Args:
        newton: Goes on from its present state.
        tolerance: Of the solve, by default the scene's.
        accuracy: To which a contact's pressures are to be known if its ε is to follow from them.

    Returns:
        Whether glue was used.
    """
    problem = newton.problem
    rigid = RigidMotions(problem)
    is_glued = rigid.slides_on_coulomb
    before = newton.save()
    try:
        _solve(newton, tolerance, is_glued)
    except NotConvergedError as error:
        if is_glued or rigid.count == 0:
            raise
        logger.info("%s; next: with glue, as friction may hold what contact does not", error)
        newton.restore(before)
        is_glued = True
        _solve(newton, tolerance, is_glued)
    for contact in problem.coulomb:
        follow_pressure(contact, newton.limit, accuracy)
        contact.friction.stick_all()
    return is_glued


def _solve(newton: Newton, tolerance: float | None, is_glued: bool) -> None:
    for contact in newton.problem.coulomb:
        contact.friction.mode = "off"
        if is_glued:
            stiffness = _GLUE * contact.moduli.combined / contact.facet_size
            contact.friction.glue(stiffness, _to_glue(contact))
    newton.run(tolerance=tolerance)


def _to_glue(contact: ContactSurface) -> Flags:
    """Points that touch as a solve begins; all, where a support is yet to press any on."""
    pressure = contact.pressure()
    return np.asarray((pressure > 0) | (largest(contact.spaces.comm, pressure) <= 0))
