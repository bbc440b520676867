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

from cost_solves import (
    Frictional,
    frictional_solve,
    linear_seconds,
    linear_solvers,
    seconds_of_errors,
)

from fenics_contact.common.parallel import total
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.solver_choice import choose_solver, contact_unknowns, unknowns
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.verification.memory_check import BlockCase
from fenics_contact.verification.memory_worker import body_of, scene_of

# isort: split
from mpi4py import MPI

T = TypeVar("T")

MOST_RUNS = 12  # of a case
# Of the contact, from which two bodies are said to slip.
SLIPS = 0.3
# Dofs from which limits of full contact are others, or none.
LARGE, LARGE_FOR_CONDENSED = 100_000, 40_000


@dataclass
class Measured:
    """A case by one solver, the least seconds of several runs.

    Attributes:
        row: As in the JSON file.
        solution: For the last load step.
        quantities: Of the contact, for the last load step.
    """

    row: dict[str, Any]
    solution: Solution
    quantities: dict[str, Any]


def measure(case: BlockCase, solver: str, comm: MPI.Comm, enough: float) -> Measured:
    """Time a case and the linear solve that it is compared with, by turns; collective.

    Args:
        case: The case.
        solver: As a scene names it.
        comm: The ranks.
        enough: Seconds after which two runs are enough; one is, if it took twice as long.
    """
    scene, body = scene_of(case, solver), body_of(case, comm)
    problem = Problem.on_mesh(scene, body)
    chosen = choose_solver(problem).name
    # On a few cells first, so that nothing is left to compile or load.
    few = Problem.on_mesh(scene_of(case.few_cells, chosen), body_of(case.few_cells, comm))
    _Yardstick(few, chosen)
    frictional_solve(few)
    seconds_of_errors(few)
    yardstick, runs, memory = _Yardstick(problem, chosen), [], []
    spent = 0.0
    while len(runs) < MOST_RUNS and spent <= (2 * enough if len(runs) < 2 else enough):
        problem = Problem.on_mesh(scene, body)
        seconds = yardstick.measure(problem)
        run, grown = measured_memory(comm, partial(frictional_solve, problem))
        runs.append(run)
        memory.append(grown)
        spent += seconds + run.seconds
    best = min(runs, key=lambda run: run.seconds)
    quantities = contact_quantities(problem, best.solution, 0)
    row = {
        "case": case.name,
        "dimension": case.dimension,
        "element": case.element,
        "bodies": len(case.blocks),
        "full_contact": case.full_contact,
        "dofs": unknowns(problem),
        "contact_dofs": contact_unknowns(problem),
        "solver": solver,
        "solver_chosen": chosen,
        "ranks": comm.size,
        "linear_solver": yardstick.name,
        "linear_seconds": yardstick.seconds,
        "linear_memory_mb": round(yardstick.memory, 1),
        "frictional_seconds": best.seconds,
        "pairing_seconds": best.pairing,
        "ratio": best.seconds / yardstick.seconds,
        "steps": case.steps,
        "newton": best.newton,
        "outer": best.outer,
        "factorisations": 0 if chosen == "iterative" else best.set_ups,
        "preconditioner_setups": best.set_ups if chosen == "iterative" else 0,
        "peak_memory_mb": round(memory[0], 1),  # of the first: later ones find memory kept
        "slip_share": _share(quantities["slip_area"], quantities["contact_area"]),
        **_further_steps(case, runs, yardstick.seconds),
        "seconds_errors": seconds_of_errors(Problem.on_mesh(scene, body)),
    }
    return Measured(row, best.solution, quantities)


class _Yardstick:
    """The linear solve on the mesh of a case, by what is fastest there; collective.

    Attributes:
        name: Of what is fastest.
        seconds: The least of all runs.
        memory: By how much the processes grew in the first run of it (MB).
    """

    def __init__(self, problem: Problem, solver: str) -> None:
        self._solvers = linear_solvers(problem, solver)
        found = {
            name: measured_memory(problem.comm, partial(linear_seconds, problem, settings))
            for name, settings in self._solvers.items()
        }
        self.name = min(found, key=lambda name: found[name][0])
        self.seconds, self.memory = found[self.name]

    def measure(self, problem: Problem) -> float:
        """Once more by what was fastest, and the seconds that it took; collective."""
        seconds = linear_seconds(problem, self._solvers[self.name])
        self.seconds = min(self.seconds, seconds)
        return seconds


def _further_steps(
    case: BlockCase, runs: list[Frictional], linear: float
) -> dict[str, float | None]:
    """What a load step after the first costs, without and with its results read."""
    keys = ("further_step_seconds", "further_step_ratio", "further_step_ratio_with_results")
    if case.steps == 1:
        return dict.fromkeys(keys)
    alone = min(run.seconds - run.first for run in runs) / (case.steps - 1)
    reading = min(run.reading for run in runs) / case.steps
    return dict(zip(keys, (alone, alone / linear, (alone + reading) / linear), strict=True))


def _share(part: float, whole: float) -> float:
    return part / whole if whole else 0.0


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


# A further load step, in linear solves.
LIMIT_OF_FURTHER_STEP = 0.1


def limit_of(row: dict[str, Any]) -> float | None:
    """What the project asks of itself: the ratio at the most, in one load step."""
    solver = row["solver_chosen"]
    if solver == "full" or row["steps"] > 1:
        return None
    if row["full_contact"]:
        return _limit_of_full_contact(row)
    if row["bodies"] > 1:
        return 1.4 if solver == "condensed" and row["ranks"] == 1 else None
    if solver == "iterative":
        return 3.0
    if row["ranks"] > 1:
        return 2.4
    if row["dimension"] == 2:
        return 1.5
    return 2.0 if is_wide(row) else 1.4


def _limit_of_full_contact(row: dict[str, Any]) -> float | None:
    """Where a whole side touches and rubs."""
    if row["solver_chosen"] == "iterative":
        if row["bodies"] > 1:
            return 5.5 if row["slip_share"] > SLIPS else 4.0
        return 3.5 if row["dofs"] < LARGE else 4.0
    return 4.0 if row["bodies"] == 1 and row["dofs"] < LARGE_FOR_CONDENSED else None


def is_wide(row: dict[str, Any]) -> bool:
    """Whether many of the dofs are at the contact: 8 % in the cases here, else 2.5 at the most."""
    return row["contact_dofs"] > 0.025 * row["dofs"]
