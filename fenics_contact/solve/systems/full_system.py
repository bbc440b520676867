"""Systems with every displacement as an unknown, and the one that is solved at once.

Solved are displacements, mean stresses and scalars: the reference for other solvers. The bulk is
linear, so its stiffness is assembled once; a Newton step adds only the tangents of the contacts'
terms to a copy of it, and factorises that.
"""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property
from typing import ClassVar

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import largest, total
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.bulk_matrix import LinearSystem
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.cut_transform import SectorTransform
from fenics_contact.solve.systems.solution import BodyAnswer, FindBody
from fenics_contact.solve.systems.system import System, free_motions, sprung


class BodySystem(System):
    """Balance of forces on every free displacement; the attributes are those of ``System``."""

    _work: PETSc.Vec  # a vector of unknowns to work in

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        spaces = problem.spaces
        self._owned_size = spaces.owned_nodes * spaces.components
        constrained = problem.constrained
        self.held = constrained[constrained < self._owned_size]
        self.jumps_across_cut = np.zeros(0, dtype=np.int64)
        self._reactions = 0.0

    @abstractmethod
    def internal_forces(self, state: PETSc.Vec, forces: PETSc.Vec) -> None:
        """Forces of the bulk, also where supports hold; and on the scalars; collective.

        In the rows of the body's scalars these are the forces that do work on them.
        """

    @property
    def present_forces(self) -> float:
        """1-norm of loads, reactions and contact forces at the last residual; collective."""
        return super().present_forces + self._reactions

    def position(self) -> Array:
        """The displacement at the nodes, (nodes, components); collective."""
        return self._nodal_displacement().copy()

    def position_of(self, displacement: Array) -> Array:
        """The system itself."""
        return displacement

    def begin_at(self, position: Array) -> None:
        """Start from nodal displacements, supports at their values; collective."""
        self._started = position.reshape(-1).copy()
        self.state.set(0.0)
        owned = self.problem.constrained < self._owned_size
        with self.state as array:
            array[: self._owned_size] = self._started[: self._owned_size]
            array[self.held] = self.problem.prescribed[owned]
            array[self.jumps_across_cut] = 0.0
            if self.comm.rank == 0 and self.scalars:
                array[-self.scalars :] = self.starting_scalars()

    def follow_supports(self) -> None:
        """Bring supports to their present values, also those that scalars move; collective."""
        problem = self.problem
        values = problem.prescribed.copy()
        scalars = self.scalar_values(self.state)
        for unknown, value in zip(problem.unknowns, scalars, strict=True):
            if (given := unknown.prescribes) is not None:
                moved = np.isin(problem.constrained, given.dofs)
                values[moved] += value * given.displacement
        with self.state as array:
            array[self.held] = values[problem.constrained < self._owned_size]
            array[self.jumps_across_cut] = 0.0
        self.hold_scalars()
        self.take(self.state)

    def update_pairing(self) -> None:
        """Tangents see it by themselves."""

    def take(self, state: PETSc.Vec) -> None:
        """A vector of unknowns into the displacement function and the jumps; collective."""
        function = self.problem.displacement.x
        function.array[: self._owned_size] = self.displacements(state)
        function.scatter_forward()
        scalars = self.scalar_values(state)
        moved = self.problem.moved_by_scalars(self.problem.of_body_scalars(scalars))
        if moved is not None:
            function.array[:] += moved.reshape(-1)
        displacement = self._nodal_displacement()
        at_surfaces = [
            contact.kinematics.relative(displacement) for contact in self.problem.contacts
        ]
        self.move_contacts(at_surfaces, scalars)

    def displacements(self, state: PETSc.Vec) -> Array:
        """Those of this rank's own dofs, of a vector of unknowns; collective."""
        return np.asarray(state.array_r[: self._owned_size])

    def onto_unknowns(self, forces: PETSc.Vec) -> None:
        """Forces on displacements as forces on the unknowns, in place; collective."""

    def _nodal_displacement(self) -> Array:
        """The present displacement, shape (nodes, components), ghosts included."""
        array = self.problem.displacement.x.array
        return np.asarray(array.reshape(-1, self.problem.spaces.components))

    def balance(self, state: PETSc.Vec, residual: PETSc.Vec) -> None:
        """K u − f − r_c(u), and the scalars' rows; collective."""
        self.take(state)
        self.internal_forces(state, residual)
        self._note_scalar_forces(residual.array_r)
        contacts = self.contact_residual(state)
        with residual as array:
            array += contacts
            array[: self._owned_size] -= self.problem.load.reshape(-1)[: self._owned_size]
        self.onto_unknowns(residual)
        with residual as array:
            array[self.jumps_across_cut] = 0.0
            held = np.abs(array[self.held]).sum()
            array[self.held] = 0.0  # they hold their values exactly
            for number in self.held_scalars if self.comm.rank == 0 else ():
                array[len(array) - self.scalars + number] = 0.0
        self._reactions = float(total(self.comm, held))

    def contact_residual(self, state: PETSc.Vec) -> Array:
        """−r_c(u) and the scalars' rows at the jumps last taken, rows of this rank; collective."""
        forces = self.all_contact_forces()
        imbalances = self.scalar_imbalances(self.scalar_values(state), forces)
        found = np.zeros(state.getLocalSize())
        for contact, force in zip(self.problem.contacts, forces, strict=True):
            pushed = contact.kinematics.on_body(force).reshape(-1)
            found[: self._owned_size] -= pushed[: self._owned_size]
        if self.comm.rank == 0 and self.scalars:
            found[-self.scalars :] = imbalances
        return found

    def imbalance(self) -> float:
        """1-norm of the last residual, without rows of mean stresses (force); collective."""
        left = np.abs(self.residual.array_r[: self._owned_size]).sum()
        if self.scalars and self.comm.rank == 0:
            left += np.abs(self.residual.array_r[-self.scalars :]).sum()
        return float(total(self.comm, left))

    def moved(self) -> float:
        """Largest displacement since the start (length); collective."""
        return largest(self.comm, np.abs(self.problem.displacement.x.array - self._started))

    def finish(self) -> FindBody:
        """Return a function that gives displacement and K u at the nodes; collective."""
        spaces = self.problem.spaces
        self.internal_forces(self.state, self._work)
        internal = fem.Function(spaces.displacement_space)
        internal.x.array[: self._owned_size] = self._work.array_r[: self._owned_size]
        internal.x.scatter_forward()
        forces = internal.x.array.reshape(-1, spaces.components).copy()
        found = BodyAnswer(
            self._nodal_displacement().copy(),
            forces,
            mean_stress=self.problem.present_mean_stress(),
        )
        return lambda: found


