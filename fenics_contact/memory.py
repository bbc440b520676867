"""How much memory this machine, or its container, has left."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from mpi4py import MPI

_GROUPS = Path("/sys/fs/cgroup")
_OWN = Path("/proc/self/cgroup")
# Of both versions of control groups: a limit, what is used of it, and which of the statistics is
# memory that the kernel gives back when asked: files that it has read and keeps.
_FILES = (
    ("memory.max", "memory.current", "inactive_file"),
    ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
)


def free_memory() -> float:
    """Bytes free on this machine, within its container's limit; infinite where not known."""
    return min(_of_machine(), *(_of_group(group) for group in _groups()))


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


def _groups() -> Iterator[Path]:
    """Folders of the control groups that this process is in, from the outermost inwards.

    A batch system's limit stands in a nested one, a container's in what it sees as outermost.
    """
    roots = {"": _GROUPS, "memory": _GROUPS / "memory"}
    yield from roots.values()
    try:
        lines = _OWN.read_text().splitlines()
    except OSError:
        return
    for line in lines:  # number:controllers:path
        _, controllers, path = line.split(":", 2)
        if controllers in roots:
            folder = roots[controllers]
            for part in Path(path).parts[1:]:
                folder = folder / part
                yield folder


def _of_group(folder: Path) -> float:
    return min(_within(folder, *files) for files in _FILES)


def _within(folder: Path, limit: str, used: str, reclaimable: str) -> float:
    try:
        free = float(int((folder / limit).read_text()) - int((folder / used).read_text()))
    except (OSError, ValueError):  # no such limit: "max", or another version of control groups
        return float("inf")
    try:
        lines = (folder / "memory.stat").read_text().splitlines()
    except OSError:
        return free
    statistics = dict(line.split() for line in lines)
    return free + float(statistics.get(reclaimable, 0))
