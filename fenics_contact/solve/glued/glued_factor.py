"""The stiffness of all bodies with their contacts glued: one sparse factor, on one rank.

What is held in it is the jump at each contact. A slave's displacement is u = q + w, with the jump w
and with q that the master prescribes: D q = M v, the mortar equations, which are sparse where their
solution P = D⁻¹ M is full. With one multiplier for each of them,

    [[K, Cᵀ], [C, 0]] (z, μ) = (f − K w, g),   C (q, v) = D q − M v,

z the displacements without w, g what a jump that another one is measured from adds. The forces that
this leaves at the slaves, K u − f, are the gradient of the energy in w. So one back-substitution
multiplies by the stiffness between all jumps, S' of ``elimination``, and takes no more memory than
the factor. The matrix is symmetric and indefinite.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import bmat, coo_matrix, csr_matrix, diags

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.factors.local_factor import LocalFactor
from fenics_contact.contact.mortar.projection import NodalProjection
from fenics_contact.solve.condensed.part_factors import with_unit_rows

Glue = Sequence[tuple[Integers, Integers, NodalProjection]]


class GluedFactor:
    """Displacements of all bodies by forces, and by jumps at the contacts.

    Args:
        stiffness: K of all ranks, sparse, (unknowns, unknowns) (force/length).
        held: Which of its unknowns supports hold.
        contact: The free contact dofs among the unknowns.
        glue: Places in ``contact`` of slaves and of masters, and P between them.
        jumps: Places in ``contact`` of all jumps: slaves, and dofs that face no body.

    Attributes:
        error: What went wrong, or None.
        contact: See the arguments.
    """

    def __init__(
        self,
        stiffness: csr_matrix,
        held: Flags,
        contact: Integers,
        glue: Glue,
        jumps: Integers,
    ) -> None:
        self.contact, self._jumps = contact, jumps
        self._held, self._count = held, len(held)
        free = with_unit_rows(stiffness, held)
        self._rows = free[contact]
        slaves = np.concatenate([np.zeros(0, dtype=np.int64), *(one for one, _, _ in glue)])
        self._alone = contact[np.setdiff1d(jumps, slaves)]  # of dofs that face no body
        fixed = np.zeros(len(held), dtype=bool)
        fixed[self._alone] = True
        equations = _Equations(glue, contact, len(held), float(np.abs(free.diagonal()).mean()))
        self._masters = equations.of_masters
        matrix = equations.around(with_unit_rows(free, fixed), fixed)
        chosen = mumps.Factorisation("cholesky", mumps.AUTOMATIC)
        self._factor = LocalFactor(matrix, np.zeros(0, dtype=np.int64), chosen)
        self._factor.forget_matrix()
        self.error = self._factor.error

    def solve(self, forces: Array, jumps: Array | None = None) -> Array:
        """Displacements of all unknowns, (…, unknowns).

        Args:
            forces: On them, and displacements where they are held, (…, unknowns).
            jumps: At the contacts, (jumps,); by default 0.
        """
        right = np.zeros((*forces.shape[:-1], self._factor.size))
        right[..., : self._count] = forces
        right[..., self._alone] = 0.0
        moved = np.zeros(self._count)
        if jumps is not None and jumps.any():
            at_contacts = np.zeros(len(self.contact))
            at_contacts[self._jumps] = jumps
            moved[self.contact] = at_contacts
            pulled = self._rows.T @ at_contacts
            pulled[self._alone] = 0.0
            right[..., : self._count] -= pulled
            right[..., -len(self._masters.indptr) + 1 :] += self._masters @ moved
        return np.asarray(self._factor.solve(right)[..., : self._count] + moved)

    def left(self, forces: Array, found: Array) -> Array:
        """Forces that displacements leave at the contact dofs, f − K u, (…, contact dofs)."""
        return np.asarray(forces[..., self.contact] - (self._rows @ found.T).T)

    def times(self, jumps: Array) -> Array:
        """S' w: forces between the jumps, (jumps,)."""
        found = self.solve(np.zeros(self._count), jumps)
        return np.asarray((self._rows @ found)[self._jumps])

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._factor.destroy()


class _Equations:
    """D q = M v of all contacts, scaled to the size of a stiffness.

    Attributes:
        of_masters: M over the unknowns, (equations, unknowns).

    Args:
        glue: As of ``GluedFactor``.
        contact: Likewise.
        count: Number of unknowns.
        size: About that of the stiffness of a displacement.
    """

    def __init__(self, glue: Glue, contact: Integers, count: int, size: float) -> None:
        self._count, self._width = count, count
        none = csr_matrix((0, count))
        masses, self.of_masters = [(none, np.arange(0))], none
        below = [none]
        for slaves, masters, projection in glue:
            found = projection.equations
            if found is None:
                continue
            mass, rows, coupling = found
            scale = size / mass.diagonal().mean()
            places = np.full(mass.shape[0], -1)
            places[rows] = contact[slaves]
            others = np.flatnonzero(places < 0)  # nodes of the mortar space without a jump
            places[others] = self._width + np.arange(len(others))
            self._width += len(others)
            masses.append((scale * mass, places))
            below.append(_placed(scale * coupling, contact[masters], count))
        self.of_masters = csr_matrix(bmat([[one] for one in below]))
        self._of_slaves = csr_matrix(bmat([[_placed(m, p, self._width)] for m, p in masses]))

    def around(self, stiffness: csr_matrix, fixed: Flags) -> csr_matrix:
        """[[K, Cᵀ], [C, 0]], with further q among the displacements.

        Args:
            stiffness: K, with unit rows where displacements are fixed.
            fixed: Which are.
        """
        width = self._width
        masters = self.of_masters @ diags((~fixed).astype(float))
        masters.resize((masters.shape[0], width))
        equations = csr_matrix(self._of_slaves - masters)
        whole = stiffness.copy()
        whole.resize((width, width))
        found = csr_matrix(bmat([[whole, equations.T], [equations, None]]))
        found.sort_indices()
        return found


def _placed(matrix: csr_matrix, columns: Integers, width: int) -> csr_matrix:
    """A matrix with its columns at other numbers."""
    entries = coo_matrix(matrix)
    places = entries.row, columns[entries.col]
    return csr_matrix((entries.data, places), shape=(matrix.shape[0], width))
