"""The unknowns of a body whose cut faces move alike: u = T y, y the jump on the face that follows.

T is 1, and has C in the rows of displacements that follow. Their unknowns are the jumps
y = u − C u' across the cut, which are held at 0 as a support holds displacements. So the stiffness
is Tᵀ K T, and forces on the unknowns are Tᵀ f.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc
from scipy.sparse import coo_matrix, csr_matrix

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import of_every_rank, total


class RankTransform:
    """T of the unknowns of one rank's cells, with masters that only other ranks' cells touch.

    Attributes:
        matrix: T, (unknowns of the cells, all unknowns) (dimensionless).
        others: Numbers over all ranks of the masters beside the cells' own, the last unknowns.
        shared: Numbers of all masters that are such ones on some rank.

    Args:
        cut: The cut faces.
        numbers: Of the unknowns of the cells over all ranks, displacements first.
        displacements: How many of them are displacements.
        spaces: Those of the body; collective.
    """

    def __init__(
        self, cut: CutFaces, numbers: Integers, displacements: int, spaces: Spaces
    ) -> None:
        self._cut, self._comm = cut, spaces.comm
        own = numbers[:displacements]
        rows, at = np.intersect1d(cut.slaves.numbers, own, return_indices=True)[1:]
        entries = cut.matrix[rows].tocoo()
        masters = cut.masters.numbers[entries.col]
        self.others = np.setdiff1d(masters, own)
        self.shared = np.unique(np.concatenate(of_every_rank(spaces.comm, self.others)))
        every = np.concatenate([own, self.others])
        order = np.argsort(every)
        columns = order[np.searchsorted(every[order], masters)]
        columns = columns + np.where(columns < displacements, 0, len(numbers) - displacements)
        unit = np.arange(len(numbers))
        self.matrix = csr_matrix(
            coo_matrix(
                (
                    np.concatenate([np.ones(len(unit)), entries.data]),
                    (np.concatenate([unit, at[entries.row]]), np.concatenate([unit, columns])),
                ),
                shape=(len(numbers), len(numbers) + len(self.others)),
            )
        )
        self._slaves = at
        self._of_others = np.searchsorted(cut.masters.numbers, self.others)
        size = spaces.components
        places = cut.masters.gathered(np.repeat(spaces.coordinates, size, axis=0))
        #: Where ``others`` are, (others, 3) (length), and which component each is.
        self.places = places[self._of_others], self.others % size

    def unknowns(self, own: Array, flat: Array) -> Array:
        """Y of displacements that the faces of the cut agree on; collective.

        Args:
            own: At the cells' own unknowns.
            flat: At all displacement dofs of this rank.
        """
        found = np.concatenate([own, self._cut.masters.gathered(flat)[self._of_others]])
        found[self._slaves] = 0.0
        return found

    def of_others(self, share: Array, shape: tuple[int, ...]) -> Array:
        """Shares at ``others`` of all ranks, at this rank's nodes; collective.

        Args:
            share: At all unknowns of this rank.
            shape: Of the array of nodes, (nodes, components).
        """
        sums = np.zeros(len(self._cut.masters.numbers))
        sums[self._of_others] = share[len(share) - len(self.others) :]
        found = np.zeros(shape)
        self._cut.masters.place(np.asarray(total(self._comm, sums)), found.reshape(-1))
        return found

    def held(self, own: Flags, flat: Flags) -> Flags:
        """Which unknowns are held: what supports hold, and jumps across the cut; collective.

        Args:
            own: Of the cells' own unknowns, by supports.
            flat: Of all displacement dofs of this rank, likewise.
        """
        others = self._cut.masters.gathered(flat.astype(np.float64))[self._of_others] > 0
        found = np.concatenate([own, others])
        found[self._slaves] = True
        return found


class SectorTransform:
    """T of all unknowns, a matrix of PETSc; collective.

    Attributes:
        slaves: Rows of this rank whose unknowns are jumps across the cut, by their local numbers.

    Args:
        cut: The cut faces.
        stiffness: The matrix of all unknowns.
        spaces: Those of the body.
    """

    def __init__(self, cut: CutFaces, stiffness: PETSc.Mat, spaces: Spaces) -> None:
        first, last = stiffness.getOwnershipRange()
        size = spaces.components
        begin = spaces.displacement_space.dofmap.index_map.local_range[0] * size
        begins, firsts = np.array(of_every_rank(spaces.comm, (begin, first))).T
        owned = spaces.owned_nodes * size
        mine = cut.slaves.local < owned
        self.slaves = cut.slaves.local[mine]
        entries = cut.matrix[cut.slaves.here[mine]].tocoo()
        masters = cut.masters.numbers[entries.col]
        owners = np.searchsorted(begins, masters, side="right") - 1
        columns = masters - begins[owners] + firsts[owners]
        unit = np.arange(last - first)
        rows = np.concatenate([unit, self.slaves[entries.row]])
        every = np.concatenate([first + unit, columns])
        values = np.concatenate([np.ones(len(unit)), entries.data])
        shape = (last - first, stiffness.getSize()[1])
        local = csr_matrix(coo_matrix((values, (rows, every)), shape=shape))
        csr = tuple(part.astype(PETSc.IntType) for part in (local.indptr, local.indices))
        self.matrix = PETSc.Mat().createAIJ(
            stiffness.getSizes(), csr=(*csr, local.data), comm=spaces.comm
        )

    def destroy(self) -> None:
        """Free the matrix."""
        self.matrix.destroy()
