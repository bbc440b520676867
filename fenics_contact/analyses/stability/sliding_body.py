"""A body about a state in which all its contacts slide: K with the tangents of steady sliding.

Friction there is μ p against the direction of sliding, whatever small displacements come on top:
these change the pressure p, and neither the direction nor the contact area. So the tangent of a
contact is (n + μ d) ⊗ ∂p/∂u, which is not symmetric, and that of what is held across the contact is
that of trial displacements u_n = 0 with test displacements w_n = μ w_t.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import SLIP
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.modes.served import LinearisedBody

# Sizes of the body that have been slid: friction then turns by nothing when points move sideways.
_FAR = 1e9


class SlidingBody(LinearisedBody):
    """Small changes about a state of sliding; collective, as all its methods.

    Args:
        system: In the state as it was solved, with slip in the directions of sliding.
        body: Its body.

    Raises:
        NotConvergedError: A part of the contact sticks; on every rank.
    """

    def __init__(self, system: CondensedSystem, body: CondensedBody) -> None:
        require_sliding(system.problem)
        far = _FAR * system.problem.spaces.size
        for contact in system.problem.frictional:
            _slide(contact, far)
        super().__init__(system, body)


def require_sliding(problem: Problem) -> None:
    """See that all rough contacts slide wherever they carry pressure; collective.

    Args:
        problem: In the state as it was solved.

    Raises:
        NotConvergedError: One does not, in words with its share; on every rank.
    """
    for contact in problem.frictional:
        owned, weights = contact.trace.owned, contact.trace.weights
        state = contact.state()
        presses = owned & (state.contact_pressure > 0)
        sticks = presses & (state.status != SLIP)
        area, stuck = total(problem.comm, np.array([weights[presses].sum(), weights[sticks].sum()]))
        if stuck > 0:
            raise NotConvergedError(
                f"stability: {stuck / area:.2g} of what carries pressure at '{contact.label}' "
                "sticks, but steady sliding is asked about; let the obstacle or the other body be "
                "moved farther along"
            )


def _slide(contact: ContactSurface, far: float) -> None:
    """Set friction to that of points that have slid far in the direction in which they slip."""
    friction, kinematics = contact.friction, contact.kinematics
    slip: Array = kinematics.tangential(kinematics.jump_at_points())
    counted = friction.effective_slip(slip)
    sizes = np.linalg.norm(counted, axis=1)[:, None]
    direction = np.divide(counted, sizes, out=np.zeros_like(counted), where=sizes > 0)
    friction.accept(slip - far * direction)
    contact.friction_term.follow_pressure()
    contact.follow_pressure()
    contact.friction_term.tangent_state.take_true(slip)
