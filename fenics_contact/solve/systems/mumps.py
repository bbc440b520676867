"""How MUMPS is to factorise a stiffness, and what it says of it.

PETSc keeps a failure to itself, and results would be anything.
"""

from __future__ import annotations

from dataclasses import dataclass

from petsc4py import PETSc

from fenics_contact.common.errors import FenicsContactError, MachineError, NotConvergedError
from fenics_contact.common.failures import LESS_MEMORY

# Values of INFOG(1), "Error diagnostics" in the users' guide of MUMPS 5.
_SINGULAR = (-6, -10)
_NO_MEMORY = (-5, -7, -13, -19, -22)  # could not be had, or is more than ICNTL(23) allows
_SMALL_WORKSPACE = (-8, -9, -14, -15, -17, -20)  # pivots took more than was foreseen

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
    """What is fastest for a body; the linear solve of the benchmarks tries the same ordering.

    Cholesky has half the work: with minimum degree it takes .6 to .9 of LU's time in the plane
    (measured on 15,000 to 66,000 unknowns of Q2). With nested dissection LU runs as fast or faster.

    Args:
        is_plane: Whether the body has two dimensions.
        unknowns: How many there are.
    """
    if is_plane and unknowns < _PLANE:
        return Factorisation("cholesky", MINIMUM_DEGREE)
    return Factorisation("lu" if NESTED_DISSECTION else "cholesky", AUTOMATIC)


def failure(factor: PETSc.Mat) -> FenicsContactError | None:
    """What went wrong in a factorisation, or None; the same on every rank that has a part of it.

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
    why = "its workspace is too small" if code in _SMALL_WORKSPACE else "it failed"
    return MachineError(
        f"MUMPS could not factorise the stiffness: {why}, INFOG(1) = {code}; try another "
        "solver.solver, or another number of ranks"
    )


def wants_workspace(factor: PETSc.Mat) -> bool:
    """Whether a factorisation failed for a workspace that may be made larger.

    Args:
        factor: PETSc's matrix of the factors.
    """
    return factor.getMumpsInfog(1) in _SMALL_WORKSPACE


def failure_of(preconditioner: PETSc.PC) -> FenicsContactError | None:
    """The same of a preconditioner, None where it is not one of MUMPS."""
    if preconditioner.getType() not in ("lu", "cholesky"):
        return None
    if preconditioner.getFactorSolverType() != "mumps":
        return None
    return failure(preconditioner.getFactorMatrix())
