"""One run of ``scaling.py``, in a process of its own a rank: prints a row as JSON.

``python benchmarks/scaling_worker.py CELLS PLACE``, also under ``mpirun -n N``: the scene with so
many cells along an edge, under a rounded punch (``punch``) or a plane that touches all of the top
(``plane``).
"""

from __future__ import annotations

import functools
import json
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fenics_contact import main
from fenics_contact.solve.iterative.contact_matrix import ContactMatrix
from fenics_contact.solve.iterative.contact_zone import ContactZone
from fenics_contact.solve.iterative.iterative_system import Multigrid
from fenics_contact.solve.iterative.nonlinear_elimination import ZoneSettling

# isort: split
from mpi4py import MPI

HERE = Path(__file__).resolve().parent
COMM = MPI.COMM_WORLD
_PLANE = (
    "contact.0.obstacle={shape='plane', position=[0.5, 0.5, 1], indentation=0.02,"
    " displacement=[0.008, 0, 0]}",
)
# What a solve consists of, by the methods that do it.
_PARTS = [
    ("V-cycles", Multigrid, "apply"),
    ("factors at the contact", ContactZone, "factorise"),
    ("solves at the contact", ContactZone, "solve"),
    ("contact's tangents", ContactMatrix, "linearise"),
    ("rest of settling", ZoneSettling, "settle"),
]


class Parts:
    """Seconds of wall time in methods, each without those that it calls.

    Attributes:
        seconds: By name.
        calls: By name.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {name: 0.0 for name, _, _ in _PARTS}
        self.calls: dict[str, int] = {name: 0 for name, _, _ in _PARTS}
        self._running: list[str] = []
        self._since = 0.0
        for name, owner, method in _PARTS:
            setattr(owner, method, self._timed(name, getattr(owner, method)))

    def _timed(self, name: str, method: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(method)
        def timed(*given: Any) -> Any:
            self._switch()
            self._running.append(name)
            self.calls[name] += 1
            try:
                return method(*given)
            finally:
                self._switch()
                self._running.pop()

        return timed

    def _switch(self) -> None:
        now = time.perf_counter()
        if self._running:
            self.seconds[self._running[-1]] += now - self._since
        self._since = now


def _used() -> tuple[float, float]:
    """CPU seconds of this process and its ended children, and its peak memory (bytes)."""
    own, children = (
        resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    seconds = sum(used.ru_utime + used.ru_stime for used in (own, children))
    return seconds, 1024.0 * own.ru_maxrss


def row_of(cells: int, place: str) -> dict[str, object]:
    """Run the scene as a user does, files and all; collective."""
    parts = Parts()
    sizes = [f"mesh.parameters.cells_{way}={cells}" for way in ("along", "across")]
    changes = ["solver.solver=iterative", *sizes, *(_PLANE if place == "plane" else ())]
    with tempfile.TemporaryDirectory() as folder:
        out = Path(COMM.bcast(folder)) / "run"
        settings = [word for change in changes for word in ("--set", change)]
        scene = str(HERE / "large_block.toml")
        code = main(["run", scene, "--out", str(out), "--quiet", *settings])
        COMM.barrier()
        record = json.loads((out / "result.json").read_text(encoding="utf-8"))
        COMM.barrier()
    used = COMM.allgather(_used())
    return {
        "place": place,
        "cells": cells,
        "ranks": COMM.size,
        "exit_code": code,
        "dofs": record["model"]["dofs"],
        "contact_dofs": 3 * (2 * cells + 1) ** 2,
        "solver": record["model"]["solver"],
        "newton": record["steps"][-1]["newton_iterations"],
        "seconds": record["timings"],
        "parts": {name: COMM.allreduce(each, op=MPI.MAX) for name, each in parts.seconds.items()},
        "calls": parts.calls,
        "cpu_seconds": sum(seconds for seconds, _ in used),
        "peak_bytes": [peak for _, peak in used],
    }


if __name__ == "__main__":
    found = row_of(int(sys.argv[1]), sys.argv[2])
    if COMM.rank == 0:
        print(json.dumps(found))
