"""How much memory this machine, or its container, has left."""

from __future__ import annotations

import os
from pathlib import Path

from mpi4py import MPI

_CGROUPS = (
    ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
    (
        "/sys/fs/cgroup/memory/memory.limit_in_bytes",
        "/sys/fs/cgroup/memory/memory.usage_in_bytes",
    ),
)


def free_memory() -> float:
    """Bytes free on this machine, within its container's limit; infinite where not known."""
    return min(_of_machine(), *(_of_container(Path(a), Path(b)) for a, b in _CGROUPS))


def free_memory_for(comm: MPI.Comm) -> float:
    """Bytes free for all ranks together, the least that every machine offers; collective.

    A machine that holds a share of the ranks needs to hold about that share of the problem.
    """
    machine = comm.Split_type(MPI.COMM_TYPE_SHARED)
    together = free_memory() * comm.size / machine.size
    machine.Free()
    return float(min(comm.allgather(together)))


def _of_machine() -> float:
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
    except OSError:
        return _of_system()
    entries = dict(line.split(":", 1) for line in lines)
    return float(entries["MemAvailable"].split()[0]) * 1024


def _of_system() -> float:
    """Where there is no /proc: all memory, be it in use."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (ValueError, OSError):
        return float("inf")


def _of_container(limit: Path, used: Path) -> float:
    try:
        return float(int(limit.read_text()) - int(used.read_text()))
    except (OSError, ValueError):  # no such limit: "max", or another version of cgroups
        return float("inf")
