"""Results at the contact points: plain data, global, the same on any number of ranks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers, Words


@dataclass(frozen=True, eq=False)
class ContactPoints:
    """All contact points, sorted by contact and coordinates; arrays of one row a point.

    Attributes:
        contact: Number of the contact, in scene order.
        coordinates: Undeformed, shape (points, 3) (length).
        normals: Outward unit normals of the body, (points, 3).
        gap: Normal distance to the obstacle, > 0 open (length).
        contact_pressure: Of the law at the point, ≥ 0; on quadratic triangles single ones may be
            larger than what the facets carry, which ``max_contact_pressure`` is of (stress).
        friction_traction: Tangential traction on the body, (points, 3) (stress).
        slip: Tangential displacement relative to the obstacle, (points, 3) (length).
        status: OPEN, STICK or SLIP.
        weights: Area that each point stands for.
        own: What the laws of contacts keep of their own, by name, (points,) or (points, 3); not a
            number at the points of contacts whose laws do not.
    """

    contact: Integers
    coordinates: Array
    normals: Array
    gap: Array
    contact_pressure: Array
    friction_traction: Array
    slip: Array
    status: Words
    weights: Array
    own: Mapping[str, Array] = field(default_factory=dict)

    def of(self, contact: int) -> Flags:
        """Return for each row whether it belongs to a contact.

        Args:
            contact: Its number, in scene order.

        Returns:
            A mask, (points,).
        """
        return np.asarray(self.contact == contact)
