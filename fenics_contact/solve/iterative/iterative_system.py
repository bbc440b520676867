"""The system for large bodies: multigrid for the bulk, a direct solver at the contacts.

GAMG is set up on K once. Newton's method settles the nonlinear zone at the contacts by itself
before each of its steps (``nonlinear_elimination``), so that a step only has to carry smooth
changes into the body.

The preconditioner of the tangent solves for rigid motions of bodies that no support holds by
themselves, before each V-cycle of the bulk. Only contacts hold such a body. Multigrid for the bulk
sees springs in their place, and what slipping friction and soft neighbours leave of its stiffness
is far less than these. So its rigid motions are a coarse space of their own. Each is taken with
the zone at the contacts settled, as the penalty makes a body that moves by itself far too stiff.
With Z their columns and A the tangent, the preconditioner M becomes

    P = M (1 - A Q) + Q,    Q = Z (Zᵀ A Z)⁺ Zᵀ

(A-DEF1 in Tang, Nabben, Vuik and Erlangga 2009, J. Sci. Comput. 39, 340-370). M comes last, so
that P leaves no forces where M leaves none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.common.petsc_options import BULK_PREFIX
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import rigid_fields
from fenics_contact.solve.iterative.nonlinear_elimination import EliminatingNewton
from fenics_contact.solve.iterative.zoned_system import ZonedSystem

_OPTIONS = {
    "pc_type": "gamg",
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_pc_type": "jacobi",
}


class Multigrid:
    """V-cycles for a symmetric positive definite stiffness of displacements.

    Attributes:
        setups: How often the hierarchy was built.
        cycles: V-cycles so far.

    Args:
        matrix: K with rows and columns of supports cleared.
        rigid: Rigid motions at this rank's rows, (rows, modes): what coarse levels must keep.
    """

    def __init__(self, matrix: PETSc.Mat, rigid: Array) -> None:
        self.setups = 0
        self.cycles = 0
        matrix.setOption(PETSc.Mat.Option.SPD, True)
        self._vectors = [matrix.createVecRight() for _ in range(rigid.shape[1])]
        for vector, mode in zip(self._vectors, rigid.T, strict=True):
            with vector as array:
                array[:] = mode
        _orthonormalise(self._vectors)
        nearly_null = PETSc.NullSpace().create(vectors=self._vectors, comm=matrix.comm)
        matrix.setNearNullSpace(nearly_null)
        nearly_null.destroy()
        self._set_up(matrix)

    def _set_up(self, matrix: PETSc.Mat) -> None:
        self._preconditioner = PETSc.PC().create(matrix.comm)
        self._preconditioner.setOptionsPrefix(BULK_PREFIX)
        self._preconditioner.setOperators(matrix)
        options = PETSc.Options()
        own = [n for n in _OPTIONS if not options.hasName(BULK_PREFIX + n)]
        try:
            for name in own:
                options.setValue(BULK_PREFIX + name, _OPTIONS[name])
            self._preconditioner.setFromOptions()
            self._preconditioner.setUp()
        finally:
            for name in own:  # the database is global
                options.delValue(BULK_PREFIX + name)
        self.setups += 1

    def apply(self, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Apply one V-cycle; collective."""
        self._preconditioner.apply(right, solution)
        self.cycles += 1

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (self._preconditioner, *self._vectors):
            thing.destroy()


def _orthonormalise(vectors: list[PETSc.Vec]) -> None:
    """Orthonormalise by Gram and Schmidt, twice against round-off; vectors are independent."""
    for number, vector in enumerate(vectors):
        for before in vectors[:number] * 2:
            vector.axpy(-vector.dot(before), before)
        vector.normalize()


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


class Preconditioner:
    """Preconditioner of the tangent, as PETSc asks for it.

    It leaves no forces in the zone. So nothing as stiff as 1/ε₁ is in the residuals of a solve
    that starts without any there, and their norm is one of the body's forces.

    Args:
        system: Whose tangent it is for.
        multigrid: Of the bulk.
        free_motions: Rigid motions of bodies without supports at this rank's own displacement
            dofs, (dofs, motions).
    """

    def __init__(self, system: ZonedSystem, multigrid: Multigrid, free_motions: Array) -> None:
        self._system, self._multigrid = system, multigrid
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
        self._multigrid.apply(self._inner, self._outer)
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


class IterativeSystem(ZonedSystem):
    """Balance of forces with K in multigrid; the other attributes are those of ``ZonedSystem``.

    Attributes:
        multigrid: Of the bulk, set up once.
        preconditioner: Of the tangent, in linear solves.
    """

    name = "iterative"
    first_way = "monolithic"  # every pass of a loop would take linear solves of the body
    # These steps cost as much as those that follow; but what is left differs with the number of
    # ranks, and 1e-4 showed in the ninth digit of areas.
    scale_tolerance = 1e-5
    options: ClassVar = {
        "ksp_type": "fgmres",
        "ksp_gmres_restart": 30,
        "ksp_gmres_cgs_refinement_type": "refine_ifneeded",
    }

    def __init__(self, problem: Problem, timings: Timings) -> None:
        super().__init__(problem, timings)
        with timings.phase("factorise"):
            _, rigid = rigid_fields(problem.spaces)
            self.multigrid = Multigrid(self.stiffness, self._owned_columns(rigid))
            self.preconditioner = Preconditioner(self, self.multigrid, self.free_motions)

    @property
    def factorisations(self) -> int:  # type: ignore[override]
        """How often the bulk's multigrid was set up."""
        return self.multigrid.setups

    def prepare(self, snes: PETSc.SNES) -> None:
        """Newton's method with the zone settled before each step; multigrid inside."""
        snes.setType("python")
        snes.setPythonContext(EliminatingNewton(self))
        preconditioner = snes.getKSP().getPC()
        preconditioner.setType("python")
        preconditioner.setPythonContext(self.preconditioner)

    def linearise_contacts(self) -> None:
        """K_c of the state that was taken last, and the preconditioner by it; collective."""
        super().linearise_contacts()
        self.preconditioner.follow_tangent()

    def destroy(self) -> None:
        """Free PETSc's objects, and what refers back to this one."""
        self.preconditioner.free()
        del self.preconditioner
        self.multigrid.destroy()
        super().destroy()
