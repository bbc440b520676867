"""The bulk's matrix in PETSc, with room for what contacts and scalar unknowns add to it."""

from __future__ import annotations

import ctypes

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from fenics_contact.body.preloaded_part import ScalarForces
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.factors.petsc_calls import call
from fenics_contact.common.parallel import gather_rows
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import ScalarUnknown
from fenics_contact.solve.systems.bordered_tangent import AddedTangents


def preallocate_places(matrix: PETSc.Mat, rows: AnyIntegers, columns: AnyIntegers) -> None:
    """Give a matrix the places of ``set_at_places``, one for each entry; collective.

    Args:
        matrix: Without entries yet.
        rows: Of the entries that this rank gives, by their numbers over all ranks; a place may
            come more than once, and be another rank's.
        columns: Likewise.
    """
    # PETSc may overwrite both.
    places = [np.array(numbers, dtype=PETSc.IntType) for numbers in (rows, columns)]
    pointers = [ctypes.c_void_p(numbers.ctypes.data) for numbers in places]
    call("MatSetPreallocationCOO", matrix, ctypes.c_ssize_t(len(rows)), *pointers)


def set_at_places(matrix: PETSc.Mat, values: Array) -> None:
    """Set all entries, in the order of their places; those at one place add up; collective."""
    given = np.ascontiguousarray(values, dtype=np.float64)
    insert = ctypes.c_int(int(PETSc.InsertMode.INSERT_VALUES))
    call("MatSetValuesCOO", matrix, ctypes.c_void_p(given.ctypes.data), insert)


