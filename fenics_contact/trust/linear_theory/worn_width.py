"""How deep wear is over how wide: the gap is one along the normals of the surface as it was."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.parallel import largest, smallest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState

# Share of the deepest wear from which a point counts as worn: width has no meaning at less.
_WORN = 0.01


def worn_share(contact: ContactSurface, state: ContactState) -> float:
    """Deepest wear over half the width that is worn, about the slope of what is left; collective.

    Args:
        contact: Any.
        state: At the end of a load step.
    """
    if not contact.wear.wears:
        return 0.0
    comm, depth = contact.spaces.comm, state.own["worn_depth"]
    deepest = largest(comm, depth)
    if deepest == 0:
        return 0.0
    worn = contact.trace.coordinates[depth >= _WORN * deepest].T
    width = np.linalg.norm([largest(comm, x) - smallest(comm, x) for x in worn])
    return deepest / (0.5 * max(float(width), contact.facet_size))
