"""Forces of contacts on rigid motions: cones of Coulomb's friction, discs of a known bound."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, identity

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import gather_rows
from fenics_contact.problem.existence.smooth_closing import smooth_closing
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions, reduced

# Of the closing of all motions: what is less is round-off.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class ContactCones:
    """Jumps of rigid motions where contacts may act, of all ranks.

    Attributes:
        closing: Across the surface at one-sided contacts, > 0 closing, (points, motions).
        coefficients: Friction coefficient there, (points,).
        slips: Along the surface there, as friction feels them, (points, components, motions).
        bounds: Friction bound times area where the bound is known, (other points,) (force).
        bounded_slips: The same there, (other points, components, motions).
        average: What makes of pressures at the points those that bounds follow; None where these
            are the same.
    """

    closing: Array
    coefficients: Array
    slips: Array
    bounds: Array
    bounded_slips: Array
    average: csr_matrix | None = None

    def resisted(self, lengths: Array) -> Array:
        """Work of friction by a unit pressure at each point against slips of some lengths.

        Averages keep ∫ p: what a pressure makes of bounds around it is by the same weights as what
        the pressures around a point make of its bound.

        Args:
            lengths: Of the slips at the points, (points,).
        """
        rubbed = self.coefficients * lengths
        return rubbed if self.average is None else np.asarray(self.average @ rubbed)

    def rubbing(self, point: int, directions: Array) -> Array:
        """Work of friction by a unit pressure at a point on the motions, (motions,).

        Args:
            point: Number of the point.
            directions: Of the friction at all points, (points, components).
        """
        if self.average is None:
            return np.asarray(self.coefficients[point] * (directions[point] @ self.slips[point]))
        row = self.average[[point]]
        weights = (row.data * self.coefficients[row.indices])[:, None] * directions[row.indices]
        return np.asarray(np.einsum("ic,icm->m", weights, self.slips[row.indices]))

    def aligned(self) -> tuple[ContactCones, Array]:
        """Take motions that close no contact as columns of their own, which close nothing at all.

        As a shaft's rotation in its bearing, also where its centre of mass lies beside its axis:
        else pressures of any size would hold the round-off of a combination.

        Returns:
            The cones of these motions, and the motions, as columns, (motions, motions).
        """
        motions = np.eye(self.closing.shape[1])
        _, sizes, rows = np.linalg.svd(np.linalg.qr(self.closing, mode="r"))
        sizes = np.append(sizes, np.zeros(len(rows) - len(sizes)))
        along = reduced(rows[sizes <= _ROUND_OFF * sizes.max(initial=0.0)].T)
        # Each is the only one in some row, of whose motion it takes the place.
        places = [int(np.abs(along - one).max(axis=1).argmin()) for one in np.eye(along.shape[1])]
        motions[:, places] = along
        found = self.of_motions(motions)
        closing = found.closing.copy()
        closing[:, places] = 0.0
        return replace(found, closing=closing), motions

    def of_motions(self, motions: Array) -> ContactCones:
        """The cones on combinations of the motions, which are columns."""
        return replace(
            self,
            closing=self.closing @ motions,
            slips=self.slips @ motions,
            bounded_slips=self.bounded_slips @ motions,
        )


def contact_cones(problem: Problem, rigid: RigidMotions) -> ContactCones:
    """Cones of all points that may touch, whatever their gap; collective.

    Left out are points whose ray misses what stands opposite. Glued ones need no room here:
    motions leave glue alone.
    """
    components, count = problem.spaces.components, rigid.count
    rows = [np.zeros((0, 3 + (1 + components) * count))]
    averages: dict[int, csr_matrix] = {}
    for number, contact in enumerate(problem.contacts):
        if not contact.is_one_sided:
            continue
        jumps, trace = rigid.jumps(contact), contact.trace
        coefficients = contact.friction.largest_coefficient
        neighbours, places = contact.friction.neighbours, np.zeros(len(coefficients))
        if neighbours is not None:
            averages[number], places = neighbours.matrix, neighbours.places.astype(float)
        numbers = np.full(len(places), float(number))
        closing = np.einsum("ijk,ij->ik", jumps, trace.normals)
        slips = contact.friction.rule.metric.at_each(
            jumps - closing[:, None, :] * trace.normals[:, :, None]
        )
        acts = trace.owned & contact.normal.can_press()
        closing = smooth_closing(contact, closing, jumps, acts)
        flat = slips.reshape(len(slips), components * count)
        rows.append(np.column_stack([coefficients, numbers, places, closing, flat])[acts])
    table = gather_rows(problem.comm, np.concatenate(rows))
    weights, slips = rigid.slips()
    known = gather_rows(
        problem.comm, np.column_stack([weights, slips.reshape(len(weights), components * count)])
    )
    return ContactCones(
        closing=table[:, 3 : 3 + count],
        coefficients=table[:, 0],
        slips=table[:, 3 + count :].reshape(-1, components, count),
        bounds=known[:, 0],
        bounded_slips=known[:, 1:].reshape(-1, components, count),
        average=_average(table[:, 1:3].astype(np.int64), averages) if averages else None,
    )


def _average(points: Integers, averages: dict[int, csr_matrix]) -> csr_matrix:
    """Of all points: contacts that average nothing have ones.

    Args:
        points: Contact and place of each, (points, 2).
        averages: Of contacts, by number, between their places.
    """
    found = identity(len(points), format="coo")
    own = ~np.isin(points[:, 0], list(averages))
    rows, columns, values = [found.row[own]], [found.col[own]], [found.data[own]]
    for number, matrix in averages.items():
        mine = np.flatnonzero(points[:, 0] == number)
        places = points[mine, 1]
        part = matrix[places][:, places].tocoo()
        rows.append(mine[part.row])
        columns.append(mine[part.col])
        values.append(part.data)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return csr_matrix(entries, shape=(len(points),) * 2)