class LinearSystem(AddedTangents):
    """K, assembled once, with room for all that a tangent adds to it.

    Attributes:
        stiffness: K, or [[K, Bᵀ], [B, −C]] with a mean stress, and the forces of scalars on the
            body.
    """

    def __init__(self, problem: Problem) -> None:
        displacement = assembled(problem.elastic.stiffness)
        super().__init__(problem, displacement)
        self._mixed = problem.elastic.mixed
        self._prescribed_volumes: list[Array] = []
        displacement = self._with_neighbours(self._with_opposites(displacement))
        if self._mixed is None and self.scalars == 0:
            self.stiffness = displacement
            return
        blocks = [[displacement]]
        if self._mixed is not None:
            blocks = self._with_mean_stress(displacement)
            divergence = blocks[1][0]
            self._prescribed_volumes = [
                self._prescribed_volume(divergence, u) for u in self._unknowns
            ]
        if self.scalars:
            blocks = self._with_scalars(blocks, displacement)
        nested = PETSc.Mat().createNest(blocks, comm=problem.comm)
        self.stiffness = nested.convert("aij", PETSc.Mat())
        self._place(displacement, self.stiffness)
        self.add_forces(self.stiffness)
        self.stiffness.assemble()
        for matrix in [nested, *(m for row in blocks for m in row if m is not None)]:
            matrix.destroy()

    def destroy(self) -> None:
        """Free the matrix."""
        self.stiffness.destroy()

    def _with_opposites(self, displacement: PETSc.Mat) -> PETSc.Mat:
        """K with room for what couples bodies that touch each other; collective."""
        if not self._pairs:
            return displacement
        sizes, first = displacement.getSizes(), self._first
        counts = np.zeros((2, self._owned), dtype=PETSc.IntType)  # of this rank's columns, others'
        for pair in self._pairs:
            here = np.array([[len(pair.own)], [len(pair.dofs) - len(pair.own)]])
            counts[:, pair.dofs[pair.own] - first] += here.astype(PETSc.IntType)
        counts = np.minimum(counts, [[self._owned], [sizes[1][1] - self._owned]])
        room: PETSc.Mat = PETSc.Mat().createAIJ(sizes, comm=self._problem.comm)
        room.setPreallocationNNZ(tuple(counts.astype(PETSc.IntType)))
        self._reserve_pairs(room)
        room.assemble()
        room.axpy(1.0, displacement, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        displacement.destroy()
        return room

    def _with_neighbours(self, displacement: PETSc.Mat) -> PETSc.Mat:
        """K with room for what couples points of a contact with each other; collective."""
        alone = [s for s in self.surfaces if s.pair is None and s.between_points]
        if not alone:
            return displacement
        every = [(s.dofs[one.rows], s.dofs[one.columns]) for s in alone for one in s.between_points]
        rows, columns = (np.concatenate(part) for part in zip(*every, strict=True))
        room: PETSc.Mat = PETSc.Mat().createAIJ(displacement.getSizes(), comm=self._problem.comm)
        preallocate_places(room, rows, columns)
        set_at_places(room, np.zeros(len(rows)))
        room.axpy(1.0, displacement, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        displacement.destroy()
        return room

    def _with_mean_stress(self, displacement: PETSc.Mat) -> list[list[PETSc.Mat | None]]:
        mixed = self._mixed
        assert mixed is not None
        compressibility = assembled(mixed.compressibility)
        compressibility.scale(-1.0)
        gradient, divergence = assembled(mixed.gradient), assembled(mixed.divergence)
        return [[displacement, gradient], [divergence, compressibility]]

    def _with_scalars(
        self, blocks: list[list[PETSc.Mat | None]], displacement: PETSc.Mat
    ) -> list[list[PETSc.Mat | None]]:
        """Empty rows and columns with room for all that a tangent may put there."""
        comm = self._problem.comm
        own = self.scalars if comm.rank == 0 else 0
        sizes = (own, self.scalars)
        local = [self._border_dofs(k) for k in range(self.scalars)]
        columns = [self._empty_columns(displacement, sizes, local)]
        rows = [self._empty_rows(displacement, sizes, local)]
        if self._mixed is not None:
            stresses = self._coupled_stresses()
            columns.append(self._empty_columns(blocks[1][0], sizes, stresses))
            rows.append(self._empty_rows(blocks[0][1], sizes, stresses))
        corner = PETSc.Mat().createAIJ((sizes, sizes), comm=comm)
        corner.setPreallocationNNZ((self.scalars, self.scalars))
        index = np.arange(self.scalars, dtype=PETSc.IntType)
        if own:
            corner.setValues(index, index, [0.0] * self.scalars**2)
        corner.assemble()
        extended = [[*line, column] for line, column in zip(blocks, columns, strict=True)]
        return [*extended, [*rows, corner]]

    def _coupled_stresses(self) -> list[Integers]:
        """Owned dofs of the mean stress that each scalar is coupled with."""
        found = [np.flatnonzero(volume) for volume in self._prescribed_volumes]
        for number, unknown in enumerate(self._unknowns):
            if (forces := unknown.forces_on_body) is not None:
                own = forces.on_mean_stress[: forces.owned_stresses]
                found[number] = np.union1d(found[number], np.flatnonzero(own))
        return found

    def _bulk_columns(self, forces: ScalarForces) -> list[tuple[Integers, Array]]:
        """Rows of this rank that a scalar puts forces on, those of the mean stress too."""
        own = forces.on_mean_stress[: forces.owned_stresses]
        dofs = np.flatnonzero(own)
        return [*super()._bulk_columns(forces), (self._owned + dofs, own[dofs])]

    def _empty_rows(
        self, line: PETSc.Mat, sizes: tuple[int, int], local: list[Integers]
    ) -> PETSc.Mat:
        """A matrix of the scalars' rows below a block, with room in some of its columns."""
        comm = self._problem.comm
        first = line.getOwnershipRangeColumn()[0]
        gathered = [gather_rows(comm, first + dofs) for dofs in local]
        widest = max((len(dofs) for dofs in gathered), default=0)
        row = PETSc.Mat().createAIJ((sizes, line.getSizes()[1]), comm=comm)
        row.setPreallocationNNZ((widest, widest))
        for k, dofs in enumerate(gathered if sizes[0] else ()):
            number = np.full(1, k, dtype=PETSc.IntType)
            row.setValues(number, dofs.astype(PETSc.IntType), [0.0] * len(dofs))
        row.assemble()
        return row

    def _empty_columns(
        self, line: PETSc.Mat, sizes: tuple[int, int], local: list[Integers]
    ) -> PETSc.Mat:
        """A matrix of a block and the scalars' columns, with room in some of its rows."""
        columns = PETSc.Mat().createAIJ((line.getSizes()[0], sizes), comm=self._problem.comm)
        columns.setPreallocationNNZ((self.scalars, self.scalars))
        first = line.getOwnershipRange()[0]
        for k, dofs in enumerate(local):
            rows = (first + dofs).astype(PETSc.IntType)
            number = np.full(1, k, dtype=PETSc.IntType)
            columns.setValues(rows, number, [0.0] * len(rows))
        columns.assemble()
        return columns

    def _prescribed_volume(self, divergence: PETSc.Mat, unknown: ScalarUnknown) -> Array:
        """Volume changes by displacements that a scalar prescribes, in owned rows."""
        moved, volumes = divergence.createVecs()
        if unknown.prescribes is not None:
            dofs, values = unknown.prescribes.owned(self._owned)
            with moved as array:
                array[dofs] = values
        divergence.mult(moved, volumes)
        found = np.array(volumes.array_r)
        moved.destroy()
        volumes.destroy()
        return found

    def add_prescribed(self, tangent: PETSc.Mat) -> None:
        """Add what scalars do by prescribed displacements, to mean stresses too; collective."""
        super().add_prescribed(tangent)
        add = PETSc.InsertMode.ADD_VALUES
        for number, volume in enumerate(self._prescribed_volumes):
            rows = np.flatnonzero(volume)
            scalar = np.array([self._scalar_row(tangent, number)], dtype=PETSc.IntType)
            places = self._rows(tangent, self._owned + rows)
            tangent.setValues(places, scalar, volume[rows], addv=add)

    def take_mean_stress(self, state: PETSc.Vec) -> None:
        """The mean stress of a state into its function, where there is one."""
        if self._mixed is None:
            return
        function, own = self._mixed.mean_stress, self._own_mean_stress
        function.x.array[: own.stop - own.start] = state.array_r[own]
        function.x.scatter_forward()

    def set_mean_stress(self, state: PETSc.Vec) -> None:
        """The mean stress of its function into a state, where there is one."""
        if self._mixed is None:
            return
        own = self._own_mean_stress
        with state as array:
            array[own] = self._mixed.mean_stress.x.array[: own.stop - own.start]

    @property
    def _own_mean_stress(self) -> slice:
        """This rank's entries of the mean stress in a vector of all unknowns."""
        assert self._mixed is not None
        dofmap = self._mixed.mean_stress.function_space.dofmap
        owned = dofmap.index_map.size_local * dofmap.index_map_bs
        return slice(self._owned, self._owned + owned)


def assembled(form: fem.Form) -> PETSc.Mat:
    """The matrix of a compiled form; collective."""
    from dolfinx.fem import petsc as fem_petsc  # loads a parser of C, which condensing does without

    matrix = fem_petsc.assemble_matrix(form)
    matrix.assemble()
    return matrix
