"""The body's tangent about a displacement, factorised and condensed onto the contact dofs."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness


class TangentBody:
    """K = D²Ψ of the problem's present displacement, its factor and its Schur complement.

    Args:
        problem: The model, whose displacement function holds the state; collective.
        dofs: The contact dofs.

    Raises:
        MachineError: There is not the memory for the factorisation; on every rank.
        NotConvergedError: The tangent is singular; likewise.
    """

    def __init__(self, problem: Problem, dofs: ContactDofs) -> None:
        self._problem = problem
        self._stiffness = LocalStiffness(problem.discrete)
        self._held = self._stiffness.held(dofs.constrained)
        self._bulk = CondensedBulk(self._stiffness, self._held, dofs.free)
        self._load = np.zeros(0)

    @property
    def schur(self) -> Array | None:
        """S of the free contact dofs, on rank 0; None on others."""
        return self._bulk.schur

    def negative_eigenvalues(self) -> int | None:
        """Negative eigenvalues of K with contact dofs held, or None if unknown; collective."""
        return self._bulk.negative_eigenvalues()

    def condense(self, forces: Array, supported: Array) -> Array:
        """Forces on the free contact dofs, on rank 0; collective.

        Args:
            forces: Out of balance, at the nodes of this rank, (nodes, components) (force).
            supported: How far supports have yet to move, 0 elsewhere, likewise (length).
        """
        self._load = self._stiffness.load(forces, supported, self._held)
        return self._bulk.condense(self._load)

    def round_off(self, displacement: Array) -> float:
        """Round-off of internal forces at a displacement; collective (force).

        Args:
            displacement: At the nodes of this rank, (nodes, components) (length).
        """
        return self._stiffness.round_off(self._stiffness.at_unknowns(displacement))

    def expand(self, change: Array) -> Array:
        """Change of all displacements under what was condensed last; collective (length).

        Args:
            change: Of the free contact dofs; used on rank 0.
        """
        return self._stiffness.at_nodes(self._bulk.expand(self._load, change))

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._bulk.destroy()
