"""The cells at one side of the contacts: nearly the stiffness of its surface, and sparse.

A displacement of short wave strains the cells beneath a surface, and hardly those behind them. With
all else held, their stiffness is a sparse matrix. At the slaves, with that of the contacts, it has
all that is stiff or changes from one Newton step to the next (``glued_tangent``). What it lacks is
the far field of long waves: that is left to Krylov steps.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, diags

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.factors.local_factor import LocalFactor

# Layers of nodes beneath the surface, as cells couple them. A second one spares hardly a Krylov
# step, and its factor takes four times as long.
_LAYERS = 1
# Springs at a surface over the stiffness of its cells: they hold bodies that lie in a zone as a
# whole, and are little beside what holds the others there.
_SPRINGS = 1e-2


class Zone:
    """Stiffness of the cells at some contact dofs, with the other contact dofs held.

    Args:
        stiffness: K of all ranks, sparse, (unknowns, unknowns) (force/length).
        held: Which of its unknowns supports hold.
        contact: The free contact dofs among them.
        own: Places in ``contact`` of those of this side.

    Attributes:
        unknowns: Number of unknowns of K.
        diagonal: That of K, at the dofs of this side.
        column_sums: Σ |K| over its rows, at the dofs of this side.
    """

    def __init__(
        self, stiffness: csr_matrix, held: Flags, contact: Integers, own: Integers
    ) -> None:
        self.unknowns = len(held)
        mine = contact[own]
        barred = held.copy()
        barred[contact] = True
        reached = np.zeros(len(held), dtype=bool)
        reached[mine] = True
        for _ in range(_LAYERS):
            new = np.unique(stiffness[np.flatnonzero(reached)].indices)
            reached[new[~barred[new]]] = True
        reached[mine] = False
        every = np.concatenate([mine, np.flatnonzero(reached)])
        self._count = len(mine)
        self._matrix = csr_matrix(stiffness[every][:, every])
        rows = stiffness[mine]
        self.column_sums = np.asarray(abs(rows).sum(axis=1)).ravel()
        self.diagonal: Array = self._matrix.diagonal()[: self._count]

    def factorised(self, added: csr_matrix) -> ZoneFactor:
        """With the stiffness of contacts.

        Args:
            added: Between the dofs of this side.
        """
        return ZoneFactor(self._with(added), self._count, "lu")

    def on_springs(self) -> ZoneFactor:
        """Factor without contacts, with weak springs at the dofs of this side."""
        return ZoneFactor(self._with(diags(_SPRINGS * self.diagonal)), self._count, "cholesky")

    def _with(self, added: csr_matrix) -> csr_matrix:
        entries, size = coo_matrix(added), self._matrix.shape[0]
        places = entries.row, entries.col
        whole = self._matrix + csr_matrix((entries.data, places), shape=(size, size))
        whole.sort_indices()
        return csr_matrix(whole)


class ZoneFactor:
    """A factor of a zone's stiffness.

    Args:
        matrix: The stiffness, the dofs of the surface first.
        count: How many these are.
        kind: ``lu``, or ``cholesky`` of a symmetric matrix.

    Attributes:
        is_singular: Whether there is none.
    """

    def __init__(self, matrix: csr_matrix, count: int, kind: str) -> None:
        chosen = mumps.Factorisation(kind, mumps.AUTOMATIC)
        self._factor = LocalFactor(matrix, np.zeros(0, dtype=np.int64), chosen)
        self._factor.forget_matrix()
        self._count = count
        self.is_singular = self._factor.error is not None

    def solve(self, forces: Array) -> Array:
        """Displacements of the surface under forces on it, (…, dofs)."""
        right = np.zeros((*forces.shape[:-1], self._factor.size))
        right[..., : self._count] = forces
        return np.asarray(self._factor.solve(right)[..., : self._count])

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._factor.destroy()
