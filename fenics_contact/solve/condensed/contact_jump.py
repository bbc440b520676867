"""The jump of one contact over the unknowns of the condensed problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix, hstack

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.problem.scalar_unknowns import ContactScalar
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix, congruent
from fenics_contact.solve.systems.pair_stiffness import Entries


@dataclass(frozen=True, eq=False)
class ContactJump:
    """The jump w = B (y, z) + c of one contact; rows are dofs of its surface.

    Columns are the unknowns y, then the derived jumps z.

    Attributes:
        surface: Tangent in the jump.
        relative: Displacement relative to a body opposite: B without an obstacle's motion.
        motion: B: contact variables, an obstacle's motion, the far field of resultants.
        work: L: rows of the balance that its forces enter, Lᵀ: as B, without the far field,
            and its direction for a resultant.
    """

    surface: SurfaceMatrix
    relative: csr_matrix
    motion: csr_matrix
    work: csr_matrix

    @classmethod
    def over(
        cls,
        surface: SurfaceMatrix,
        points: csr_matrix,
        count: int,
        unknowns: Sequence[ContactScalar],
        far: Sequence[Array],
    ) -> ContactJump:
        """That of a contact, with what scalar unknowns move of it.

        Args:
            surface: Tangent in the jump.
            points: Jumps over displacements and derived jumps, without scalars.
            count: Number of the displacements.
            unknowns: The scalars.
            far: Displacements at the dofs of the surface that each of these adds.
        """
        if not unknowns:
            return cls(surface, points, points, points)
        rows = points.shape[0]
        relative, motion, work = np.zeros((3, rows, len(unknowns)))
        for column, unknown in enumerate(unknowns):
            if unknown.column is not None:
                motion[:, column] = relative[:, column] = far[column]
            direction = np.resize(unknown.direction, rows)
            if unknown.contact is surface.contact:
                work[:, column] = -unknown.pushes * direction
                if unknown.drives:
                    motion[:, column] = -direction

        def beside(scalars: Array) -> csr_matrix:
            return csr_matrix(hstack([points[:, :count], scalars, points[:, count:]], "csr"))

        return cls(surface, beside(relative), beside(motion), beside(work))

    @cached_property
    def _columns(self) -> Integers | None:
        """The one column that each row of B and L has, −1 of a row of zeros; None of others."""
        if self.work is not self.motion:
            return None
        found = np.full(self.motion.shape[0], -1)
        entries = self.motion.tocoo()
        found[entries.row] = entries.col
        is_selection = len(entries.row) == len(set(entries.row)) and (entries.data == 1.0).all()
        return found if is_selection else None

    def tangent(self, entries: Entries) -> Entries:
        """Entries of Lᵀ K_c B; those at the same place add up.

        Args:
            entries: Of K_c, between the dofs of the surface.
        """
        columns = self._columns
        if columns is None:
            return congruent(entries, self.work, self.motion)
        rows, others, values = columns[entries[0]], columns[entries[1]], entries[2]
        kept = (rows >= 0) & (others >= 0) & (values != 0)
        return rows[kept], others[kept], values[kept]
