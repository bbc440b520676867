"""Resultants of a contact's pressure and friction on the body of its surface `on`.

Of two bodies they are found on the slave. What acts there, and its opposite on the master, balance,
so that the choice of slave changes nothing.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.quantities.names import (
    CONTACT_FORCE,
    FRICTION_FORCE,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
)


def resultants(
    contact: ContactSurface, state: ContactState, friction_force: Array
) -> dict[str, float | list[float] | None]:
    """Forces of a contact; collective.

    Args:
        contact: The contact.
        state: What happens at its points.
        friction_force: Of the friction law on the slave, at the nodes (force).

    Returns:
        By the interface's names; the normal force is None where the contact has no axis.
    """
    trace, sign = contact.trace, contact.sides.on_sign
    of_pressure = -sign * trace.integral(state.contact_pressure[:, None] * trace.normals)
    of_friction = sign * _friction(contact, state, friction_force)
    if contact.spaces.kinematics == "axisymmetric":
        of_pressure[0] = 0.0
    axis = contact.axis
    return {
        NORMAL_FORCE: None if axis is None else float(of_pressure @ axis),
        PRESSURE_INTEGRAL: float(trace.integral(state.contact_pressure)),
        FRICTION_FORCE: (of_friction + 0.0).tolist(),  # no −0
        CONTACT_FORCE: (of_pressure + of_friction + 0.0).tolist(),
    }


def _friction(contact: ContactSurface, state: ContactState, force: Array) -> Array:
    """Force along the surface on the slave; collective.

    That of a friction law is at the nodes, that of a law across the contact, such as glue, at the
    points.
    """
    rubs, normal = contact.friction.has_friction, contact.normal
    found = np.zeros(contact.spaces.components)
    if rubs:
        found = resultant(contact.spaces, force[contact.owned_nodes])
    if normal.exerts_shear:
        traction = state.friction_traction
        if rubs:
            traction = normal.traction(contact.kinematics.jump_at_points())
        found = found + contact.trace.integral(traction)
    if contact.spaces.kinematics == "axisymmetric":
        found[0] = 0.0
    return found


def resultant(spaces: Spaces, forces: Array) -> Array:
    """Global sum of forces at owned points; over a revolution, radial ones cancel; collective.

    Args:
        spaces: Those of the body.
        forces: At points, (points, components) (force).
    """
    summed: Array = total(spaces.comm, forces.sum(axis=0))
    if spaces.kinematics == "axisymmetric":
        summed[0] = 0.0
    return np.asarray(summed)
