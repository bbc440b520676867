"""The system for large bodies: multigrid for the bulk, a direct solver at the contacts.

GAMG is set up on K once. Newton's method settles the nonlinear zone at the contacts by itself
before each of its steps (``nonlinear_elimination``), so that a step only has to carry smooth
changes into the body.
"""

from __future__ import annotations

from typing import ClassVar

from petsc4py import PETSc

from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import rigid_fields
from fenics_contact.solve.iterative.nonlinear_elimination import EliminatingNewton
from fenics_contact.solve.iterative.preconditioner import Multigrid, Preconditioner
from fenics_contact.solve.iterative.zoned_system import ZonedSystem


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
