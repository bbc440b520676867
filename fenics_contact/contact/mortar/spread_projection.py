"""The mortar projection P = D⁻¹ M spread over the ranks: each has the rows of its own slave nodes.

D and M are sparse matrices of PETSc, in the order of the surfaces' nodes; MUMPS factorises D. So
what a rank holds grows with its own part of the surfaces. Python frees such objects on each rank
when it likes, PETSc on all together when it is asked to: each new projection does, by a
communicator that they all share.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from petsc4py import PETSc
from scipy.sparse import coo_matrix, csr_matrix

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import FenicsContactError
from fenics_contact.common.parallel import gather_rows, lasting, total
from fenics_contact.contact.mortar.folded_projection import (
    AcrossCut,
    FoldedOnRanks,
    FoldedProjection,
)
from fenics_contact.contact.mortar.projection import MortarIntegrals, Projection
from fenics_contact.contact.surface.space import SurfaceSpace


@dataclass(frozen=True, eq=False)
class SlaveRows:
    """Mortar integrals over the slave facets of one rank, and which nodes take part.

    Attributes:
        slave: The slave surface; its nodes are those of this rank, owned and ghost.
        master: The master surface.
        integrals: Of this rank's facets: (nodes of this rank, all nodes of the master and of its
            copies).
        fixed: Nodes taken out of the mortar space, where P is 0, (nodes of this rank, components).
        used: Nodes whose rows are kept; the others' are 0, (nodes of this rank,).
        across: How both go on beyond the cut of a sector.
    """

    slave: SurfaceSpace
    master: SurfaceSpace
    integrals: MortarIntegrals
    fixed: Flags
    used: Flags
    across: AcrossCut

    def gathered(self) -> Projection | FoldedProjection:
        """P of the whole surfaces, on every rank; collective."""
        fixed, used = self.slave.gathered(self.fixed), self.slave.gathered(self.used)
        if self.across.rim is None and not self.crosses_cut:
            return Projection.between(self.whole_integrals(), fixed, used)
        return FoldedProjection(self._with_copies(), fixed, used, self.across)

    def whole_integrals(self) -> MortarIntegrals:
        """Those of the whole surfaces, without shares of facets, on every rank; collective.

        Of scalars: a node of the master and its copies have the same value.
        """
        whole = self._with_copies()
        return replace(whole, coupling=self.across.copies.summed(whole.coupling))

    def _with_copies(self) -> MortarIntegrals:
        """Integrals of the whole surfaces, with a column for each node of each copy of the master.

        On every rank; collective.
        """
        count = self.slave.space.dofmap.index_map.size_global
        mass = self._whole(self.integrals.mass.tocoo(), self.slave.numbers, count)
        count = self.integrals.coupling.shape[1]
        coupling = self._whole(self.integrals.coupling.tocoo(), np.arange(count), count)
        return MortarIntegrals(mass, coupling, np.zeros(0))

    def on_ranks(self) -> SpreadProjection | FoldedOnRanks:
        """P at the nodes of each rank; collective."""
        if self.across.rim is None and not self.crosses_cut:
            return SpreadProjection(self._without_copies())
        return FoldedOnRanks(self.gathered(), self.slave, self.master)

    def _without_copies(self) -> SlaveRows:
        """Rows with the columns of the master in this sector alone, where no slave faces a copy."""
        own = self.integrals.coupling[:, : self.across.copies.count]
        return replace(self, integrals=replace(self.integrals, coupling=csr_matrix(own)))

    @cached_property
    def crosses_cut(self) -> bool:
        """Whether the slave faces the master of another sector; collective when first asked for."""
        beyond = int((self.integrals.coupling.indices >= self.across.copies.count).sum())
        return int(total(self.slave.comm, beyond)) > 0

    def coupled_masters(self) -> Flags:
        """Nodes of the whole master that move any slave node not fixed; collective."""
        free = np.flatnonzero(~self.fixed.all(axis=1))
        coupling = self.integrals.coupling
        found = np.bincount(coupling[free].indices, minlength=coupling.shape[1])
        return self.across.copies.of_any(np.asarray(total(self.slave.comm, found) > 0))

    def _whole(self, own: coo_matrix, columns: Integers, count: int) -> csr_matrix:
        """The sum of all ranks' matrices, with the rows of the whole slave, and so many columns."""
        comm, size = self.slave.comm, self.slave.space.dofmap.index_map.size_global
        places = gather_rows(comm, self.slave.numbers[own.row]), gather_rows(comm, columns[own.col])
        return csr_matrix((gather_rows(comm, own.data), places), shape=(size, count))


