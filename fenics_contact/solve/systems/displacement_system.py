"""Every displacement of the body as an unknown, however its equations are then solved."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.body_answer import BodyAnswer, FindBody
from fenics_contact.solve.systems.system import System


class BodySystem(System):
    """Balance of forces on every free displacement; the attributes are those of ``System``."""

    _work: PETSc.Vec  # a vector of unknowns to work in

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        spaces = problem.spaces
        self._owned_size = spaces.owned_nodes * spaces.components
        constrained = problem.constrained
        self.held = constrained[constrained < self._owned_size]
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
        """Itself."""
        return displacement

    def begin_at(self, position: Array) -> None:
        """Start from nodal displacements, supports at their values; collective."""
        self._started = position.reshape(-1).copy()
        self.state.set(0.0)
        owned = self.problem.constrained < self._owned_size
        with self.state as array:
            array[: self._owned_size] = self._started[: self._owned_size]
            array[self.held] = self.problem.prescribed[owned]
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
        self.hold_scalars()
        self.take(self.state)

    def update_pairing(self) -> None:
        """Tangents see it by themselves."""

    def take(self, state: PETSc.Vec) -> None:
        """A vector of unknowns into the displacement function and the jumps; collective."""
        function = self.problem.displacement.x
        function.array[: self._owned_size] = state.array_r[: self._owned_size]
        function.scatter_forward()
        displacement = self._nodal_displacement()
        at_surfaces = [
            contact.kinematics.relative(displacement) for contact in self.problem.contacts
        ]
        self.move_contacts(at_surfaces, self.scalar_values(state))

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
        found = BodyAnswer(self._nodal_displacement().copy(), forces)
        return lambda: found
