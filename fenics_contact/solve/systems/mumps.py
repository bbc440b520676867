"""What MUMPS says of a factorisation: PETSc keeps it to itself, and results would be anything."""

from __future__ import annotations

from petsc4py import PETSc

from fenics_contact.common.errors import FenicsContactError, MachineError, NotConvergedError
from fenics_contact.common.failures import LESS_MEMORY

# Values of INFOG(1), "Error diagnostics" in the users' guide of MUMPS 5.
_SINGULAR = (-6, -10)
_NO_MEMORY = (-5, -7, -13, -19, -22)  # could not be had, or is more than ICNTL(23) allows
_SMALL_WORKSPACE = (-8, -9, -14, -15, -17, -20)  # pivots took more than was foreseen


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


def failure_of(preconditioner: PETSc.PC) -> FenicsContactError | None:
    """The same of a preconditioner, None where it is not one of MUMPS."""
    if preconditioner.getType() not in ("lu", "cholesky"):
        return None
    if preconditioner.getFactorSolverType() != "mumps":
        return None
    return failure(preconditioner.getFactorMatrix())
