"""Rows of the table: a case measured several times, in seconds and memory."""

from __future__ import annotations

import ctypes
import gc
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from cost_cases import Case, body_of, scene_of
from cost_solves import GAMG, LU, frictional_solve, linear_seconds

from fenics_contact.common.parallel import total
from fenics_contact.evaluate.quantities import contact_quantities
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.solver_choice import contact_unknowns, unknowns

# isort: split
from mpi4py import MPI

T = TypeVar("T")

MOST_RUNS = 12  # of a case


@dataclass
class Measured:
    """A case by one solver, the least seconds of several runs.

    Attributes:
        row: As in the JSON file.
        solution: For the last load step.
        quantities: Of the contact, for the last load step.
        linear_memory: Of the linear solve that the row is compared with (MB).
        further: Seconds of each load step after the first, results not read; and with them.
    """

    row: dict[str, Any]
    solution: Solution
    quantities: dict[str, Any]
    linear_memory: float
    further: tuple[float, float] | None


def measure(case: Case, solver: str, comm: MPI.Comm, enough: float) -> Measured:
    """Time a case and the linear solve that it is compared with, by turns; collective.

    Args:
        case: The case.
        solver: As a scene names it.
        comm: The ranks.
        enough: Seconds after which two runs are enough; one is, if it took ten times as long.
    """
    settings = GAMG if solver == "iterative" else LU
    _compile(case, solver, comm)
    scene, body = scene_of(case, solver), body_of(case, comm)
    linear, runs, memory = [], [], []
    spent = 0.0
    while len(runs) < MOST_RUNS and spent <= (10 * enough if len(runs) < 2 else enough):
        problem = Problem.on_mesh(scene, body)
        seconds, grown = measured_memory(comm, partial(linear_seconds, problem, settings))
        run, grown_more = measured_memory(comm, partial(frictional_solve, problem))
        linear.append(seconds)
        runs.append(run)
        memory.append((grown, grown_more))
        spent += seconds + run.seconds
    best = min(runs, key=lambda run: run.seconds)
    iterative = solver == "iterative"
    row = {
        "case": case.name,
        "dimension": case.dimension,
        "element": case.element,
        "bodies": len(case.blocks),
        "dofs": unknowns(problem),
        "contact_dofs": contact_unknowns(problem),
        "solver": solver,
        "ranks": comm.size,
        "linear_seconds": min(linear),
        "frictional_seconds": best.seconds,
        "pairing_seconds": best.pairing,
        "ratio": best.seconds / min(linear),
        "steps": case.steps,
        "newton": best.newton,
        "outer": best.outer,
        "factorisations": 0 if iterative else best.set_ups,
        "preconditioner_setups": best.set_ups if iterative else 0,
        "peak_memory_mb": round(memory[0][1], 1),  # of the first: later ones find memory kept
    }
    further = None
    if case.steps > 1:
        alone = min(run.seconds - run.first for run in runs) / (case.steps - 1)
        further = alone, alone + min(run.reading for run in runs) / case.steps
    quantities = contact_quantities(problem, best.solution, 0)
    return Measured(row, best.solution, quantities, memory[0][0], further)


def _compile(case: Case, solver: str, comm: MPI.Comm) -> None:
    """Solve the case on a few cells, so that nothing is left to compile or load."""
    few = case.few_cells
    problem = Problem.on_mesh(scene_of(few, solver), body_of(few, comm))
    linear_seconds(problem, GAMG if solver == "iterative" else LU)
    frictional_solve(problem)


def measured_memory(comm: MPI.Comm, action: Callable[[], T]) -> tuple[T, float]:
    """What an action returns, and by how much the processes grow for it (MB).

    The sum over the ranks of each one's peak; not a number where the system keeps none.
    Collective.
    """
    gc.collect()
    try:
        ctypes.CDLL(None).malloc_trim(0)  # what is free goes back to the system
        before = _memory("VmRSS")
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # forget earlier peaks
    except (AttributeError, OSError):
        return action(), math.nan
    found = action()
    return found, float(total(comm, _memory("VmHWM") - before)) / 1000


def _memory(key: str) -> float:
    """Kilobytes, from Linux."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return float(next(line for line in lines if line.startswith(key)).split()[1]) * 1.024


def limit_of(row: dict[str, Any]) -> float | None:
    """What the project asks of itself: the ratio at the most, in one load step.

    Of two bodies it asks this of the condensed solver on one rank only.
    """
    if row["solver"] == "full" or row["steps"] > 1:
        return None
    if row["bodies"] > 1:
        return 1.4 if row["solver"] == "condensed" and row["ranks"] == 1 else None
    if row["solver"] == "iterative":
        return 3.0
    if row["ranks"] > 1:
        return 2.4
    if row["dimension"] == 2:
        return 1.5
    return 2.0 if is_wide(row) else 1.4


def is_wide(row: dict[str, Any]) -> bool:
    """Whether many of the dofs are at the contact: 8 % in the cases here, else 2.5 at the most."""
    return row["contact_dofs"] > 0.025 * row["dofs"]
