"""Moments of a contact's pressure and friction on the body of its surface ``on``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.problem.loads.affine import rotations
from fenics_contact.quantities.names import CONTACT_MOMENT, TORQUE


def centre_of_moments(contact: ContactSurface) -> Array:
    """Point that moments are about: the scene's, else the centroid of ``on``; collective (length).

    Args:
        contact: The contact, of a model in the plane or in space.
    """
    given, size = contact.contact.moment_about, contact.spaces.components
    if given is not None:
        return np.array(given, dtype=np.float64)
    sides = contact.sides
    trace = sides.opposite if sides.opposite is not None and sides.on_sign < 0 else sides.trace
    return np.asarray(trace.integral(trace.coordinates[:, :size]) / trace.area)


def turned(contact: ContactSurface, places: Array) -> Array:
    """Displacements of places by small unit rotations about the centre of moments; collective.

    Args:
        contact: The contact.
        places: (places, 3) (length).

    Returns:
        (rotations, places, components), of the three axes in space, of one in the plane (length).
    """
    size = contact.spaces.components
    arms = places[:, :size] - centre_of_moments(contact)
    return np.asarray(np.einsum("kij,nj->kni", rotations(size), arms))


def axis_of_torque(contact: ContactSurface) -> Array | None:
    """Weights of the moments about all axes in the torque, (rotations,); None without one."""
    scene = contact.contact
    if contact.spaces.components == 2:
        return None if scene.moment_about is None else np.ones(1)
    return None if scene.axis is None else np.array(scene.axis) / np.linalg.norm(scene.axis)


def contact_moments(
    contact: ContactSurface, state: ContactState, friction_force: Array
) -> Mapping[str, Any]:
    """Moment vector in space, and the torque where the scene has its axis; collective.

    Args:
        contact: The contact.
        state: What happens at its points.
        friction_force: Of the friction law on the slave, at the nodes (force).
    """
    spaces, trace = contact.spaces, contact.trace
    if spaces.kinematics == "axisymmetric":
        return {}
    traction = -state.contact_pressure[:, None] * trace.normals
    if contact.normal.exerts_shear:
        has_friction = contact.friction.has_friction
        traction = traction + (
            contact.normal.traction(contact.kinematics.jump_at_points())
            if has_friction
            else state.friction_traction
        )
    ways = turned(contact, trace.coordinates)
    found = trace.integral(np.einsum("kni,ni->nk", ways, traction))
    if contact.friction.has_friction:
        own = np.flatnonzero(contact.owned_nodes)
        ways = turned(contact, trace.coordinates[own])  # the first points are the nodes
        found = found + total(spaces.comm, np.einsum("kni,ni->k", ways, friction_force[own]))
    moment = contact.sides.on_sign * np.asarray(found) + 0.0  # no −0
    axis = axis_of_torque(contact)
    vector = {CONTACT_MOMENT: moment.tolist()} if spaces.components == 3 else {}
    return vector if axis is None else {**vector, TORQUE: float(axis @ moment)}
