"""How MUMPS is to factorise a matrix, with how much workspace, and what it says of it.

PETSc keeps a failure to itself, and results would be anything.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from petsc4py import PETSc

from fenics_contact.common.errors import FenicsContactError, MachineError, NotConvergedError
from fenics_contact.common.failures import LESS_MEMORY

# Values of INFOG(1), "Error diagnostics" in the users' guide of MUMPS 5.
_SINGULAR = (-6, -10)
_NO_MEMORY = (-5, -7, -13, -19, -22)  # could not be had, or is more than ICNTL(23) allows
_SMALL_WORKSPACE = (-8, -9, -14, -15, -17, -20)  # pivots took more than was foreseen
# ICNTL(14), in per cent: a mean stress may need other pivots than foreseen, and how many more may
# depend on the units of lengths and stresses. What is too small is made larger.
SPARE_WORKSPACE = (50, 400, 3200)

NAME = "mumps"  # among PETSc's packages
_WORKSPACE_OPTION = "mat_mumps_icntl_14"

MINIMUM_DEGREE, AUTOMATIC = 0, 7  # ICNTL(7): orderings
# Finding the better ordering of nested dissection costs more than it saves on plane meshes up to
# about this size.
_PLANE = 400_000
# Without METIS, as on Debian, MUMPS has nothing but minimum degree beside a Schur complement.
NESTED_DISSECTION = PETSc.Sys.hasExternalPackage("metis")


@dataclass(frozen=True)
class Factorisation:
    """How to factorise a symmetric stiffness.

    Attributes:
        kind: PETSc's name of the preconditioner: ``lu`` or ``cholesky``.
        ordering: Of the elimination, as MUMPS' ICNTL(7) numbers them.
    """

    kind: str
    ordering: int


def fastest(is_plane: bool, unknowns: int) -> Factorisation:
    """Return the fastest factorisation for a body; benchmarks of linear solves try it as well.

    Cholesky has half the work: with minimum degree it takes .6 to .9 of LU's time in the plane
    (measured on 15,000 to 66,000 unknowns of Q2). With nested dissection LU runs as fast or faster.

    Args:
        is_plane: Whether the body has two dimensions.
        unknowns: How many there are.
    """
    if is_plane and unknowns < _PLANE:
        return Factorisation("cholesky", MINIMUM_DEGREE)
    return Factorisation("lu" if NESTED_DISSECTION else "cholesky", AUTOMATIC)


class WorkspaceError(MachineError):
    """MUMPS asks for more workspace than it was given."""


def failure(factor: PETSc.Mat) -> FenicsContactError | None:
    """Return the failure of a factorisation, or None; the same on every rank with a part of it.

    Args:
        factor: PETSc's matrix of the factors.
    """
    code = factor.getMumpsInfog(1)
    if code >= 0 or factor.getSize()[0] == 0:  # older versions refuse a matrix of no rows
        return None
    if code in _SINGULAR:
        return NotConvergedError("the stiffness is singular: is the body held?", ())
    if code in _NO_MEMORY:
        return MachineError(
            f"out of memory: MUMPS could not factorise the stiffness, its INFOG(1) = {code}; "
            f"{LESS_MEMORY}"
        )
    small = code in _SMALL_WORKSPACE
    why = "its workspace is too small" if small else "it failed"
    return (WorkspaceError if small else MachineError)(
        f"MUMPS could not factorise the stiffness: {why}, INFOG(1) = {code}; try another "
        "solver.solver, or another number of ranks"
    )


def failure_of(preconditioner: PETSc.PC) -> FenicsContactError | None:
    """Return the failure of a preconditioner, None where it is not one of MUMPS."""
    if preconditioner.getType() not in ("lu", "cholesky"):
        return None
    if preconditioner.getFactorSolverType() != NAME:
        return None
    return failure(preconditioner.getFactorMatrix())


def workspace_option(options: Mapping[str, Any], spare: int) -> dict[str, int]:
    """PETSc's option for the workspace of a linear solve; nothing where it has no MUMPS.

    Args:
        options: Of the linear solve.
        spare: One of ``SPARE_WORKSPACE``.
    """
    uses = options.get("pc_factor_mat_solver_type") == NAME
    return {_WORKSPACE_OPTION: spare} if uses else {}


def factorised(create: Callable[[int], PETSc.PC]) -> tuple[PETSc.PC, FenicsContactError | None]:
    """A factorisation, with more workspace where MUMPS asks for it; collective on its ranks.

    What a user has set for ICNTL(14) among PETSc's options stays in force.

    Args:
        create: A preconditioner of MUMPS that is not set up, whose ICNTL(14) is given.

    Returns:
        The preconditioner, and what went wrong, or None.
    """
    for spare in SPARE_WORKSPACE[:-1]:
        found = create(spare)
        found.setUp()
        error = failure_of(found)
        if not isinstance(error, WorkspaceError):
            return found, error
        found.destroy()
    found = create(SPARE_WORKSPACE[-1])
    found.setUp()
    return found, failure_of(found)