class _Component:
    """P of one component; collective.

    Args:
        rows: The integrals.
        fixed: Nodes taken out of the mortar space, (nodes of this rank,).
    """

    def __init__(self, rows: SlaveRows, fixed: Flags) -> None:
        slave, owned = rows.slave, rows.slave.owned_nodes
        diagonal = slave.summed(rows.integrals.mass.diagonal()[:, None])[:, 0]
        active = (diagonal > 0) & ~fixed
        # Nodes at the border of the covered part have little mass.
        scale = np.where(active, 1 / np.sqrt(np.where(active, diagonal, 1.0)), 0.0)
        mass = rows.integrals.mass.tocoo()
        alone = np.flatnonzero(~active[:owned])
        entries = (
            np.concatenate([mass.data * scale[mass.row] * scale[mass.col], np.ones(len(alone))]),
            np.concatenate([mass.row, alone]),
            slave.numbers[np.concatenate([mass.col, alone])],
        )
        self._mass = _assembled(slave, slave, *entries)
        coupling = rows.integrals.coupling.tocoo()
        scaled = coupling.data * scale[coupling.row]
        self._coupling = _assembled(slave, rows.master, scaled, coupling.row, coupling.col)
        self._kept = np.where(rows.used, scale, 0.0)[:owned]
        self._given, self._found = self._mass.createVecs()
        self._opposite = self._coupling.createVecRight()
        self._factor = self._factorised()

    def _factorised(self) -> PETSc.PC:
        factor, error = mumps.factorised(self._create_factor)
        if error is not None:
            code = factor.getFactorMatrix().getMumpsInfog(1)
            raise FenicsContactError(
                f"MUMPS could not factorise the mass matrix of a contact surface: INFOG(1) = {code}"
            )
        return factor

    def _create_factor(self, spare: int) -> PETSc.PC:
        factor = PETSc.PC().create(self._mass.comm)
        factor.setOperators(self._mass)
        factor.setType("lu")
        factor.setFactorSolverType("mumps")
        factor.setFactorSetUpSolverType()
        factor.getFactorMatrix().setMumpsIcntl(14, spare)
        return factor

    def apply(self, values: Array) -> Array:
        """P v, (own slave nodes,), of values (own master nodes,); collective."""
        with self._opposite as array:
            array[:] = values
        self._coupling.mult(self._opposite, self._given)
        self._factor.apply(self._given, self._found)
        return np.asarray(self._kept * self._found.array_r)

    def transposed(self, forces: Array) -> Array:
        """Pᵀ f, (own master nodes,), of forces (own slave nodes,); collective."""
        with self._given as array:
            array[:] = self._kept * forces
        self._factor.applyTranspose(self._given, self._found)
        self._coupling.multTranspose(self._found, self._opposite)
        return np.array(self._opposite.array_r)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (
            self._factor,
            self._mass,
            self._coupling,
            self._given,
            self._found,
            self._opposite,
        ):
            thing.destroy()


class SpreadProjection:
    """P between displacements: one for each of their components, which do not mix; collective.

    Args:
        rows: The mortar integrals of this rank.
    """

    def __init__(self, rows: SlaveRows) -> None:
        PETSc.garbage_cleanup(lasting(rows.slave.comm))
        self._components: list[_Component] = []
        made: list[tuple[Flags, _Component]] = []
        for fixed in rows.fixed.T:
            same = [one for other, one in made if not _differ(rows.slave, other, fixed)]
            component = same[0] if same else _Component(rows, fixed)
            made.append((fixed, component))
            self._components.append(component)

    def apply(self, values: Array) -> Array:
        """P v, (own slave nodes, components, ...), of values (own master nodes, components, ...).

        Collective.
        """
        return _by_columns([one.apply for one in self._components], values)

    def transposed(self, forces: Array) -> Array:
        """Pᵀ f, (own master nodes, components, ...), of forces likewise at own slave nodes.

        Collective.
        """
        return _by_columns([one.transposed for one in self._components], forces)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for component in dict.fromkeys(self._components):
            component.destroy()


def _differ(surface: SurfaceSpace, one: Flags, other: Flags) -> bool:
    return bool(total(surface.comm, int((one != other).sum())) > 0)


def _assembled(
    rows_of: SurfaceSpace, columns_of: SurfaceSpace, values: Array, row: Integers, column: Integers
) -> PETSc.Mat:
    """A matrix from entries of all ranks, which add up; collective.

    Args:
        rows_of: Whose nodes are the rows.
        columns_of: Whose nodes are the columns.
        values: Of this rank.
        row: Nodes of this rank.
        column: Numbers of nodes on the whole surface.
    """
    sizes = (
        (rows_of.owned_nodes, PETSc.DETERMINE),
        (columns_of.owned_nodes, PETSc.DETERMINE),
    )
    matrix = PETSc.Mat().create(lasting(rows_of.comm))
    matrix.setSizes(sizes)
    matrix.setType("aij")
    matrix.setUp()
    shape = (len(rows_of.coordinates), matrix.getSize()[1])
    local = csr_matrix(coo_matrix((values, (row, column)), shape=shape))
    matrix.setValuesIJV(
        local.indptr.astype(PETSc.IntType),
        local.indices.astype(PETSc.IntType),
        local.data,
        addv=PETSc.InsertMode.ADD_VALUES,
        rowmap=rows_of.numbers.astype(PETSc.IntType),
    )
    matrix.assemble()
    return matrix


def _by_columns(products: Sequence[Callable[[Array], Array]], values: Array) -> Array:
    """Products with values (nodes, components, ...), by the component."""
    flat = values.reshape(*values.shape[:2], int(np.prod(values.shape[2:], dtype=np.int64)))
    found = [
        [product(np.ascontiguousarray(column)) for column in flat[:, axis].T]
        for axis, product in enumerate(products)
    ]
    # (components, columns, nodes) as (nodes, components, columns)
    return np.moveaxis(np.array(found), 2, 0).reshape(-1, *values.shape[1:])
