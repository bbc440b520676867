"""All displacements, mean stresses and scalars at once: the reference for other solvers.

The bulk is linear, so its stiffness is assembled once; a Newton step adds only the tangents of
the contacts' terms to a copy of it, and factorises that.
"""

from __future__ import annotations

from functools import cached_property
from typing import ClassVar

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import total
from fenics_contact.common.petsc import mumps
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.body_answer import FindBody
from fenics_contact.solve.systems.bulk_matrix import LinearSystem
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.displacement_system import BodySystem
from fenics_contact.solve.systems.step_springs import free_motions, sprung


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
        self.factorisations = 0
        self._free_motions = free_motions(problem)
        self.is_sprung = bool(self._free_motions)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._system.destroy()
        for thing in (self.tangent, self.state, self.residual, self._work):
            thing.destroy()

    def prepare(self, snes: PETSc.SNES) -> None:
        """Nothing: the options say it all."""

    def linearise(self, state: PETSc.Vec, springs: float = 0.0) -> None:
        """Add the contacts' tangents to a copy of K; collective."""
        self.take(state)
        tangent = self.tangent
        self._system.stiffness.copy(tangent, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        for contact in self.problem.contacts:
            contact.follow()
        self._system.add_contacts(tangent)
        self._system.add_prescribed(tangent)
        if springs:
            for row, stiffness in zip(*self._sprung, strict=True):
                tangent.setValue(row, row, springs * stiffness, addv=PETSc.InsertMode.ADD_VALUES)
        tangent.assemble()
        first, _ = tangent.getOwnershipRange()
        rows = (first + self.held).astype(PETSc.IntType)
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
        self._system.stiffness.mult(state, forces)

    def finish(self) -> FindBody:
        """Displacement and K u at the nodes; the mean stress into its function; collective."""
        self._system.take_mean_stress(self.state)
        return super().finish()
