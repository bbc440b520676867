"""Decisions that all ranks take together, and all that one rank gets to know of the others.

A rank that raises while another waits hangs both, so an error is first made
known to every rank and then raised on all of them.

What is gathered stands whole on a rank. Nothing else of the program calls MPI's gathering
functions, so that a test can count what passes: of contact surfaces and of other parts of the
boundary, never of whole bodies.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Kind
from fenics_contact.common.errors import FenicsContactError

T = TypeVar("T")
# Variables by which MPI tells a process that it is one of several.
_OF_LAUNCHERS = ("PMI_", "PMIX_", "HYDI_", "HYDRA_", "MPI_", "MPIR_", "OMPI_")


def lasting(comm: MPI.Comm) -> MPI.Comm:
    """A communicator of the same ranks that outlives meshes, of which each has one of its own.

    Args:
        comm: Of a mesh; collective.
    """
    for one in (MPI.COMM_SELF, MPI.COMM_WORLD):
        if MPI.Comm.Compare(comm, one) in (MPI.IDENT, MPI.CONGRUENT):
            return one
    return comm


def environment_alone() -> dict[str, str]:
    """Variables for a new process that is none of the ranks here."""
    return {n: value for n, value in os.environ.items() if not n.startswith(_OF_LAUNCHERS)}


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
    found, raised = _from_root(comm, (result, error))
    if raised is not None:
        raise error or raised
    return cast(T, found)


def raise_together(comm: MPI.Comm, error: Exception | None) -> None:
    """Raise the error of the lowest rank that has one, on every rank; else return."""
    for found in of_every_rank(comm, error):
        if found is not None:
            raise found


def total(comm: MPI.Comm, value: Any) -> Any:
    """Sum of a number or an array (same shape on every rank) over the ranks."""
    if np.ndim(value) == 0:
        return float(value) if comm.size == 1 else comm.allreduce(float(value), op=MPI.SUM)
    return _summed(comm, np.ascontiguousarray(value, dtype=np.float64))


def largest(comm: MPI.Comm, values: Array, empty: float = 0.0) -> float:
    """Largest entry over the ranks, not a number if one is; ``empty`` where there is none."""
    found = float(values.max()) if values.size else -np.inf
    if comm.size > 1:
        found = float(np.max(of_every_rank(comm, found)))  # MPI's own maximum may lose a NaN
    return empty if found == -np.inf else found


def smallest(comm: MPI.Comm, values: Array, empty: float = 0.0) -> float:
    """Smallest entry over the ranks, not a number if one is; ``empty`` where there is none."""
    return -largest(comm, -values, empty=-empty)


def gather_rows(comm: MPI.Comm, rows: NDArray[Kind]) -> NDArray[Kind]:
    """Rows of all ranks on every rank, in rank order; for contact points only."""
    return np.concatenate(of_every_rank(comm, rows), axis=0)


def of_every_rank(comm: MPI.Comm, thing: T) -> list[T]:
    """A small thing of each rank, on every rank, in rank order."""
    return _to_every_rank(comm, thing)


def gathered_on_root(comm: MPI.Comm, thing: T) -> list[T] | None:
    """Return the things of all ranks, in rank order, on rank 0; None on the others."""
    return _to_root(comm, thing)


def sent_to_root(comm: MPI.Comm, thing: T, rank: int) -> T:
    """Return the thing of one rank on rank 0; the others get back their own."""
    if comm.rank == rank != 0:
        comm.send(thing, 0)
    return _received(comm, rank) if comm.rank == 0 != rank else thing


def from_rank(comm: MPI.Comm, thing: T, rank: int) -> T:
    """Return the thing of one rank on every rank."""
    return _from_root(comm, thing, rank)


def from_root(comm: MPI.Comm, thing: T) -> T:
    """Return the thing of rank 0 on every rank."""
    return _from_root(comm, thing)


# One rank alone has all there is: packing it up would cost more than most of what it is for.


def _to_every_rank(comm: MPI.Comm, thing: T) -> list[T]:
    if comm.size == 1:
        return [_copied(thing)]
    found: list[T] = comm.allgather(thing)
    return found


def _to_root(comm: MPI.Comm, thing: T) -> list[T] | None:
    if comm.size == 1:
        return [_copied(thing)]
    found: list[T] | None = comm.gather(thing)
    return found


def _received(comm: MPI.Comm, rank: int) -> Any:
    return comm.recv(source=rank)


def _from_root(comm: MPI.Comm, thing: T, rank: int = 0) -> T:
    if comm.size == 1:
        return _copied(thing)
    found: T = comm.bcast(thing, rank)
    return found


def _summed(comm: MPI.Comm, values: Array) -> Array:
    if comm.size == 1:
        return values.copy()
    summed = np.empty_like(values)
    comm.Allreduce(values, summed, op=MPI.SUM)
    return summed


def _copied(thing: T) -> T:
    """An array of its own, as from another rank; other things are not written to."""
    return cast(T, thing.copy()) if isinstance(thing, np.ndarray) else thing
