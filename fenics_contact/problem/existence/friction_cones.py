"""What contacts can exert on rigid motions: cones of Coulomb's friction, discs of a known bound."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import gather_rows
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions


@dataclass(frozen=True)
class ContactCones:
    """Jumps of rigid motions where contacts may act, of all ranks.

    Attributes:
        closing: Across the surface at one-sided contacts, > 0 closing, (points, motions).
        coefficients: Friction coefficient there, (points,).
        slips: Along the surface there, (points, components, motions).
        bounds: Friction bound times area where the bound is known, (other points,) (force).
        bounded_slips: Along the surface there, (other points, components, motions).
    """

    closing: Array
    coefficients: Array
    slips: Array
    bounds: Array
    bounded_slips: Array

    def of_motions(self, motions: Array) -> ContactCones:
        """The same of combinations of the motions, as columns."""
        return replace(
            self,
            closing=self.closing @ motions,
            slips=self.slips @ motions,
            bounded_slips=self.bounded_slips @ motions,
        )


def contact_cones(problem: Problem, rigid: RigidMotions) -> ContactCones:
    """Of all points that may touch, whatever their gap; collective.

    Left out are points whose ray misses what stands opposite. Glued ones need no room here:
    motions leave glue alone.
    """
    components, count = problem.spaces.components, rigid.count
    rows = [np.zeros((0, 1 + (1 + components) * count))]
    for contact in problem.contacts:
        if not contact.is_one_sided:
            continue
        jumps, trace = rigid.jumps(contact), contact.trace
        coefficients = contact.friction.largest_coefficient
        closing = np.einsum("ijk,ij->ik", jumps, trace.normals)
        slips = jumps - closing[:, None, :] * trace.normals[:, :, None]
        acts = trace.owned & contact.normal.can_press()
        flat = slips.reshape(len(slips), components * count)
        rows.append(np.column_stack([coefficients, closing, flat])[acts])
    table = gather_rows(problem.comm, np.concatenate(rows))
    weights, slips = rigid.slips()
    known = gather_rows(
        problem.comm, np.column_stack([weights, slips.reshape(len(weights), components * count)])
    )
    return ContactCones(
        closing=table[:, 1 : 1 + count],
        coefficients=table[:, 0],
        slips=table[:, 1 + count :].reshape(-1, components, count),
        bounds=known[:, 0],
        bounded_slips=known[:, 1:].reshape(-1, components, count),
    )
