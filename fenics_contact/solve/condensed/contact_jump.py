"""The jump of one contact over the unknowns of the condensed problem, and its tangent's entries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Integers
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix


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


class EntryPattern:
    """Where the entries of K_c go in Lᵀ K_c B; one may go to several places.

    Attributes:
        entries: Numbers of K_c's entries.
        rows: Of the unknowns that each goes to.
        columns: Likewise.
        weights: Its factors there.
    """

    def __init__(self, jump: ContactJump, places: list[tuple[Integers, Integers]]) -> None:
        rows, columns = (np.concatenate(part) for part in zip(*places, strict=True))
        work, motion = jump.work[rows], jump.motion[columns]
        by_work, by_motion = np.diff(work.indptr), np.diff(motion.indptr)
        count = by_work * by_motion
        self.entries = np.repeat(np.arange(len(rows)), count)
        number = np.arange(len(self.entries)) - np.repeat(np.cumsum(count) - count, count)
        first, second = np.divmod(number, np.maximum(by_motion, 1)[self.entries])
        first += work.indptr[self.entries]
        second += motion.indptr[self.entries]
        self.rows, self.columns = work.indices[first], motion.indices[second]
        self.weights = work.data[first] * motion.data[second]
