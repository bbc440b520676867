"""The tangent of a contact between two bodies, as entries between displacements of both.

With the jump w = u − P u' it is Jᵀ K_c J, J = (1, −P): full between all displacements of both
surfaces. It is made some rows at a time, by J and its transpose applied; each rank makes its own
rows, so that what it holds beside them grows with the surfaces only.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from mpi4py import MPI
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import of_every_rank
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.mortar.projection import Projection, parts_of

Entries = tuple[Integers, Integers, Array]
_ROWS = 64  # made at a time


class PairStiffness:
    """Jᵀ K_c J of a slave surface and its master.

    Attributes:
        dofs: The body's global numbers of all displacements of the slave, then of the master.
        own: Numbers in ``dofs`` of those that this rank owns, by components.

    Args:
        pairing: The two.
        slave_dofs: The first part of ``dofs``.
        first: The body's global number of the first displacement that this rank owns.
        owned: How many it owns.
    """

    def __init__(self, pairing: Pairing, slave_dofs: Integers, first: int, owned: int) -> None:
        self._pairing, self._slaves = pairing, len(slave_dofs)
        self.dofs = np.concatenate([slave_dofs, pairing.dofs])
        own = np.flatnonzero((self.dofs >= first) & (self.dofs < first + owned))
        self._size = pairing.master.components
        # Those of one component together: P u' of the others is 0.
        self.own = own[np.argsort(own % self._size, kind="stable")]

    def own_rows(self) -> Iterator[Integers]:
        """The body's numbers of this rank's rows, some at a time."""
        return (self.dofs[self.own[part]] for part in parts_of(len(self.own), _ROWS))

    def rows(self, comm: MPI.Comm, entries: Entries) -> Iterator[tuple[Integers, Array]]:
        """This rank's rows of Jᵀ K_c J, some at a time; collective.

        Args:
            comm: Communicator.
            entries: Rows, columns (dofs of the slave) and values of K_c, of this rank.

        Returns:
            The body's numbers of rows, and these, (rows, dofs).
        """
        transposed = csr_matrix(self._on_slave(comm, entries).T)
        return self._made(transposed, self._pairing.whole_projection())

    def _on_slave(self, comm: MPI.Comm, entries: Entries) -> csr_matrix:
        """K_c of the whole slave, (slave dofs, slave dofs), on every rank; collective.

        Args:
            comm: Communicator.
            entries: Rows, columns (dofs of the slave) and values, of this rank.
        """
        rows, columns, values = (
            np.concatenate(parts) for parts in zip(*of_every_rank(comm, entries), strict=True)
        )
        shape = (self._slaves, self._slaves)
        return csr_matrix((values, (rows, columns)), shape=shape)

    def _made(
        self, transposed: csr_matrix, projection: Projection
    ) -> Iterator[tuple[Integers, Array]]:
        """The same, from K_cᵀ and P."""
        for part in parts_of(len(self.own), _ROWS):
            chosen = self.own[part]
            unit = np.zeros((len(self.dofs), len(chosen)))
            unit[chosen, np.arange(len(chosen))] = 1.0
            pulled = transposed @ self._jump(projection, unit)
            acts = pulled.any(axis=0)  # no open point does
            if acts.any():
                yield self.dofs[chosen[acts]], self._forces(projection, pulled[:, acts]).T

    def _jump(self, projection: Projection, displacement: Array) -> Array:
        """J u, (slave dofs, columns), of displacements (dofs, columns)."""
        opposite = displacement[self._slaves :]
        nodal = opposite.reshape(-1, self._size, opposite.shape[1])
        moved = projection.apply(nodal)
        return displacement[: self._slaves] - moved.reshape(self._slaves, -1)

    def _forces(self, projection: Projection, given: Array) -> Array:
        """Jᵀ f, (dofs, columns), of forces (slave dofs, columns)."""
        nodal = given.reshape(-1, self._size, given.shape[1])
        taken = projection.transposed(nodal)
        return np.concatenate([given, -taken.reshape(-1, given.shape[1])])
