"""Pressures of a contact that are of no account: what the solver accepts, what round-off makes.

A body that has been unloaded to nothing keeps some, each as luck will have it; so have bodies that
came together exactly so far as to touch.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface

# Share of its force to which a contact's pressures are to be known: one that carries less than a
# hundred times the accepted imbalance may be off by more.
TELLING = 0.01
# Of the forces that would strain a body by its motion: forces of less strain nothing.
_STRAINLESS = 1e-6
# 1-norm of the forces at the nodes of a contact, friction included, over ∫ p: at the most about.
_OF_COMPONENTS = 4.0


def carries_more_than(contact: ContactSurface, imbalance: float, accuracy: float = TELLING) -> bool:
    """Whether its pressure is more than what solver and round-off leave; collective.

    Args:
        contact: Any.
        imbalance: That was accepted (force).
        accuracy: To which the pressures are to be known.
    """
    carried = float(contact.trace.integral(np.abs(contact.pressure())))
    return carried > max(imbalance / accuracy, round_off(contact))


def is_open_or_carries(contact: ContactSurface, imbalance: float, accuracy: float) -> bool:
    """Whether nothing presses, or more than what solver and round-off leave; collective.

    Args:
        contact: Any.
        imbalance: That was accepted (force).
        accuracy: To which the pressures are to be known.
    """
    is_open = largest(contact.spaces.comm, contact.pressure()) <= 0
    return is_open or carries_more_than(contact, imbalance, accuracy)


def round_off(contact: ContactSurface) -> float:
    """20 × machine epsilon × ∫ k (|w| + |m|), of what is pressed: round-off (force); collective.

    Of the jump w and of the obstacle's motion m that is taken off in it, which the body's
    displacement and its forces know nothing of.
    """
    jump = contact.kinematics.jump_at_points()
    lengths = np.linalg.norm(jump, axis=1)
    lengths += np.linalg.norm(contact.kinematics.motion_at_points, axis=1)
    pressed = np.where(
        contact.pressure() > 0, contact.normal.stiffness(contact.normal.depth(jump)), 0.0
    )
    return 20 * float(np.finfo(float).eps) * float(contact.trace.integral(pressed * lengths))


def all_round_off(contacts: Sequence[ContactSurface], forces: float) -> bool:
    """Whether contacts touch by round-off alone and nothing else acts on a body moved; collective.

    Args:
        contacts: All of a problem; others than one-sided ones are no excuse for a force.
        forces: 1-norm of all forces on the bodies (force).
    """
    pushing = [contact for contact in contacts if contact.is_one_sided]
    left = sum([min(round_off(contact), _strainless(contact)) for contact in pushing])
    return forces <= _OF_COMPONENTS * left


def _strainless(contact: ContactSurface) -> float:
    """Much less than what it would take to press its jump into the bodies (force); collective."""
    lengths = np.linalg.norm(contact.kinematics.jump_at_points(), axis=1)
    stiffness = contact.moduli.combined / contact.trace.extent()
    return _STRAINLESS * stiffness * float(contact.trace.integral(lengths))
