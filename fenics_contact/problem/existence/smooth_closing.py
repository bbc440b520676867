"""Normal jumps of rigid motions along curved surfaces, without what facets make of them."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.existence.rigid_slip import allowance, motions_along

# Of the slip of a motion: what is less across a surface is round-off.
_FLAT = 1e-12
# Of the jumps of all motions: what is round-off once that is taken off.
_ROUND_OFF = 1e-9


def smooth_closing(contact: ContactSurface, closing: Array, jumps: Array, acts: Flags) -> Array:
    """Normal jumps without those that facets make of motions along a curved surface; collective.

    A shaft turns in a hub of facets as in a round one: its facets do not hold it.

    Args:
        contact: The contact.
        closing: Normal jumps, (points, motions).
        jumps: Of the motions, (points, components, motions).
        acts: Which points count.
    """
    comm, weights = contact.spaces.comm, contact.trace.weights[acts]
    every = np.einsum("q,qci,qcj->ij", weights, jumps[acts], jumps[acts])
    normal = np.einsum("q,qi,qj->ij", weights, closing[acts], closing[acts])
    every, across = total(comm, np.stack([every, normal]))
    allowed = allowance(contact.kinematics.facet_turn) ** 2 * (every - across)
    along, shares = motions_along(across, allowed)
    left = largest(comm, np.abs(closing[acts] @ along).ravel())
    size = largest(comm, np.abs(jumps[acts] @ along).ravel())
    if left <= _FLAT * size:  # of flat surfaces there is nothing but round-off to take off
        return closing
    smooth = closing - (closing @ along) @ shares
    small = _ROUND_OFF * largest(comm, np.abs(jumps[acts]).ravel())
    # A motion is taken off as a whole: of single numbers, sums would no longer vanish.
    sizes = [largest(comm, np.abs(column)) for column in smooth[acts].T]
    smooth[:, np.array(sizes) <= small] = 0.0
    return smooth
