"""The unknowns of the condensed problem: jumps where bodies touch, else displacements.

Where a slave surface faces a master, its displacement is u = w + P u' with the jump w. With w as
the unknown a contact of two bodies has its tangent where that of a rigid obstacle has it, at the
points that touch, and couples no two dofs more; the bulk's part takes P once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, identity

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.solve.condensed.contact_dofs import ContactDofs
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix


@dataclass(frozen=True, eq=False)
class _Block:
    """A part of T − 1: free displacements of masters that a slave's are measured from.

    Attributes:
        slaves: Numbers among the free contact dofs.
        masters: Likewise.
        projection: P, (slaves, masters).
    """

    slaves: Integers
    masters: Integers
    projection: Array


class ContactVariables:
    """u = T y of the free contact dofs; T is 1 but for the rows of slaves.

    Args:
        dofs: The contact dofs.
        surfaces: Of the contacts that exert forces.

    Attributes:
        count: Number of unknowns.
    """

    def __init__(self, dofs: ContactDofs, surfaces: Sequence[SurfaceMatrix]) -> None:
        self._dofs = dofs
        self.count = len(dofs.free)
        self._unknown_of = np.cumsum(dofs.is_free) - 1
        self._blocks: list[_Block] = []
        self._as_jumps: list[SurfaceMatrix] = []
        self._relatives = {surface: self._relative(surface) for surface in surfaces}
        slaves, masters = np.zeros((2, len(dofs.numbers)), dtype=bool)
        for surface in surfaces:
            pairing = surface.contact.kinematics.pairing
            if pairing is None:
                continue
            slave, master = dofs.places(surface.dofs), dofs.places(pairing.dofs)
            # A dof that is a slave here and a master there keeps its displacement as the unknown;
            # it may be both in one contact, as at the tip of a slit.
            both = np.isin(slave, master) | (slaves | masters)[slave]
            if both.any() or slaves[master].any():
                continue
            slaves[slave] = masters[master] = True
            self._as_jumps.append(surface)
            self._blocks += self._blocks_of(pairing, slave, master)

    def _blocks_of(self, pairing: Pairing, slave: Integers, master: Integers) -> list[_Block]:
        size, free = len(pairing.blocks), self._dofs.is_free
        found = []
        for axis, block in enumerate(pairing.blocks):
            mine, others = slave[axis::size], master[axis::size]
            part = block[np.ix_(free[mine], free[others])]
            slaves, masters = (self._unknown_of[dofs[free[dofs]]] for dofs in (mine, others))
            found.append(_Block(slaves, masters, part))
        return found

    def stiffness(self, schur: Array) -> Array:
        """Tᵀ S T."""
        if not self._blocks:
            return schur
        found = schur.copy()
        for block in self._blocks:
            found[:, block.masters] += found[:, block.slaves] @ block.projection
        for block in self._blocks:
            found[block.masters] += block.projection.T @ found[block.slaves]
        return found

    def forces(self, forces: Array) -> Array:
        """Tᵀ f."""
        found = forces.copy()
        for block in self._blocks:
            found[block.masters] += forces[block.slaves] @ block.projection
        return found

    def displacements(self, unknowns: Array) -> Array:
        """T y."""
        found = unknowns.copy()
        for block in self._blocks:
            found[block.slaves] += block.projection @ unknowns[block.masters]
        return found

    def unknowns(self, displacements: Array) -> Array:
        """T⁻¹ u."""
        found = displacements.copy()
        for block in self._blocks:
            found[block.slaves] -= block.projection @ displacements[block.masters]
        return found

    def jump(self, surface: SurfaceMatrix) -> csr_matrix:
        """Displacements of a surface relative to what is opposite, over the unknowns."""
        free = np.flatnonzero(self._dofs.is_free)
        over_free = csr_matrix(self._relatives[surface][:, free])
        if surface in self._as_jumps:
            return self._with_unit_rows(surface, over_free)
        return over_free @ self._transform() if self._blocks else over_free

    def _with_unit_rows(self, surface: SurfaceMatrix, over_free: csr_matrix) -> csr_matrix:
        """The rows of free slaves are y itself, and exactly so."""
        places = self._dofs.places(surface.dofs)
        free = np.flatnonzero(self._dofs.is_free[places])
        keeps = np.ones(len(places))
        keeps[free] = 0.0
        unit = csr_matrix(
            (np.ones(len(free)), (free, self._unknown_of[places[free]])), shape=over_free.shape
        )
        others = csr_matrix(over_free.multiply(keeps[:, None]))
        others.eliminate_zeros()
        return csr_matrix(others + unit)

    def held_part(self, surface: SurfaceMatrix, held: Array) -> Array:
        """What held displacements, given at all contact dofs, add to ``jump``."""
        return np.asarray(self._relatives[surface] @ held)

    def _relative(self, surface: SurfaceMatrix) -> csr_matrix:
        """U − P u' of a surface over all contact dofs."""
        places = self._dofs.places(surface.dofs)
        shape = (len(places), len(self._dofs.numbers))
        own = csr_matrix((np.ones(len(places)), (np.arange(len(places)), places)), shape=shape)
        pairing = surface.contact.kinematics.pairing
        if pairing is None:
            return own
        master, size = self._dofs.places(pairing.dofs), len(pairing.blocks)
        entries: list[tuple[Array, Integers, Integers]] = []
        for axis, block in enumerate(pairing.blocks):
            rows, columns = np.nonzero(block)
            there = master[columns * size + axis]
            entries.append((block[rows, columns], rows * size + axis, there))
        values, *numbers = (np.concatenate(part) for part in zip(*entries, strict=True))
        return csr_matrix(own - csr_matrix((values, tuple(numbers)), shape=shape))

    def _transform(self) -> csr_matrix:
        """T, sparse."""
        found = csr_matrix(identity(self.count))
        for block in self._blocks:
            rows, columns = np.nonzero(block.projection)
            places = (block.slaves[rows], block.masters[columns])
            entries = (block.projection[rows, columns], places)
            found = found + csr_matrix(entries, shape=found.shape)
        return csr_matrix(found)
