"""The preconditioner of the tangent: free bodies as rigid, a V-cycle of the bulk, the zone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Array
from fenics_contact.solve.iterative.free_bodies import FreeBodies

if TYPE_CHECKING:
    from fenics_contact.solve.iterative.iterative_system import IterativeSystem


class Preconditioner:
    """Preconditioner of the tangent, as PETSc asks for it.

    It leaves no forces in the zone. So nothing as stiff as 1/ε₁ is in the residuals of a solve
    that starts without any there, and their norm is one of the body's forces.

    Args:
        system: Whose tangent it is for.
        free_motions: Rigid motions of bodies without supports at this rank's own displacement
            dofs, (dofs, motions).
    """

    def __init__(self, system: IterativeSystem, free_motions: Array) -> None:
        self._system = system
        self._owned_size = len(free_motions)
        self._left, self._work = system.residual.duplicate(), system.residual.duplicate()
        self._inner, self._outer = (self._displacements() for _ in range(2))
        self._free_bodies = FreeBodies(
            system.comm, free_motions, system.apply_tangent, self._settle, system.residual
        )

    def _displacements(self) -> PETSc.Vec:
        return PETSc.Vec().createMPI((self._owned_size, PETSc.DETERMINE), comm=self._system.comm)

    def follow_tangent(self) -> None:
        """The tangent has changed."""
        self._free_bodies.forget()

    def apply(self, _: PETSc.PC, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Displacements that roughly balance forces; collective."""
        if not self._free_bodies.are_any:
            self._cycle(right, solution)
            return
        right.copy(self._left)
        shares = self._free_bodies.take_out(self._left)
        self._cycle(self._left, solution)
        self._free_bodies.add(shares, solution)

    def _cycle(self, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """A V-cycle in the body, then what it leaves in the zone; collective."""
        system, zone = self._system, self._system.zone
        with self._inner as array:
            array[:] = right.array_r[: self._owned_size]
        system.multigrid.apply(self._inner, self._outer)
        with self._outer as array:
            array[system.held] = 0.0
        with solution as array:
            array[:] = 0.0
            array[: self._owned_size] = self._outer.array_r
        left = right.array_r[zone.places] - self._forces_in_zone(solution)
        correction = system.solve_zone(left)
        with solution as array:
            array[zone.places] += correction
        system.tie(solution)

    def _settle(self, forces: PETSc.Vec, moved: PETSc.Vec) -> None:
        """Move the zone so that what forces it feels are gone; collective."""
        places = self._system.zone.places
        correction = self._system.solve_zone(-forces.array_r[places])
        with moved as array:
            array[places] += correction

    def _forces_in_zone(self, solution: PETSc.Vec) -> Array:
        """(K + K_c) times displacements of ``_outer``, in the zone."""
        system = self._system
        system.contacts.mult(solution, self._work)
        of_contacts = self._work.array_r[system.zone.places]
        return np.asarray(system.zone.forces_of_body(self._outer) + of_contacts)

    def free(self) -> None:
        """Free PETSc's objects; not called ``destroy``, which PETSc calls after each solve."""
        for thing in (self._free_bodies, self._left, self._work, self._inner, self._outer):
            thing.destroy()
        del self._free_bodies  # it refers back
