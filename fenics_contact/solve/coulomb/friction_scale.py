"""The ε of a contact whose pressure is found: each load step's follows from its own pressures.

Slip counts from the last accepted step, or from the start: in neither case does a traction remember
the ε of the steps before, so that each may have its own.
"""

from __future__ import annotations

from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import TELLING, carries_more_than


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
