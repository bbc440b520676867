"""Rigid motions of bodies that no support holds, solved for by themselves before each V-cycle.

Only contacts hold such a body. Multigrid for the bulk sees springs in their place, and what
slipping friction and soft neighbours leave of its stiffness is far less than these. So its rigid
motions are a coarse space of their own. Each is taken with the zone at the contacts settled, as
the penalty makes a body that moves by itself far too stiff. With Z their columns and A the
tangent, the preconditioner M becomes

    P = M (1 - A Q) + Q,    Q = Z (Zᵀ A Z)⁺ Zᵀ

(A-DEF1 in Tang, Nabben, Vuik and Erlangga 2009, J. Sci. Comput. 39, 340-370). M comes last, so
that P leaves no forces where M leaves none.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total

# Singular values of Zᵀ A Z below this share of the largest are motions that nothing resists.
_NOTHING = 1e-12


class FreeBodies:
    """The coarse space of the rigid motions of bodies without supports.

    Attributes:
        are_any: Whether there is such a body.

    Args:
        comm: Of the model.
        motions: Rigid motions at this rank's own displacement dofs, (dofs, motions).
        apply_tangent: A times a vector into another one; collective.
        settle: Takes forces, and moves the zone of a displacement so that it has none there;
            collective.
        template: A vector of all unknowns.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        motions: Array,
        apply_tangent: Callable[[PETSc.Vec, PETSc.Vec], None],
        settle: Callable[[PETSc.Vec, PETSc.Vec], None],
        template: PETSc.Vec,
    ) -> None:
        self._comm = comm
        self._rigid = motions
        self._apply_tangent, self._settle = apply_tangent, settle
        self._moved, self._forces = template.duplicate(), template.duplicate()
        self.are_any = motions.shape[1] > 0
        self._inverse: Array | None = None

    def forget(self) -> None:
        """The tangent has changed."""
        self._inverse = None

    def take_out(self, right: PETSc.Vec) -> Array:
        """Motions that balance forces on the free bodies, taken out of the right side; collective.

        Args:
            right: Forces r; r − A Q r afterwards.

        Returns:
            How far each motion goes, (motions,).
        """
        if self._inverse is None:
            self._linearise()
        on_bodies = total(self._comm, self._motions.T @ right.array_r)
        shares: Array = self._inverse @ on_bodies
        with right as array:
            array -= self._stiffness @ shares
        return shares

    def add(self, shares: Array, solution: PETSc.Vec) -> None:
        """Add the motions to displacements."""
        with solution as array:
            array += self._motions @ shares

    def _linearise(self) -> None:
        """Z with the zone settled, A Z and the inverse of Zᵀ A Z; collective."""
        owned = len(self._rigid)
        motions, forces = [], []
        for motion in self._rigid.T:
            with self._moved as array:
                array[:] = 0.0
                array[:owned] = motion
            self._apply_tangent(self._moved, self._forces)
            self._settle(self._forces, self._moved)
            self._apply_tangent(self._moved, self._forces)
            motions.append(self._moved.array_r.copy())
            forces.append(self._forces.array_r.copy())
        self._motions, self._stiffness = np.column_stack(motions), np.column_stack(forces)
        coarse = np.asarray(total(self._comm, self._motions.T @ self._stiffness))
        self._inverse = np.linalg.pinv(coarse, rcond=_NOTHING)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._moved.destroy()
        self._forces.destroy()
