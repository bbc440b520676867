"""The parts of the tangent that contacts and scalar unknowns add to the bulk's matrix."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy.sparse import coo_matrix

from fenics_contact.body.preloaded_part import ScalarForces
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.parallel import gather_rows
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import ScalarUnknown
from fenics_contact.solve.systems.contact_stiffness import Entries, PairStiffness, SurfaceMatrix


class AddedTangents:
    """The parts of the tangent besides K: of contacts and scalar unknowns.

    Each rank's rows are its displacements, then its mean stresses; rank 0 has the scalars
    last. A contact's energy depends on the jump w = u − d m, so its tangent K_c in the jump
    gives those in u and d: K_c, −K_c m and mᵀ K_c m. Where a contact reaches displacements that a
    scalar prescribes, as on the outer boundary of a half-space, u follows it, and so do these.

    Attributes:
        scalars: Number of scalar unknowns.
        surfaces: The tangents of the contacts.

    Args:
        problem: The problem.
        displacement: K of the displacements alone, before supports.
    """

    def __init__(self, problem: Problem, displacement: PETSc.Mat) -> None:
        self._problem = problem
        self._unknowns = problem.unknowns
        self.scalars = len(self._unknowns)
        spaces = problem.spaces
        self._owned = spaces.owned_nodes * spaces.components
        self.surfaces = [SurfaceMatrix(contact) for contact in problem.contacts]
        self._first = displacement.getOwnershipRange()[0]
        self._column_of: Callable[[Integers], Integers] | None = None
        self._prescribed_forces = [self._prescribed_force(displacement, u) for u in self._unknowns]
        self._motions = [[self._motion(s, u) for u in self._unknowns] for s in self.surfaces]

    def _place(self, displacement: PETSc.Mat, layout: PETSc.Mat) -> None:
        """Number displacements as a matrix of all unknowns does."""
        starts = displacement.getOwnershipRangesColumn()
        shifts = layout.getOwnershipRangesColumn()[:-1] - starts[:-1]

        def column_of(columns: Integers) -> Integers:
            owners = np.searchsorted(starts, columns, side="right") - 1
            return np.asarray(columns + shifts[owners])

        self._column_of = column_of

    def _border_dofs(self, number: int) -> Integers:
        """Owned displacement dofs that a scalar unknown may be coupled with."""
        unknown = self._unknowns[number]
        first = self._first
        coupled = np.zeros(0, dtype=np.int64)
        for surface, motions in zip(self.surfaces, self._motions, strict=True):
            if surface.contact is unknown.contact or motions[number].any():
                inside = (surface.dofs >= first) & (surface.dofs < first + self._owned)
                coupled = np.union1d(coupled, surface.dofs[inside] - first)
        if unknown.prescribes is not None:
            coupled = np.union1d(coupled, unknown.prescribes.owned(self._owned)[0])
        if unknown.forces_on_body is not None:
            own = unknown.forces_on_body.nodal.reshape(-1)[: self._owned]
            coupled = np.union1d(coupled, np.flatnonzero(own))
        return np.union1d(coupled, np.flatnonzero(self._prescribed_forces[number]))

    def _prescribed_force(self, displacement: PETSc.Mat, unknown: ScalarUnknown) -> Array:
        """K u and −u of the displacements u that a unit of a scalar prescribes, owned dofs."""
        result = np.zeros(self._owned)
        if unknown.prescribes is None:
            return result
        dofs, values = unknown.prescribes.owned(self._owned)
        moved, forces = displacement.createVecs()
        with moved as array:
            array[dofs] = values
        displacement.mult(moved, forces)
        result[:] = forces.array_r
        result[self._problem.constrained[self._problem.constrained < self._owned]] = 0.0
        result[dofs] = -values
        moved.destroy()
        forces.destroy()
        return result

    def add_contacts(self, tangent: PETSc.Mat) -> None:
        """Add the tangents of all contacts' terms to a matrix of the size of K; collective."""
        for surface, motions in zip(self.surfaces, self._motions, strict=True):
            entries = surface.entries()
            if surface.pair is None:
                rows, columns = (self._matrix_rows(surface.dofs[part]) for part in entries[:2])
                add_entries(tangent, rows, columns, entries[2])
            else:
                for numbers, block in surface.pair.rows(self._problem.comm, entries):
                    self._add_rows(tangent, numbers, surface.pair.dofs, block)
            self._add_borders(tangent, surface, motions, entries)

    def _reserve_pairs(self, matrix: PETSc.Mat) -> None:
        """Give a matrix its entries between bodies that touch, zeros."""
        for pair in self._pairs:
            for rows in pair.own_rows():
                self._add_rows(matrix, rows, pair.dofs, np.zeros((len(rows), len(pair.dofs))))

    @property
    def _pairs(self) -> list[PairStiffness]:
        """Tangents between two bodies that exert forces on each other."""
        return [s.pair for s in self.surfaces if s.pair is not None and s.contact.forces.terms]

    def _add_rows(
        self, matrix: PETSc.Mat, rows: Integers, columns: Integers, values: Array
    ) -> None:
        """Add to dense rows, (rows, columns), given by the body's numbers."""
        places = [self._matrix_rows(d).astype(PETSc.IntType) for d in (rows, columns)]
        by_rows = np.ascontiguousarray(values)  # of others petsc4py takes the transpose
        matrix.setValues(*places, by_rows, addv=PETSc.InsertMode.ADD_VALUES)

    def _motion(self, surface: SurfaceMatrix, unknown: ScalarUnknown) -> Array:
        """Derivative of the jump in a scalar unknown, at all dofs of a surface; collective."""
        motion = np.zeros(len(surface.dofs))
        if unknown.prescribes is not None:
            dofs, values = unknown.prescribes.owned(self._owned)
            numbers = self._first + dofs
            shared = np.isin(numbers, surface.dofs)
            comm = self._problem.comm
            numbers = gather_rows(comm, numbers[shared])
            order = np.argsort(surface.dofs)
            places = order[np.searchsorted(surface.dofs, numbers, sorter=order)]
            motion[places] = gather_rows(comm, values[shared])
        elif unknown.moves_obstacle and unknown.contact is surface.contact:
            motion[:] = -unknown.moved_along
        return motion

    def _add_borders(
        self, tangent: PETSc.Mat, surface: SurfaceMatrix, motions: list[Array], entries: Entries
    ) -> None:
        """Add to the scalars' rows and columns, from K_c between dofs of a surface; collective."""
        if not self._unknowns:
            return
        rows, columns, values = entries
        at_rows, at_columns = (self._matrix_rows(surface.dofs[d]) for d in (rows, columns))
        moved = [values * motion[columns] for motion in motions]
        for number, unknown in enumerate(self._unknowns):
            scalar = np.full(1, self._scalar_row(tangent, number), dtype=PETSc.IntType)
            every = np.broadcast_to(scalar, values.shape)
            if motions[number].any():
                add_entries(tangent, at_rows, every, moved[number])
            if unknown.contact is not surface.contact:
                continue
            # K_c is the derivative of −r_c.
            along = -unknown.pushes * unknown.along[rows]
            add_entries(tangent, every, at_columns, values * along)
            for other, by in enumerate(moved):
                column = np.full(1, self._scalar_row(tangent, other), dtype=PETSc.IntType)
                corner = [float(along @ by)]
                tangent.setValues(scalar, column, corner, addv=PETSc.InsertMode.ADD_VALUES)

    def add_forces(self, tangent: PETSc.Mat) -> None:
        """Add the forces of scalars on the body, in their columns and rows; collective."""
        add = PETSc.InsertMode.ADD_VALUES
        for number, unknown in enumerate(self._unknowns):
            forces = unknown.forces_on_body
            if forces is None:
                continue
            scalar = np.array([self._scalar_row(tangent, number)], dtype=PETSc.IntType)
            for dofs, values in self._bulk_columns(forces):
                rows = self._rows(tangent, dofs)
                tangent.setValues(rows, scalar, values, addv=add)
                tangent.setValues(scalar, rows, values, addv=add)
        scalars = self._problem.body_scalars
        if scalars and self._problem.comm.rank == 0:
            last = [number for number, one in enumerate(self._unknowns) if one in scalars]
            rows = np.array([self._scalar_row(tangent, n) for n in last], dtype=PETSc.IntType)
            tangent.setValues(rows, rows, self._problem.elastic.scalar_stiffness, addv=add)

    def add_stops(self, tangent: PETSc.Mat) -> None:
        """Add stops between coupled faces, as they act at present; collective."""
        if self._problem.elastic.joints.has_stops and self._problem.comm.rank == 0:
            first = self.scalars - len(self._problem.body_scalars)
            rows = [self._scalar_row(tangent, n) for n in range(first, self.scalars)]
            places = np.array(rows, dtype=PETSc.IntType)
            add = PETSc.InsertMode.ADD_VALUES
            tangent.setValues(places, places, self._problem.stop_tangent, addv=add)

    def _bulk_columns(self, forces: ScalarForces) -> list[tuple[Integers, Array]]:
        """Rows of this rank that a scalar puts forces on, and the forces of a unit of it."""
        own = forces.nodal.reshape(-1)[: self._owned]
        dofs = np.flatnonzero(own)
        return [(dofs, own[dofs])]

    def held_rows(self, tangent: PETSc.Mat) -> NDArray[np.int32]:
        """Rows of scalars that are held, on rank 0, which has them."""
        held = [i for i, unknown in enumerate(self._unknowns) if unknown.held is not None]
        rows = [self._scalar_row(tangent, i) for i in held if self._problem.comm.rank == 0]
        return np.array(rows, dtype=PETSc.IntType)

    def add_prescribed(self, tangent: PETSc.Mat) -> None:
        """Add each scalar's own factor, and what it does by prescribed displacements; collective.

        Before the constrained rows are cleared, the forces on free dofs; the rows of the
        displacements themselves are set by ``tie_prescribed``.
        """
        add = PETSc.InsertMode.ADD_VALUES
        for number, unknown in enumerate(self._unknowns):
            scalar = np.array([self._scalar_row(tangent, number)], dtype=PETSc.IntType)
            if unknown.own and self._problem.comm.rank == 0:
                tangent.setValues(scalar, scalar, [unknown.own], addv=add)
            if unknown.prescribes is not None:
                forces = self._prescribed_forces[number]
                dofs = np.flatnonzero(forces)
                tangent.setValues(self._rows(tangent, dofs), scalar, forces[dofs], addv=add)

    def tie_prescribed(self, tangent: PETSc.Mat) -> None:
        """Set the rows u − U q = 0 of prescribed displacements, after all were cleared.

        Collective.
        """
        for number, unknown in enumerate(self._unknowns):
            if unknown.prescribes is None:
                continue
            dofs, values = unknown.prescribes.owned(self._owned)
            scalar = np.array([self._scalar_row(tangent, number)], dtype=PETSc.IntType)
            tangent.setValues(self._rows(tangent, dofs), scalar, -values)
        tangent.assemble()

    def _matrix_rows(self, dofs: Integers) -> Integers:
        """Rows of displacements by their global numbers."""
        return dofs if self._column_of is None else self._column_of(dofs)

    def _rows(self, tangent: PETSc.Mat, dofs: AnyIntegers) -> NDArray[np.int32]:
        return np.asarray(tangent.getOwnershipRange()[0] + dofs, dtype=PETSc.IntType)

    def _scalar_row(self, tangent: PETSc.Mat, number: int) -> int:
        """Global row of a scalar: the last ones of rank 0."""
        return int(tangent.getOwnershipRanges()[1]) - self.scalars + number


def add_entries(matrix: PETSc.Mat, rows: AnyIntegers, columns: AnyIntegers, values: Array) -> None:
    """Add entries anywhere in a matrix whose pattern has them."""
    used, index = np.unique(rows, return_inverse=True)
    compact = coo_matrix((values, (index, columns)), shape=(len(used), matrix.getSize()[1])).tocsr()
    matrix.setValuesIJV(
        compact.indptr.astype(PETSc.IntType),
        compact.indices.astype(PETSc.IntType),
        compact.data,
        addv=PETSc.InsertMode.ADD_VALUES,
        rowmap=used.astype(PETSc.IntType),
    )
