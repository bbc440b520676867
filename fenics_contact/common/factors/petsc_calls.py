"""Functions of PETSc's C library that petsc4py does not wrap."""

from __future__ import annotations

import ctypes
from typing import Any

from petsc4py import PETSc

from fenics_contact.common.errors import FenicsContactError


def call(name: str, *arguments: Any) -> None:
    """Call one function; petsc4py's objects are passed by their handles.

    Raises:
        FenicsContactError: PETSc returned an error.
    """
    passed = [
        ctypes.c_void_p(argument.handle) if hasattr(argument, "handle") else argument
        for argument in arguments
    ]
    code = getattr(ctypes.CDLL(PETSc.__file__), name)(*passed)
    if code:
        raise FenicsContactError(f"PETSc's error {code} in {name}")
