"""Check of two bodies that touch: what one gets, the other gives, at the same place."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.results.result import Check
from fenics_contact.trust.checks.comparison import nearer_to_failing

_ROUND_OFF = 1e-6
# Of what the surfaces are apart, and their facets from smooth ones, over the contact's extent.
_SAFETY = 4.0


def action_and_reaction(forces: BulkForces) -> Check | None:
    """Forces of a contact on both bodies, and their moments, add up to zero.

    Relative to the forces on the slave, moments over the extent of its surface. Forces are handed
    over between points that face each other, so they may be off by the distance of these. Across
    planes of symmetry forces need not balance.
    """
    worst: Check | None = None
    for contact, given in zip(forces.problem.contacts, forces.solution.contact_force, strict=True):
        if contact.kinematics.faces_body:
            nodal = contact.kinematics.on_body(contact.trace.at_all_nodes(given))
            worst = nearer_to_failing(worst, _balance(forces, contact, nodal))
    return worst


def _balance(forces: BulkForces, contact: ContactSurface, nodal: Array) -> Check:
    spaces, extent = contact.spaces, contact.trace.extent()
    owned, size = slice(0, spaces.owned_nodes), spaces.components
    vectors, places = np.zeros((2, spaces.owned_nodes, 3))
    vectors[:, :size] = nodal[owned]
    places[:, :size] = spaces.coordinates[owned, :size] + forces.solution.displacement[owned]
    carried = total(spaces.comm, np.linalg.norm(vectors, axis=1).sum()) / 2 or 1.0
    weights = np.linalg.norm(vectors, axis=1)
    centre = total(spaces.comm, weights @ places) / (2 * carried)
    moments = np.cross(places - centre, vectors) / extent
    mirrored = contact.trace.mirrored_axes
    counted = [k for k in range(3) if k not in mirrored]
    turned = [k for k in range(3) if not {0, 1, 2} - {k} & set(mirrored)]
    if spaces.kinematics == "axisymmetric":
        turned = []
    left = total(spaces.comm, np.concatenate([vectors.sum(axis=0), moments.sum(axis=0)]))
    off = np.linalg.norm([*left[counted], *(left[3 + k] for k in turned)])
    closed = contact.kinematics.reached & (contact.pressure() != 0)
    apart = largest(spaces.comm, np.abs(contact.kinematics.gap[closed]))
    limit = _SAFETY * (apart + contact.kinematics.sagitta) / extent + 2 * contact.slid_share()
    return Check(float(off) / carried, min(_ROUND_OFF + limit, 0.5), contact.label)
