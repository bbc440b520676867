"""Balance of forces of a large body, with a zone at the contacts that is solved by itself.

K is assembled once and never factorised or copied; the tangent K + K_c is only applied, K_c being
a matrix of the contacts alone.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import (
    apart,
    is_part_free,
    null_space,
    rigid_fields,
)
from fenics_contact.solve.iterative.contact_matrix import ContactMatrix
from fenics_contact.solve.iterative.contact_zone import (
    CarriedSlaves,
    ContactZone,
    beside,
    free_dofs,
    masters,
    on_contacts,
    touching,
)
from fenics_contact.solve.systems.bulk_matrix import assembled
from fenics_contact.solve.systems.full_system import BodySystem

# K's entries are looked at in so many parts, as Python would copy all of them.
_PARTS = 128


class ZonedSystem(BodySystem):
    """Balance of forces with K applied; the other attributes are those of ``System``.

    Attributes:
        zone: The cells at the contacts, for the preconditioner.
        surface: Their nodes alone, for what is nonlinear.
        contacts: K_c.
        stiffness: K with supports cleared, and with springs where contacts alone hold a body.
        free_motions: Rigid motions of each body that no support holds, at this rank's own
            displacement dofs, a column each (dofs, motions).
    """

    def __init__(self, problem: Problem, timings: Timings) -> None:
        super().__init__(problem)
        with timings.phase("assemble"):
            self._assemble()
        with timings.phase("factorise"):
            self._set_up()
        self._column_sums: Array | None = None

    def _assemble(self) -> None:
        """K with supports cleared, and its rows of supports for their forces."""
        stiffness = assembled(self.problem.elastic.stiffness)
        self.stiffness = stiffness
        first = stiffness.getOwnershipRange()[0]
        held = (first + self.held).astype(PETSc.IntType)
        rows = PETSc.IS().createGeneral(held, comm=self.comm)
        every = PETSc.IS().createStride(self._owned_size, first, 1, comm=self.comm)
        self._support_rows = stiffness.createSubMatrix(rows, every)
        rows.destroy()
        every.destroy()
        self._inner, self._outer = stiffness.createVecs()
        self._prescribed = self._support_rows.createVecLeft()
        stiffness.getDiagonal(self._inner)
        # An entry as any other: multigrid is not to see supports as soft or stiff.
        self._diagonal = self._inner.sum() / max(self._inner.getSize(), 1)
        self.contacts = ContactMatrix(self.problem, stiffness, self._diagonal)
        stiffness.zeroRowsColumns(held, diag=self._diagonal)

    def _set_up(self) -> None:
        problem, spaces = self.problem, self.problem.spaces
        _, fields = rigid_fields(spaces)
        self._on_contacts, self._masters = on_contacts(problem), masters(problem)
        self._carried = CarriedSlaves(problem, self.contacts)
        of_parts = self._owned_columns(apart(spaces.parts, fields))
        self._add_springs(of_parts)
        self._place_zone()
        self.residual = self.contacts.matrix.createVecLeft()
        self.state, self._work = self.residual.duplicate(), self.residual.duplicate()
        sizes = self.contacts.matrix.getSizes()
        self.tangent = PETSc.Mat().createPython(sizes, _Tangent(self), comm=self.comm)
        self.tangent.setUp()
        is_free = np.repeat(is_part_free(problem), fields.shape[-1])
        self.free_motions = of_parts[:, is_free]

    def _owned_columns(self, fields: Array) -> Array:
        """Nodal fields (nodes, components, modes) as columns at this rank's own dofs."""
        owned = fields[: self.problem.spaces.owned_nodes]
        return owned.reshape(self._owned_size, fields.shape[-1])

    def _place_zone(self) -> None:
        """A zone around what touches, with its neighbours, which may touch next.

        Around whole contacts where multigrid has springs there, which are to be taken off.
        """
        near = self._on_contacts
        if not self._is_sprung:
            near = near & beside(self.problem, touching(self.problem))
        self._near = near
        # Masters are held: what is as stiff as the penalty is the jump, which slaves can close.
        inside = near | (beside(self.problem, near) & ~self._masters)
        self.zone = self._zone_of(inside, self.contacts.scalars)
        # Scalars are held: an obstacle under a force, or a resultant of a half-space, moves more
        # than what settling may follow.
        self.surface = self._zone_of(near, 0)

    def _zone_of(self, nodes: Flags, scalars: int) -> ContactZone:
        return ContactZone(
            self.problem, self.stiffness, self.contacts, nodes, self._springs, scalars
        )

    def follow_contacts(self) -> None:
        """Move the zone where something touches outside it; collective."""
        outside = touching(self.problem) & ~self._near
        if total(self.comm, int(outside.sum())) > 0:
            self._move_zone()

    def _move_zone(self) -> None:
        self.zone.destroy()
        self.surface.destroy()
        self._place_zone()

    def _add_springs(self, rigid: Array) -> None:
        """Springs at the contacts in multigrid's K where supports do not hold every body.

        As stiff as the cells there; all else takes them off again.
        """
        self._springs = np.zeros(self._owned_size)
        held = rigid[self.held]
        loose = null_space(np.asarray(total(self.comm, held.T @ held)))
        self._is_sprung = loose.shape[1] > 0
        if not self._is_sprung:
            return
        dofs = free_dofs(self.problem, self._on_contacts | self._masters)
        self.stiffness.getDiagonal(self._inner)
        self._springs[dofs] = self._inner.array_r[dofs]
        with self._inner as array:
            array[:] += self._springs
        self.stiffness.setDiagonal(self._inner)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (
            self.zone,
            self.surface,
            self.contacts,
            self.tangent,
            self.stiffness,
            self._support_rows,
            self._prescribed,
            self._inner,
            self._outer,
            self.state,
            self.residual,
            self._work,
        ):
            thing.destroy()

    def linearise(self, state: PETSc.Vec, springs: float = 0.0) -> None:
        """K_c of a state; collective. Bodies that nothing holds have their own way here."""
        self.take(state)
        self.linearise_contacts()

    def linearise_contacts(self) -> None:
        """K_c of the state that was taken last; collective."""
        for contact in self.problem.contacts:
            contact.follow()
        self.contacts.linearise()

    def internal_forces(self, state: PETSc.Vec, forces: PETSc.Vec) -> None:
        """Forces of the bulk, also where supports hold; and on its scalars; collective."""
        held = self.held
        with self._inner as array:
            array[:] = state.array_r[: self._owned_size]
            with self._prescribed as values:
                values[:] = array[held]
            array[held] = 0.0
        self._bulk_forces()
        self._support_rows.multTransposeAdd(self._prescribed, self._outer, self._outer)
        with self._inner as array:
            array[held] = self._prescribed.array_r
        self._support_rows.mult(self._inner, self._prescribed)
        with forces as array:
            array[:] = 0.0
            array[: self._owned_size] = self._outer.array_r
            array[held] = self._prescribed.array_r
        self._add_scalars(state, forces)

    def _add_scalars(self, state: PETSc.Vec, forces: PETSc.Vec) -> None:
        """Forces of the body's scalars on it, and in their rows those on them; collective."""
        if not self.problem.body_scalars:
            return
        values = self.problem.of_body_scalars(self.scalar_values(state))
        every = [scalar.forces_on_body for scalar in self.problem.body_scalars]
        nodal = [one.nodal.reshape(-1)[: self._owned_size] for one in every]
        moved = state.array_r[: self._owned_size]
        on_scalars = total(self.comm, np.array([float(one @ moved) for one in nodal]))
        on_scalars += self.problem.elastic.scalar_stiffness @ values
        with forces as array:
            for one, value in zip(nodal, values, strict=True):
                array[: self._owned_size] += value * one
            if self.comm.rank == 0:
                array[-len(on_scalars) :] = on_scalars

    def _bulk_forces(self) -> None:
        """K, supports cleared and without springs, times ``_inner`` into ``_outer``."""
        self.stiffness.mult(self._inner, self._outer)
        with self._outer as array:
            array -= self._springs * self._inner.array_r

    def apply_tangent(self, vector: PETSc.Vec, result: PETSc.Vec) -> None:
        """(K + K_c) times a vector of all unknowns; collective."""
        self.contacts.mult(vector, result)
        with self._inner as array:
            array[:] = vector.array_r[: self._owned_size]
        self._bulk_forces()
        with result as array:
            array[: self._owned_size] += self._outer.array_r

    def solve_zone(self, left: Array) -> Array:
        """Increment that leaves no forces as stiff as 1/ε₁ in the zone, all else held; collective.

        It balances them, but where masters in the zone carry their slaves with them.
        """
        if not self._carried.are_any:
            return self.zone.solve(left)
        places, size = self.zone.places, self._owned_size
        mine = places < size
        inside = np.zeros(size, dtype=bool)
        inside[places[mine]] = True
        whole, collected = np.zeros(size), left.copy()
        whole[places[mine]] = left[mine]
        collected[mine] = self._carried.collect(whole, inside)[places[mine]]
        found = self.zone.solve(collected)
        whole[places[mine]] = found[mine]
        found[mine] = self._carried.carry(whole, inside)[places[mine]]
        return found

    def update_pairing(self) -> None:
        """Update the zone and the carried slaves; tangents see it by themselves; collective."""
        self._carried = CarriedSlaves(self.problem, self.contacts)
        self._on_contacts = on_contacts(self.problem)
        self._move_zone()

    def tie(self, change: PETSc.Vec) -> None:
        """Let constrained dofs change as scalars prescribe, or not at all; collective.

        Exactly, as the balance of forces does not see their rows.
        """
        values = np.zeros(self._owned_size)
        scalars = self.scalar_values(change)
        for unknown, value in zip(self.problem.unknowns, scalars, strict=True):
            if unknown.prescribes is not None:
                dofs, moved = unknown.prescribes.owned(self._owned_size)
                values[dofs] += value * moved
        held = self.held
        with change as array:
            array[held] = values[held]

    def round_off(self) -> float:
        """20 × machine epsilon × ‖|K + K_c| |u|‖₁; collective."""
        if self._column_sums is None:
            self._column_sums = self._sums()
        lengths = np.abs(self.state.array_r[: self._owned_size])
        inside = total(self.comm, self._column_sums @ lengths)
        return self.contact_round_off() + float(20 * np.finfo(float).eps * inside)

    def contact_round_off(self) -> float:
        """The part of K_c in ``round_off``; collective."""
        lengths = self.state.duplicate()
        self.state.copy(lengths)
        lengths.abs()
        self.contacts.magnitude(lengths, self._work)
        lengths.destroy()
        left = total(self.comm, self._work.array_r[: self._owned_size].sum())
        return float(20 * np.finfo(float).eps * left)

    def _sums(self) -> Array:
        """Σ |K_ij| over a column, which for K is that over a row."""
        first = self.stiffness.getOwnershipRange()[0]
        every = PETSc.IS().createStride(self._owned_size, first, 1, comm=self.comm)
        found = []
        for part in np.array_split(np.arange(self._owned_size), _PARTS):
            rows = PETSc.IS().createGeneral((first + part).astype(PETSc.IntType), comm=self.comm)
            matrix = self.stiffness.createSubMatrix(rows, every)
            starts, _, values = matrix.getValuesCSR()
            sums = np.concatenate([[0.0], np.cumsum(np.abs(values))])
            found.append(sums[starts[1:]] - sums[starts[:-1]])
            matrix.destroy()
            rows.destroy()
        every.destroy()
        return np.concatenate(found)


class _Tangent:
    """K + K_c as PETSc sees it."""

    def __init__(self, system: ZonedSystem) -> None:
        self._system = system

    def mult(self, matrix: PETSc.Mat, vector: PETSc.Vec, result: PETSc.Vec) -> None:
        self._system.apply_tangent(vector, result)
