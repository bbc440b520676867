"""The jump of one contact over the unknowns of the condensed problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.problem.scalars.scalar import ScalarUnknown
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.solve.systems.pair_stiffness import Entries


@dataclass(frozen=True, eq=False)
class ContactJump:
    """The jump w = B (y, q, z) + c of one contact; rows are dofs of its surface.

    Each has one displacement y or derived jump z as its own, or none; scalars q may move all rows.

    Attributes:
        surface: Tangent in the jump.
        relative: What scalars make of the displacement relative to a body opposite, (rows,
            scalars): B without an obstacle's motion.
        motion: B of the scalars: an obstacle's motion, displacements that they prescribe.
        work: L of the scalars: rows of the balance that its forces enter, Lᵀ: as B, without the
            far field, and its direction for a resultant.
        rows: Those that have an unknown of their own, increasing.
        columns: That unknown of each.
        count: Number of displacements, which the scalars come after.
        width: Number of all unknowns, with derived jumps.
    """

    surface: SurfaceMatrix
    relative: Array
    motion: Array
    work: Array
    rows: Integers
    columns: Integers
    count: int
    width: int

    @classmethod
    def over(
        cls,
        surface: SurfaceMatrix,
        points: tuple[Integers, Integers],
        sizes: tuple[int, int],
        unknowns: Sequence[ScalarUnknown],
        far: Sequence[Array],
    ) -> ContactJump:
        """The jump of a contact, with the parts that scalar unknowns move.

        Args:
            surface: Tangent in the jump.
            points: Rows that have a displacement or a derived jump, and which.
            sizes: Numbers of displacements and of derived jumps.
            unknowns: The scalars.
            far: Displacements at the dofs of the surface that each of these adds.
        """
        rows, count = len(surface.dofs), sizes[0]
        relative, motion, work = np.zeros((3, rows, len(unknowns)))
        for column, unknown in enumerate(unknowns):
            if unknown.prescribes is not None:
                motion[:, column] = relative[:, column] = far[column]
            if unknown.contact is surface.contact:
                direction = np.resize(unknown.direction, rows)
                work[:, column] = -unknown.pushes * direction
                if unknown.drives:
                    motion[:, column] = -direction
        own, columns = points
        columns = columns + np.where(columns < count, 0, len(unknowns))
        width = sum(sizes) + len(unknowns)
        return cls(surface, relative, motion, work, own, columns, count, width)

    @cached_property
    def _place(self) -> Integers:
        """The unknown of each row, −1 of those that have none."""
        found = np.full(len(self.relative), -1)
        found[self.rows] = self.columns
        return found

    @property
    def _scalars(self) -> slice:
        return slice(self.count, self.count + self.work.shape[1])

    def displacement(self, unknowns: Array) -> Array:
        """Relative to a body opposite at its dofs, (rows,), without what is held.

        Args:
            unknowns: All, with derived jumps.
        """
        found = self.relative @ unknowns[self._scalars]
        found[self.rows] += unknowns[self.columns]
        return found

    def forces(self, force: Array) -> Array:
        """Lᵀ r, on all unknowns.

        Args:
            force: At its dofs, (rows,).
        """
        found = np.zeros(self.width)
        found[self._scalars] = force @ self.work
        found[self.columns] += force[self.rows]
        return found

    def virtual(self, unknowns: Array) -> Array:
        """L y: the jump by which its forces do work in a virtual displacement, (rows,).

        Args:
            unknowns: All, with derived jumps.
        """
        found = self.work @ unknowns[self._scalars]
        found[self.rows] += unknowns[self.columns]
        return np.asarray(found)

    def slopes(self, of_jump: Array) -> Array:
        """Bᵀ r: derivatives in all unknowns.

        Args:
            of_jump: In the jump at its dofs, (rows,).
        """
        found = np.zeros(self.width)
        found[self._scalars] = of_jump @ self.motion
        found[self.columns] += of_jump[self.rows]
        return found

    def relative_to(self, chosen: Integers) -> csr_matrix:
        """The displacement over some of the unknowns, none of which is a scalar."""
        shape = (len(self.relative), self.width)
        ones = np.ones(len(self.rows))
        return csr_matrix((ones, (self.rows, self.columns)), shape=shape)[:, chosen]

    def tangent(self, entries: Entries) -> Entries:
        """Entries of Lᵀ K_c B; those at the same place add up.

        Args:
            entries: Of K_c, between the dofs of the surface.
        """
        rows, columns, values = entries
        mine, others = self._place[rows], self._place[columns]
        size = self.work.shape[1]
        if not size:
            kept = (mine >= 0) & (others >= 0) & (values != 0)
            return mine[kept], others[kept], values[kept]
        scalars = self.count + np.arange(size)
        moved = values[:, None] * self.motion[columns]
        pushed = values[:, None] * self.work[rows]
        corner = pushed.T @ self.motion[columns]
        found = [
            (mine, others, values),
            (mine.repeat(size), np.tile(scalars, len(mine)), moved.ravel()),
            (np.tile(scalars, len(mine)), others.repeat(size), pushed.ravel()),
            (scalars.repeat(size), np.tile(scalars, size), corner.ravel()),
        ]
        rows, columns, values = (np.concatenate(part) for part in zip(*found, strict=True))
        kept = (rows >= 0) & (columns >= 0) & (values != 0)
        return rows[kept], columns[kept], values[kept]
