"""Calls of PETSc that its Python does not wrap, or not on Debian, through its C library."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import AnyIntegers, Array
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


def preallocate_places(matrix: PETSc.Mat, rows: AnyIntegers, columns: AnyIntegers) -> None:
    """Give a matrix the places of ``set_at_places``, one for each entry; collective.

    Args:
        matrix: Without entries yet.
        rows: Of the entries that this rank gives, by their numbers over all ranks; a place may
            come more than once, and be another rank's.
        columns: Likewise.
    """
    # PETSc may overwrite both.
    places = [np.array(numbers, dtype=PETSc.IntType) for numbers in (rows, columns)]
    pointers = [ctypes.c_void_p(numbers.ctypes.data) for numbers in places]
    call("MatSetPreallocationCOO", matrix, ctypes.c_ssize_t(len(rows)), *pointers)


def set_at_places(matrix: PETSc.Mat, values: Array) -> None:
    """Set all entries, in the order of their places; those at one place add up; collective."""
    given = np.ascontiguousarray(values, dtype=np.float64)
    insert = ctypes.c_int(int(PETSc.InsertMode.INSERT_VALUES))
    call("MatSetValuesCOO", matrix, ctypes.c_void_p(given.ctypes.data), insert)
