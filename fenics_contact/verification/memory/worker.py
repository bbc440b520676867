"""One run whose memory is measured, in a process of its own: prints a row as JSON.

``python -m fenics_contact.verification.memory.worker CASE SOLVER ERRORS``, also under
``mpirun -n N``.
"""

from __future__ import annotations

import dataclasses
import json
import sys
from pathlib import Path
from typing import Any

from fenics_contact.common.parallel import total
from fenics_contact.simulation.scene_run import Run
from fenics_contact.solve.solver_choice import contact_unknowns, memory_terms, unknowns
from fenics_contact.verification.memory.block_scenes import body_of, scene_of
from fenics_contact.verification.memory.blocks import Seat, body_of_seat, scene_of_seat
from fenics_contact.verification.memory.table import SCENES

# isort: split
import numpy as np
from mpi4py import MPI


def resident(key: str) -> float:
    """Bytes of this process, from Linux: ``VmRSS`` now, ``VmHWM`` at the peak."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return 1024 * float(next(line for line in lines if line.startswith(key)).split()[1])


def row_of(name: str, solver: Any, errors: Any) -> dict[str, object]:
    """Solve a case as ``fenics-contact run`` does, and compare; collective."""
    comm = MPI.COMM_WORLD
    case = SCENES[name]
    before = resident("VmRSS")
    if isinstance(case, Seat):
        scene, body = scene_of_seat(case, solver), body_of_seat(case, comm)
    else:
        scene, body = scene_of(case, solver), body_of(case, comm)
    settings = dataclasses.replace(scene.solver, errors=errors)
    run = Run(dataclasses.replace(scene, solver=settings), comm, body)
    terms = memory_terms(run.problem, run.choice.name)
    sizes = {"dofs": unknowns(run.problem), "contact_dofs": contact_unknowns(run.problem)}
    result = run.solve()
    measured = total(comm, np.array(resident("VmHWM") - before))
    return {
        "case": name,
        "solver": solver,
        "ranks": comm.size,
        "errors": errors,
        **sizes,
        "converged": result.converged,
        "estimate": sum(terms.values()),
        "measured": float(measured),
        "terms": terms,
    }


if __name__ == "__main__":
    found = row_of(*sys.argv[1:4])
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(found))
