"""The system of a problem in finite strains: every displacement, about which all is measured."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from petsc4py import PETSc

from fenics_contact.body.finite.hyperelastic_body import HyperelasticBody
from fenics_contact.common.arrays import Array
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_system import acting_sides
from fenics_contact.solve.finite.nested_solver import NestedSolver
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.solution import BodyAnswer, FindBody
from fenics_contact.solve.systems.system import System

# Round-off of internal forces, over the machine's and the sum of their sizes.
_ROUND_OFF = 1e3


class FiniteSystem(System):
    """The displacement of the body, with contacts measured there; solved by ``nested`` alone.

    Attributes:
        nested: Solves load steps.

    Args:
        problem: The problem.
        timings: Seconds so far.
    """

    name = "condensed"
    repeats_cheaply: ClassVar = False

    def __init__(self, problem: Problem, timings: Timings) -> None:
        super().__init__(problem)
        assert isinstance(problem.elastic, HyperelasticBody)
        self._elastic = problem.elastic
        with timings.phase("assemble"):
            dofs = ContactDofs(problem.spaces, problem.constrained, acting_sides(problem))
        self.nested = NestedSolver(problem, dofs, timings)
        self.state = PETSc.Vec().createMPI((0, 0), comm=self.comm)
        self.residual, self.tangent = self.state.duplicate(), PETSc.Mat()

    @property
    def factorisations(self) -> int:  # type: ignore[override]
        """How often the body was factorised."""
        return self.nested.factorisations

    def begin(self, displacement: Array) -> None:
        """Start from the undeformed body; collective."""
        self.begin_at(np.zeros(displacement.size))

    def position(self) -> Array:
        """Displacement at the nodes of this rank, (dofs,) (length)."""
        return np.array(self.problem.displacement.x.array)

    def position_of(self, displacement: Array) -> Array:
        """The position that nodal displacements (nodes, components) have."""
        return displacement.reshape(-1)

    def begin_at(self, position: Array) -> None:
        """Stand at a displacement; collective."""
        self.problem.displacement.x.array[:] = position
        for contact in self.problem.contacts:
            contact.stand_at(position.reshape(self.problem.load.shape))

    def follow_supports(self) -> None:
        """A solve brings supports and obstacles to where they are."""

    def take(self, state: PETSc.Vec) -> None:
        """The displacement is the problem's own."""

    def balance(self, state: PETSc.Vec, residual: PETSc.Vec) -> None:
        """A solve has its own balance."""

    def linearise(self, state: PETSc.Vec, springs: float = 0.0) -> None:
        """A solve has its own tangents."""

    def imbalance(self) -> float:
        """0: ``nested`` solves, and has the imbalance."""
        return 0.0

    def round_off(self) -> float:
        """0: ``nested`` solves, and has the imbalance."""
        return 0.0

    def moved(self) -> float:
        """Largest displacement (length)."""
        return float(np.abs(self.position()).max(initial=0.0))

    @property
    def present_forces(self) -> float:
        """Forces that act, by which an imbalance is judged (force)."""
        return self.nested.forces

    def finish(self) -> FindBody:
        """Return the present answer; collective."""
        position = self.position()
        displacement = position.reshape(self.problem.load.shape)
        internal = self._elastic.forces_at(displacement)
        answer = BodyAnswer(displacement, internal, self._round_off())
        return lambda: answer

    def _round_off(self) -> float:
        return _ROUND_OFF * float(np.finfo(float).eps) * self.nested.forces

    def update_pairing(self) -> None:
        """Obstacles are measured where they stand."""

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self.nested.destroy()
        for thing in (self.state, self.residual):
            thing.destroy()

    def prepare(self, snes: PETSc.SNES) -> None:
        """Nothing is solved by PETSc's Newton method."""