class FullSystem(BodySystem):
    """Balance of forces on every free displacement; the attributes are those of ``System``."""

    name = "full"
    options: ClassVar = {
        "ksp_type": "preonly",
        "pc_type": "lu",
        "pc_factor_mat_solver_type": mumps.NAME,
    }

    def __init__(self, problem: Problem, timings: Timings) -> None:
        super().__init__(problem)
        with timings.phase("assemble"):
            self._system = LinearSystem(problem)
        self.tangent = self._system.stiffness.duplicate(copy=True)
        self.state, self.residual = self.tangent.createVecs()
        self._work = self.state.duplicate()
        self._transform: SectorTransform | None = None
        if problem.discrete.cut is not None:
            self._eliminate(problem.discrete.cut)
        self.factorisations = 0
        self._free_motions = free_motions(problem)
        self.is_sprung = bool(self._free_motions)

    def _eliminate(self, cut: CutFaces) -> None:
        """Take unknowns by which the cut faces of a sector move alike; collective."""
        self._transform = SectorTransform(cut, self._system.stiffness, self.problem.spaces)
        self.jumps_across_cut = self._transform.slaves
        self._of_displacements = self.tangent  # that of displacements, which forces follow
        self.tangent = self._of_displacements.PtAP(self._transform.matrix)
        self._moved, self._taken = self.state.duplicate(), self.state.duplicate()

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._system.destroy()
        things = [self.tangent, self.state, self.residual, self._work]
        if self._transform is not None:
            things += [self._transform, self._of_displacements, self._moved, self._taken]
        for thing in things:
            thing.destroy()

    def displacements(self, state: PETSc.Vec) -> Array:
        """Those of this rank's own dofs, of a vector of unknowns; collective."""
        return super().displacements(self._all(state))

    def _all(self, state: PETSc.Vec) -> PETSc.Vec:
        """Displacements, mean stresses and scalars of a vector of unknowns; collective."""
        if self._transform is None:
            return state
        self._transform.matrix.mult(state, self._moved)
        return self._moved

    def onto_unknowns(self, forces: PETSc.Vec) -> None:
        """Forces on displacements as forces on the unknowns, in place; collective."""
        if self._transform is not None:
            self._transform.matrix.multTranspose(forces, self._taken)
            self._taken.copy(forces)

    def prepare(self, snes: PETSc.SNES) -> None:
        """Nothing: the options say it all."""

    def linearise(self, state: PETSc.Vec, springs: float = 0.0) -> None:
        """Add the contacts' tangents to a copy of K; collective."""
        self.take(state)
        tangent = self.tangent if self._transform is None else self._of_displacements
        self._system.stiffness.copy(tangent, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        for contact in self.problem.contacts:
            contact.follow()
        self._system.add_contacts(tangent)
        self._system.add_prescribed(tangent)
        self._system.add_stops(tangent)
        if springs:
            for row, stiffness in zip(*self._sprung, strict=True):
                tangent.setValue(row, row, springs * stiffness, addv=PETSc.InsertMode.ADD_VALUES)
        tangent.assemble()
        if self._transform is not None:
            tangent = tangent.PtAP(self._transform.matrix, result=self.tangent)
        first, _ = tangent.getOwnershipRange()
        held = np.union1d(self.held, self.jumps_across_cut)
        rows = (first + held).astype(PETSc.IntType)
        rows = np.concatenate([rows, self._system.held_rows(tangent)])
        tangent.zeroRowsColumns(rows, diag=1.0)
        self._system.tie_prescribed(tangent)
        self.factorisations += 1

    @cached_property
    def _sprung(self) -> tuple[Integers, Array]:
        """Rows of this rank that have a spring in steps, and the stiffness there; collective."""
        problem = self.problem
        dofs = ContactDofs(
            problem.spaces, problem.constrained, [contact.sides for contact in problem.contacts]
        )
        motions = [dofs.gathered(one.reshape(-1))[dofs.is_free] for one in self._free_motions]
        places = dofs.free[sprung(np.array(motions).T)]
        index_map = problem.spaces.displacement_space.dofmap.index_map
        own = places - index_map.local_range[0] * problem.spaces.components
        own = own[(own >= 0) & (own < self._owned_size)]
        first, _ = self.tangent.getOwnershipRange()
        stiffness = self._system.stiffness.getDiagonal().array_r[own]
        return (first + own).astype(PETSc.IntType), stiffness

    def round_off(self) -> float:
        """20 × machine epsilon × ‖|J| |u|‖₁; collective."""
        first, columns, values = self.tangent.getValuesCSR()
        magnitude = PETSc.Mat().createAIJ(
            self.tangent.getSizes(), csr=(first, columns, np.abs(values)), comm=self.comm
        )
        lengths = self.state.duplicate()
        self.state.copy(lengths)
        lengths.abs()
        magnitude.mult(lengths, self._work)
        left = total(self.comm, self._work.array_r[: self._owned_size].sum())
        magnitude.destroy()
        lengths.destroy()
        return float(20 * np.finfo(float).eps * left)

    def set_mean_stress(self) -> None:
        """Start from the mean stress that its function has."""
        self._system.set_mean_stress(self.state)

    def internal_forces(self, state: PETSc.Vec, forces: PETSc.Vec) -> None:
        """K u and what a mean stress and scalars add; collective."""
        self._system.stiffness.mult(self._all(state), forces)

    def finish(self) -> FindBody:
        """Displacement and K u at the nodes; the mean stress into its function; collective."""
        self._system.take_mean_stress(self.state)
        return super().finish()
