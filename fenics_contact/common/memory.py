"""How much memory this machine, its container or the process's own limits leave."""

from __future__ import annotations

import os
import resource
from collections.abc import Iterator
from pathlib import Path

from mpi4py import MPI

from fenics_contact.common.parallel import of_every_rank

_GROUPS = Path("/sys/fs/cgroup")
_OWN = Path("/proc/self/cgroup")
# Of both versions of control groups: a limit, what is used of it, and which of the statistics is
# memory that the kernel gives back when asked: files that it has read and keeps.
_FILES = (
    ("memory.max", "memory.current", "inactive_file"),
    ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
)


# Of a process: limits, as `ulimit` sets them, and the column of /proc/self/statm (in pages) that
# counts against each.
_STATM = Path("/proc/self/statm")
_OWN_LIMITS = ((resource.RLIMIT_AS, 0, "ulimit -v"), (resource.RLIMIT_DATA, 5, "ulimit -d"))

_Free = tuple[float, str]  # bytes, and what leaves no more


def free_memory() -> float:
    """Bytes free for this process, as far as known; within its container's limit and its own."""
    return min([*_shared(), *_own()])[0]


def free_memory_for(comm: MPI.Comm) -> float:
    """Bytes free for all ranks together, the least that every machine offers; collective.

    Within its container's limit; infinite where not known.

    A machine that holds a share of the ranks needs to hold about that share of the problem, and
    so does a rank that has a limit of its own.
    """
    return _free_for(comm)[0]


def memory_limit(comm: MPI.Comm) -> str:
    """Return in words what limits the memory to ``free_memory_for``; collective."""
    return _free_for(comm)[1]


def _free_for(comm: MPI.Comm) -> _Free:
    machine = comm.Split_type(MPI.COMM_TYPE_SHARED)
    share = machine.size
    machine.Free()
    together = [(free * comm.size / share, what) for free, what in _shared()]
    together += [(free * comm.size, what) for free, what in _own()]
    every: list[_Free] = of_every_rank(comm, min(together))
    return min(every)


def _shared() -> Iterator[_Free]:
    """Yield the free memory that the processes of a machine share."""
    yield _of_machine(), "of this machine's memory"
    for group in _groups():
        yield _of_group(group), "within the limit of its container or batch job"


def _own() -> Iterator[_Free]:
    """Yield the free memory of this process by its own limits."""
    for limit, column, command in _OWN_LIMITS:
        most = resource.getrlimit(limit)[0]
        if most != resource.RLIM_INFINITY:
            words = f"within the limit on a process ({command})"
            yield max(most - _used(column), 0.0), words


def _used(column: int) -> float:
    try:
        pages = int(_STATM.read_text().split()[column])
    except OSError:  # no /proc
        return 0.0
    return float(pages * os.sysconf("SC_PAGE_SIZE"))


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


def cores() -> int:
    """How many there are for this process, which need not be all of the machine."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
