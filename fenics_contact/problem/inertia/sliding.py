"""How far and how fast the points of a contact slide in a step of motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface

# Of the largest bound of friction, by which two are the same.
_SAME = 1e-9


def along_contact(contact: ContactSurface, vectors: Array, opposite: Array) -> Array:
    """Vectors at the nodes relative to the body opposite, along a contact; collective.

    Args:
        contact: The contact.
        vectors: Displacements or velocities, (nodes, components).
        opposite: Those of an obstacle, (components,).
    """
    kinematics = contact.kinematics
    jump = contact.trace.at_points(kinematics.relative(vectors) - opposite)
    return np.asarray(kinematics.tangential(jump))


def _sizes(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _counted(contact: ContactSurface) -> Array:
    """The slip that friction counts at present, (points, components) (length)."""
    kinematics = contact.kinematics
    return contact.friction.effective_slip(kinematics.tangential(kinematics.jump_at_points()))


def elastic_slip(contact: ContactSurface) -> Array:
    """The part of the slip that friction counts at present that goes back, at most ε (length)."""
    return _goes_back(contact, _counted(contact))


def _goes_back(contact: ContactSurface, counted: Array) -> Array:
    if not contact.friction.has_friction:
        return np.zeros_like(counted)
    sizes = _sizes(counted)
    most = np.where(contact.friction_bound > 0, contact.regularisation_parameter, 0.0)
    share = np.divide(np.minimum(sizes, most), sizes, out=np.zeros_like(sizes), where=sizes > 0)
    return np.asarray(counted * share[:, None])


def end_speeds(contacts: Sequence[ContactSurface], size: float) -> tuple[Array, ...]:
    """Speeds at the end of a step, (points,) each; 0 where friction does not follow them.

    Slip that friction counts is ½ Δt v₁ and what goes back, the rest is what slides.

    Args:
        contacts: As the step leaves them.
        size: Its length (time).
    """
    return tuple(2 / size * _sizes(_slides(contact)) for contact in contacts)


def _slides(contact: ContactSurface) -> Array:
    if not contact.friction.follows_speed:
        return np.zeros((len(contact.trace.normals), 1))
    counted = _counted(contact)
    return np.asarray(counted - _goes_back(contact, counted))


def follow(contacts: Sequence[ContactSurface], speeds: Sequence[Array]) -> bool:
    """Let friction go by other speeds; collective.

    Args:
        contacts: With what presses on them at present.
        speeds: As of ``end_speeds``.

    Returns:
        Whether a bound has changed by it.
    """
    changed = False
    for contact, speed in zip(contacts, speeds, strict=True):
        if contact.friction.follows_speed:
            comm, pressure = contact.spaces.comm, contact.pressure()
            before = contact.friction.bound_of(pressure)
            contact.follow_speed(speed)
            off = largest(comm, np.abs(contact.friction.bound_of(pressure) - before))
            changed |= off > _SAME * largest(comm, before)
    return changed
