"""P between surfaces of a sector that end in its cut, or face each other across it.

Beyond the cut the slave goes on, turned. So displacements at its rim on one face follow from those
on the other, and there the integrals of both sides count: with v = E w of the nodes that follow
from none, P = E (Eᵀ D E)⁻¹ Eᵀ M F. Nodes of the master in other sectors move as F says of those in
this one. Turns mix components.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, identity, kron

from fenics_contact.common.arrays import AnyIntegers, Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows
from fenics_contact.contact.mortar.projection import (
    MassFactor,
    MortarIntegrals,
    NodalProjection,
    Projection,
    columns_together,
)
from fenics_contact.contact.mortar.turned_copies import TurnedCopies
from fenics_contact.contact.surface.space import SurfaceSpace


@dataclass(frozen=True, eq=False)
class RimAcrossCut:
    """Nodes of a surface that follow from others of it across the cut of a sector.

    Attributes:
        nodes: Numbers on the whole surface of those that follow, (nodes,).
        shares: Shares of all nodes in each, before it is turned, (nodes, nodes of the surface).
        rotation: R, (components, components).
    """

    nodes: AnyIntegers
    shares: csr_matrix
    rotation: Array

    def expansion(self, count: int) -> csr_matrix:
        """E over all dofs of a surface, without the columns of those that follow.

        Args:
            count: Number of its nodes.
        """
        size = len(self.rotation)
        others = np.ones(count)
        others[self.nodes] = 0.0
        own = kron(coo_matrix(identity(count).multiply(others[:, None])), identity(size))
        rows = self.nodes, np.arange(len(self.nodes))
        placed = coo_matrix((np.ones(len(self.nodes)), rows), (count, len(self.nodes)))
        return csr_matrix(own + kron(placed @ self.shares, self.rotation))


@dataclass(frozen=True, eq=False)
class AcrossCut:
    """How two surfaces that face each other go on beyond the cut of a sector.

    Attributes:
        copies: The master in this sector and in others.
        rim: Nodes of the slave that follow from others of it, or None.
    """

    copies: TurnedCopies
    rim: RimAcrossCut | None = None


class _DofProjection(NodalProjection):
    """P between dofs, or some rows and columns of it.

    Args:
        factor: (Eᵀ D E)⁻¹.
        expansion: E, (rows, dofs of the mortar space).
        coupling: Eᵀ M F, (dofs of the mortar space, columns) (area).
    """

    def __init__(self, factor: MassFactor, expansion: csr_matrix, coupling: csr_matrix) -> None:
        self._solver, self._expansion, self._right = factor, expansion, coupling
        self.shape = expansion.shape[0], coupling.shape[1]

    def restricted(self, rows: AnyIntegers, columns: AnyIntegers) -> NodalProjection:
        """Some rows and columns of P, with the same factor."""
        return _DofProjection(self._solver, self._expansion[rows], self._right[:, columns])

    def times(self, matrix: csr_matrix) -> NodalProjection:
        """P times a matrix."""
        return _DofProjection(self._solver, self._expansion, csr_matrix(self._right @ matrix))

    def apply(self, values: Array) -> Array:
        """P v, (rows, ...), of values (columns, ...)."""

        def product(columns: Array) -> Array:
            return np.asarray(self._expansion @ self._solver.solve(self._right @ columns))

        return columns_together(product, values, self.shape[0])

    def transposed(self, forces: Array) -> Array:
        """Pᵀ f, (columns, ...), of forces (rows, ...)."""

        def product(columns: Array) -> Array:
            given = self._solver.solve(self._expansion.T @ columns, transposed=True)
            return np.asarray(self._right.T @ given)

        return columns_together(product, forces, self.shape[1])

    def nonzero_rows(self) -> Flags:
        """Flags of rows for which P has entries."""
        parts = self._solver.parts
        coupled = np.zeros(parts.max(initial=-1) + 1, dtype=bool)
        np.logical_or.at(coupled, parts, np.diff(self._right.indptr) > 0)
        return np.asarray(abs(self._expansion) @ coupled[parts].astype(float) > 0)

    def nonzero_columns(self) -> Flags:
        """Flags of columns with an entry: P is 0 at the others."""
        return np.bincount(self._right.indices, minlength=self.shape[1]) > 0


class FoldedProjection(Projection):
    """P of the whole surfaces, whose components mix.

    Args:
        integrals: Of the whole surfaces, that of the master with its copies.
        fixed: Nodes taken out of the mortar space, (slave nodes, components).
        used: Nodes whose rows are kept; the others' are 0, (slave nodes,).
        across: How the surfaces go on beyond the cut.
    """

    def __init__(
        self, integrals: MortarIntegrals, fixed: Flags, used: Flags, across: AcrossCut
    ) -> None:
        count, self.size = fixed.shape
        unit = identity(self.size)
        expansion = csr_matrix(identity(count * self.size))
        if across.rim is not None:
            expansion = across.rim.expansion(count)
        mass = csr_matrix(expansion.T @ kron(integrals.mass, unit) @ expansion)
        kept = np.flatnonzero((mass.diagonal() > 0) & ~fixed.ravel())
        expansion = csr_matrix(expansion[:, kept])
        coupling = kron(integrals.coupling, unit) @ across.copies.expansion()
        coupling = csr_matrix(expansion.T @ coupling)
        acts = np.repeat(used, self.size).astype(float)
        rows = csr_matrix(expansion.multiply(acts[:, None]))
        rows.eliminate_zeros()
        self._whole = _DofProjection(MassFactor(mass[kept][:, kept]), rows, coupling)

    def blocks(self) -> list[tuple[Integers, Integers, NodalProjection]]:
        """Dofs of the slave and of the master, and P between them: all at once."""
        slave, master = (np.arange(count) for count in self._whole.shape)
        return [(slave, master, self._whole)]

    def apply(self, values: Array) -> Array:
        """P v, (slave nodes, components, ...), of values (master nodes, components, ...)."""
        found = self._whole.apply(values.reshape(-1, *values.shape[2:]))
        return found.reshape(-1, *values.shape[1:])

    def transposed(self, forces: Array) -> Array:
        """Pᵀ f, (master nodes, components, ...), of forces (slave nodes, components, ...)."""
        found = self._whole.transposed(forces.reshape(-1, *forces.shape[2:]))
        return found.reshape(-1, *forces.shape[1:])


class FoldedOnRanks:
    """The same of this rank's nodes; collective, as all.

    Args:
        whole: P of the whole surfaces, which every rank holds.
        slave: The slave surface.
        master: The master surface.
    """

    def __init__(self, whole: Projection, slave: SurfaceSpace, master: SurfaceSpace) -> None:
        self._whole, self._slave, self._master = whole, slave, master

    def apply(self, values: Array) -> Array:
        """P v, (own slave nodes, components, ...), of values at own master nodes."""
        found = self._whole.apply(gather_rows(self._slave.comm, values))
        return found[self._slave.numbers[: self._slave.owned_nodes]]

    def transposed(self, forces: Array) -> Array:
        """Pᵀ f, (own master nodes, components, ...), of forces at own slave nodes."""
        found = self._whole.transposed(gather_rows(self._slave.comm, forces))
        return found[self._master.numbers[: self._master.owned_nodes]]

    def destroy(self) -> None:
        """Nothing: it has no objects of PETSc."""
