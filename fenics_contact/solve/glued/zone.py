"""The cells at the slaves' surfaces: what is nearly the stiffness between jumps, and sparse.

A jump of short wave strains the cells beneath the surface, and hardly those behind them. With all
else held, their stiffness and that of the contacts are a sparse matrix, in which all that is stiff
or changes from one Newton step to the next is exact. It lacks what the masters give way, a factor
of about two, and the far field of long waves: that is left to GMRES.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.factors.local_factor import LocalFactor

# Layers of nodes beneath the surface, as cells couple them.
_LAYERS = 2


class Zone:
    """Stiffness of the cells at the slaves.

    Args:
        stiffness: K of all ranks, sparse, (unknowns, unknowns) (force/length).
        held: Which of its unknowns supports hold.
        contact: The free contact dofs among them.
        jumps: Places in ``contact`` of the jumps.

    Attributes:
        unknowns: Number of unknowns of K.
        diagonal: That of K, at the jumps.
        column_sums: Σ |K| over its rows, at the jumps.
    """

    def __init__(
        self, stiffness: csr_matrix, held: Flags, contact: Integers, jumps: Integers
    ) -> None:
        self.unknowns = len(held)
        own = contact[jumps]
        barred = held.copy()
        barred[contact] = True
        reached = np.zeros(len(held), dtype=bool)
        reached[own] = True
        for _ in range(_LAYERS):
            new = np.unique(stiffness[np.flatnonzero(reached)].indices)
            reached[new[~barred[new]]] = True
        reached[own] = False
        every = np.concatenate([own, np.flatnonzero(reached)])
        self._count = len(own)
        self._matrix = csr_matrix(stiffness[every][:, every])
        rows = stiffness[own]
        self.column_sums = np.asarray(abs(rows).sum(axis=1)).ravel()
        self.diagonal: Array = self._matrix.diagonal()[: self._count]

    def factorised(self, added: csr_matrix) -> ZoneFactor:
        """With the stiffness of contacts.

        Args:
            added: Between the jumps, (jumps, jumps).
        """
        entries, size = coo_matrix(added), self._matrix.shape[0]
        places = entries.row, entries.col
        whole = self._matrix + csr_matrix((entries.data, places), shape=(size, size))
        whole.sort_indices()
        return ZoneFactor(csr_matrix(whole), self._count)


class ZoneFactor:
    """A factor of the zone's stiffness with that of contacts.

    Args:
        matrix: The stiffness, the jumps first.
        count: How many these are.

    Attributes:
        is_singular: Whether there is none.
    """

    def __init__(self, matrix: csr_matrix, count: int) -> None:
        chosen = mumps.Factorisation("lu", mumps.AUTOMATIC)
        self._factor = LocalFactor(matrix, np.zeros(0, dtype=np.int64), chosen)
        self._factor.forget_matrix()
        self._count = count
        self.is_singular = self._factor.error is not None

    def solve(self, forces: Array) -> Array:
        """Jumps under forces on them, (jumps,)."""
        right = np.zeros(self._factor.size)
        right[: self._count] = forces
        return np.asarray(self._factor.solve(right)[: self._count])

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._factor.destroy()
