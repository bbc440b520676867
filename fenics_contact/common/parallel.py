"""Decisions that all ranks take together.

A rank that raises while another waits hangs both, so an error is first made
known to every rank and then raised on all of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import FenicsContactError

T = TypeVar("T")


def on_root(comm: MPI.Comm, action: Callable[[], T]) -> T:
    """Run an action on rank 0 and share what it returns, or what it raises.

    Args:
        comm: Communicator; collective.
        action: Called on rank 0 only; its result must be picklable.

    Returns:
        The same result on every rank.

    Raises:
        FenicsContactError: The same on every rank, as raised on rank 0. Other
            exceptions are passed on likewise (machine errors among them).
    """
    result: T | None = None
    error: Exception | None = None
    if comm.rank == 0:
        try:
            result = action()
        except (FenicsContactError, OSError, MemoryError) as caught:
            error = caught
        except Exception as caught:  # shared, so that no other rank waits for ever
            error = RuntimeError(f"{type(caught).__name__}: {caught}")
            error.__cause__ = caught
    shared: tuple[T, Exception | None] = comm.bcast((result, error), root=0)
    if shared[1] is not None:
        raise error or shared[1]
    return shared[0]


def raise_together(comm: MPI.Comm, error: Exception | None) -> None:
    """Raise the error of the lowest rank that has one, on every rank; else return."""
    errors = comm.allgather(error)
    for found in errors:
        if found is not None:
            raise found


def total(comm: MPI.Comm, value: Any) -> Any:
    """Sum of a number or an array (same shape on every rank) over the ranks."""
    if np.ndim(value) == 0:
        return comm.allreduce(float(value), op=MPI.SUM)
    local = np.ascontiguousarray(value, dtype=np.float64)
    summed = np.empty_like(local)
    comm.Allreduce(local, summed, op=MPI.SUM)
    return summed


def largest(comm: MPI.Comm, values: Array, empty: float = 0.0) -> float:
    """Largest entry over the ranks, not a number if one is; ``empty`` where there is none."""
    local = float(values.max()) if values.size else -np.inf
    found = float(np.max(comm.allgather(local)))  # MPI's own maximum may lose a NaN
    return empty if found == -np.inf else found


def smallest(comm: MPI.Comm, values: Array, empty: float = 0.0) -> float:
    """Smallest entry over the ranks, not a number if one is; ``empty`` where there is none."""
    return -largest(comm, -values, empty=-empty)


def gather_rows(comm: MPI.Comm, rows: Array) -> Array:
    """Rows of all ranks on every rank, in rank order; for contact points only."""
    return np.concatenate(comm.allgather(rows), axis=0)
