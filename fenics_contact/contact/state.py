"""State of the points of a contact; ``results.contact_points`` lists its arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fenics_contact.common.arrays import Array, Words

OPEN, STICK, SLIP = "OPEN", "STICK", "SLIP"


@dataclass(frozen=True, eq=False)
class ContactState:
    """State of the contact points of this rank, one row a point.

    Attributes:
        gap: Along the normal, > 0 open, infinite where no obstacle stands (length).
        contact_pressure: On the body, ≥ 0; < 0 in tension where bonded (stress).
        friction_traction: Tangential traction on the body, (points, components) (stress).
        slip: Tangential displacement relative to the obstacle, (points, components) (length).
        status: OPEN, STICK or SLIP.
        penalty_energy: Of penalty or foundation (energy/area).
        own: What the laws of the contact keep of their own and results have, by name.
    """

    gap: Array
    contact_pressure: Array
    friction_traction: Array
    slip: Array
    status: Words
    penalty_energy: Array
    own: Mapping[str, Array] = field(default_factory=dict)
