"""Whether enough points lie across what touches to tell how large it is, and how pressed.

About three are needed in the narrow direction: then one of them has points that touch all around
it. Where the edge of contact lies inside the surface, and no such point is near, the pressure that
comes out is that of the mesh. A contact up to all borders of its surface has no such edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState

# Share of the normal force that too few points may carry.
_LARGEST_SHARE = 0.1
# What cells become there, over what they are: of one point across three.
_FINER = 0.3


@dataclass(frozen=True, eq=False)
class ThinContact:
    """Where fewer than three points lie across what touches.

    Attributes:
        place: Where most of its force acts, (3,) (length).
        finer: Rows of x, y, z and the size that cells there are to have, of this rank (length).
    """

    place: Array
    finer: Array


def thin_contact(contact: ContactSurface, state: ContactState) -> ThinContact | None:
    """Return how thin a contact is; None where its points tell what touches; collective.

    Args:
        contact: The contact.
        state: What happens at its points.
    """
    if not contact.is_one_sided:
        return None
    trace, pieces = contact.trace, contact.trace.pieces
    nodes = slice(0, len(contact.nodes))
    closed = state.status[nodes] != OPEN
    thin = closed & ~_near_surrounded(contact, closed)
    forces = (trace.weights * state.contact_pressure)[nodes] * contact.owned_nodes
    in_thin, whole = total(trace.spaces.comm, np.array([forces[thin].sum(), forces.sum()]))
    if whole <= 0 or in_thin <= _LARGEST_SHARE * whole:
        return None
    rows = np.column_stack([forces, trace.coordinates[nodes]])[thin & contact.owned_nodes]
    rows = gather_rows(trace.spaces.comm, rows[np.lexsort(rows.T[::-1])[-1:]])
    place = rows[np.lexsort(rows.T[::-1])[-1], 1:]
    dimension = trace.spaces.components
    sides = (pieces.areas * (1 if dimension == 2 else 2)) ** (1 / (dimension - 1))
    rows = np.column_stack([pieces.corners.mean(axis=1), _FINER * sides * trace.spaces.degree])
    return ThinContact(place, rows[thin[pieces.points].any(axis=1)])


def _near_surrounded(contact: ContactSurface, closed: Flags) -> Flags:
    """Return for each nodal point whether it, or a neighbour, touches all around."""
    trace, pieces = contact.trace, contact.trace.pieces
    surface = trace.surface

    def beside(pieces_found: Flags) -> Flags:
        """Nodes of some pieces, on whatever rank these are."""
        found = np.zeros((len(surface.coordinates), 1))
        found[pieces.nodes[pieces_found].ravel()] = 1.0
        return np.asarray(surface.summed(found)[trace.numbers, 0] > 0)

    touches = closed[pieces.points] if len(closed) else np.zeros(pieces.points.shape, dtype=bool)
    surrounded = closed & ~beside(~touches.all(axis=1))
    inner = surrounded[pieces.points] if len(closed) else touches
    return np.asarray(surrounded | beside(inner.any(axis=1)))


def words_on(contacts: Sequence[ContactSurface], states: Sequence[ContactState]) -> str:
    """A clause on contacts with too few points across what touches, or nothing; collective.

    Args:
        contacts: In scene order.
        states: Of each.
    """
    found = []
    for contact, state in zip(contacts, states, strict=True):
        thin = thin_contact(contact, state)
        if thin is not None:
            place = ", ".join(f"{x + 0.0:.4g}" for x in thin.place[: contact.spaces.components])
            found.append(f"'{contact.label}' near ({place})")
    if not found:
        return ""
    of, verb = ("the contacts", "are") if len(found) > 1 else ("the contact", "is")
    return (
        f"{of} at {' and '.join(found)} {verb} not resolved: fewer than three points lie across "
        "what touches, and its pressure is that of the mesh; make cells smaller there, or ask for "
        "an accuracy."
    )
